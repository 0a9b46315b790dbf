#include "diagnosis/effects/discovered/column_source.h"

#include <fmt/format.h>

#include <cstddef>

namespace flextip::diagnosis {
namespace {

std::string VariableSource(const Term& term) {
  if (term.variable == TermVariable::kOwnValue) return "state.own[i]";
  if (term.variable == TermVariable::kPosition) return "state.position[i]";
  return fmt::format("state.scalar[{}]", static_cast<int>(term.variable));
}

/// The state's vector, of a term that has a column each of its components.
std::string VectorSource(const Term& term) {
  return term.variable == TermVariable::kPosition      ? "state.position"
         : term.variable == TermVariable::kOrientation ? "state.orientation"
                                                       : "state.image";
}

std::vector<std::string> ComponentSources(const Term& term) {
  std::vector<std::string> columns(static_cast<std::size_t>(Dimension(term.variable)));
  for (std::size_t i = 0; i < columns.size(); ++i)
    columns[i] = fmt::format("{}[{}]", VectorSource(term), i);
  return columns;
}

/// The components of a vector, then their products.
std::vector<std::string> ProductSources(const Term& term) {
  std::vector<std::string> columns = ComponentSources(term);
  const std::size_t n = columns.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j) columns.push_back(columns[i] + " * " + columns[j]);
  return columns;
}

}  // namespace

std::vector<std::string> ColumnSources(const Term& term) {
  switch (term.shape) {
    case TermShape::kConstant:
      return {};
    case TermShape::kLinear: {
      if (Dimension(term.variable) == 1 || term.IsByInput()) return {"v - kAt[0]"};
      return ComponentSources(term);
    }
    case TermShape::kRadial: {
      std::vector<std::string> columns = ComponentSources(term);
      for (std::string& column : columns)
        column = fmt::format("{}.squaredNorm() * {}", VectorSource(term), column);
      return columns;
    }
    case TermShape::kQuadratic:
      if (Dimension(term.variable) > 1) return ProductSources(term);
      return {"v - kAt[0]", "(v - kAt[0]) * (v - kAt[0])"};
    case TermShape::kPeriodic:
      return {"std::sin(2.0 * std::numbers::pi * kAt[0] * v)",
              "std::cos(2.0 * std::numbers::pi * kAt[0] * v)"};
    case TermShape::kStep:
      return {"0.5 + 0.5 * std::tanh(2.0 * (v - kAt[0]) / kAt[1])"};
    case TermShape::kBeyond:
      return {"std::max(0.0, v - kAt[0])"};
    case TermShape::kBelow:
      return {"std::max(0.0, kAt[0] - v)"};
    case TermShape::kBand:
      return {"v - std::clamp(v, -kAt[0], kAt[0])"};
    case TermShape::kTanh:
      return {"std::tanh(v / kAt[0])"};
    case TermShape::kExponential:
      return {"std::exp(-(v - kAt[1]) / kAt[0])"};
    case TermShape::kAfter:
      return {"v < kAt[1] ? 0.0 : std::exp(-(v - kAt[1]) / kAt[0])"};
    case TermShape::kRelaxing:
    case TermShape::kPlay:
    case TermShape::kSmoothPlay:
      return {"v - kept"};
    case TermShape::kInversePower:
      return {"std::pow(distance_m / 0.1, -kAt[3])"};
    case TermShape::kPastPlane:
      return {"std::max(0.0, normal.normalized().dot(state.position) - kAt[3])"};
    case TermShape::kSmooth: {
      std::vector<std::string> columns;
      columns.reserve(kSplines);
      for (int j = 0; j < kSplines; ++j) columns.push_back(fmt::format("fade * Spline({}, x)", j));
      return columns;
    }
  }
  return {};
}

std::string BeforeColumns(const Term& term) {
  std::string text;
  const bool has_v = term.shape != TermShape::kConstant && term.shape != TermShape::kInversePower &&
                     term.shape != TermShape::kPastPlane &&
                     (Dimension(term.variable) == 1 || term.IsByInput());
  if (has_v)
    text += fmt::format("      const double v = {};  // {}\n", VariableSource(term),
                        Name(term.variable));
  if (HasMemory(term.shape)) {
    text +=
        "      double& kept = memory[static_cast<std::size_t>(1 + i)];\n"
        "      if (memory[0] == 0.0) kept = v;\n";
    if (term.shape == TermShape::kSmoothPlay)
      text +=
          "      double& past = memory[static_cast<std::size_t>(8 + i)];\n"
          "      if (memory[0] == 0.0) past = v;\n"
          "      const double left = std::exp(-std::abs(v - past) / kAt[0]);\n"
          "      kept = v - left * (past - kept) -\n"
          "             std::copysign(kAt[0] * (1.0 - left), v - past);\n"
          "      past = v;\n";
    if (term.shape == TermShape::kPlay)
      text += "      kept = std::clamp(kept, v - kAt[0], v + kAt[0]);\n";
    if (term.shape == TermShape::kRelaxing)
      text +=
          "      const double dt_s = memory[0] == 0.0 ? 0.0 : state.t_s - memory[5];\n"
          "      kept += (1.0 - std::exp(-dt_s / kAt[0])) * (v - kept);\n";
  }
  if (term.shape == TermShape::kInversePower)
    text +=
        "      const Eigen::Vector3d place(kAt[0], kAt[1], kAt[2]);\n"
        "      const double distance_m = std::max(0.005, (state.position - place).norm());\n";
  if (term.shape == TermShape::kPastPlane)
    text += "      const Eigen::Vector3d normal(kAt[0], kAt[1], kAt[2]);\n";
  if (term.shape == TermShape::kSmooth)
    text +=
        "      const double x = (v - kAt[0]) / (kAt[1] - kAt[0]);\n"
        "      const double outside = std::max({0.0, -x, x - 1.0});\n"
        "      const double fade = std::max(0.0, 1.0 - outside / 0.1);\n";
  return text;
}

}  // namespace flextip::diagnosis
