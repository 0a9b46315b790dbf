#include "diagnosis/effects/discovered/term_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include "diagnosis/effects/discovered/term_text.h"

namespace flextip::diagnosis {
namespace {

struct TargetSource {
  const char *target, *input, *applies;
};
constexpr TargetSource kSources[kTermTargets] = {
    {"kEmPosition", "kEmOffset", "samples.has_em"},
    {"kEmOrientation", "kEmReadTurn", "samples.has_em"},
    {"kStrain", "kStrainOffset", "samples.has_strain"},
    {"kVisionPosition", "kVisionShift", "samples.has_tip"},
    {"kVisionDirection", "kTipReadTurn", "samples.has_tip_direction"},
    {"kWristOrientation", "kWristReadTurn", "samples.has_wrist_direction"},
    {"kWristPosition", "kWrist", "samples.Duration() > 0.0"},
    {"kLoad", "kForce", "samples.has_load"},
    {"kPort", "kPort", "samples.Duration() > 0.0"},
    {"kStiffness", "kStiffness", "samples.Duration() > 0.0"},
    {"kFriction", "kPortFriction", "samples.Duration() > 0.0"},
    {"kShaftLoad", "kInside", "samples.Duration() > 0.0"},
    {"kCurvature", "kCurvature", "samples.Duration() > 0.0"},
    {"kEmTime", "kEmDelay", "samples.has_em"},
    {"kVisionTime", "kCameraDelay", "samples.has_tip"},
};

const TargetSource& SourceOf(const Term& term) { return kSources[static_cast<int>(term.target)]; }

/// "EmHum" of "em_hum".
std::string ClassName(const std::string& name) {
  std::string text;
  bool up = true;
  for (const char c : name) {
    if (c == '_') {
      up = true;
      continue;
    }
    text += up ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    up = false;
  }
  return text;
}

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

/// The columns as C++, of `v`.
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

/// What stands before the columns, of each input `i`.
std::string Before(const Term& term) {
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

constexpr const char* kSpline = R"(
/// Cubic B-splines on equal steps from 0 to 1, clamped outside.
double Spline(int i, double x) {
  const double r = std::abs(std::clamp(x, 0.0, 1.0) * 4.0 - (i - 1));
  if (r >= 2.0) return 0.0;
  return r < 1.0 ? 2.0 / 3.0 - r * r + 0.5 * r * r * r : std::pow(2.0 - r, 3) / 6.0;
}
)";

std::string Head(const Term& term, const std::string& name) {
  return fmt::format(
      "// {}: {}.\n"
      "// A start, from what a diagnosis found (flextip effect new): say what it is, what is "
      "within\n"
      "// specification, and by which physics. How to go on: docs/usage/add_an_effect.md.\n",
      name, TextOf(term));
}

std::string Maker(const std::string& name) {
  const std::string type = ClassName(name);
  return fmt::format(
      "std::unique_ptr<flextip::diagnosis::Effect> Make{0}();\n"
      "std::unique_ptr<flextip::diagnosis::Effect> Make{0}() {{ return std::make_unique<{0}>(); "
      "}}\n",
      type);
}

/// Three inputs that swing in time: their base class scans the frequency.
std::string PeriodicSource(const Term& term, const std::string& name) {
  const TargetSource& source = SourceOf(term);
  const double size = term.amplitude.norm();
  return Head(term, name) +
         fmt::format(R"(#include "diagnosis/effects/periodic.h"

#include <memory>

namespace {{

using namespace flextip::diagnosis;

class {0} : public PeriodicEffect {{
 public:
  {0}()
      : PeriodicEffect("{1}", "{2}",
                       {{.first_input = sample_input::{3},
                        .tolerance = {4:.3g},
                        .typical = {5:.3g},
                        .lowest_hz = {6:.3g},
                        .highest_hz = {7:.3g},
                        .start_hz = {8:.6g}}}) {{}}
  bool Applies(const SampleSet& samples) const override {{
    return {9} && samples.resolved_in_time;
  }}
}};

}}  // namespace

)",
                     ClassName(name), name, TextOf(term), source.input, 0.05 * size, size,
                     0.5 * term.at[0], 2.0 * term.at[0], term.at[0], source.applies) +
         Maker(name);
}

}  // namespace

std::string EffectNameOf(const Term& term) {
  const std::string channel = InfoOf(term.target).channel;
  return channel.substr(0, channel.find('_')) + "_" + Name(FormOf(term));
}

std::string EffectSource(const Term& term, const std::string& name) {
  const TargetSource& source = SourceOf(term);
  const TermTargetInfo& info = InfoOf(term.target);
  if (term.shape == TermShape::kPeriodic && term.variable == TermVariable::kTime &&
      info.inputs == 3)
    return PeriodicSource(term, name);
  const int n = info.inputs, amplitudes = n * term.Columns();
  const bool offset = term.offset.size() > 0;
  std::string at;
  for (const double value : term.at) at += (at.empty() ? "" : ", ") + fmt::format("{:.12g}", value);
  std::string text = Head(term, name) +
                     "#include <algorithm>\n#include <cmath>\n#include <memory>\n#include "
                     "<numbers>\n#include <string>\n#include <vector>\n\n"
                     "#include \"diagnosis/effects/discovered/term_columns.h\"\n"
                     "#include \"diagnosis/model/effect.h\"\n\nnamespace {\n\n"
                     "using namespace flextip::diagnosis;\n";
  if (term.shape == TermShape::kSmooth) text += kSpline;
  text += fmt::format(R"(
class {0} : public DirectEffect {{
 public:
  std::string Name() const override {{ return "{1}"; }}
  std::string Summary() const override {{ return "{2}"; }}
  bool Applies(const SampleSet& samples) const override {{ return {3}; }}
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {{
)",
                      ClassName(name), name, TextOf(term), source.applies);
  text += "    std::vector<FitParameter> all;\n";
  const auto parameters = [&](const char* what, int count, double size) {
    if (count == 0) return;
    text += fmt::format(
        "    for (const double tolerance : ToleranceOf(samples, Name(), \"{}\", {:.3g}, {}))\n"
        "      all.push_back({{tolerance, {:.3g}, false}});\n",
        what, 0.05 * size, count, size);
  };
  const auto typical = [](const auto& values) {
    return std::max(1e-9, values.norm() / std::sqrt(std::max<double>(1.0, double(values.size()))));
  };
  parameters("amplitude", amplitudes, typical(term.amplitude));
  parameters("offset", offset ? n : 0, typical(term.offset));
  text += fmt::format(
      "    return all;\n  }}\n"
      "  void Apply(const double*, const Instant& now, EffectMemory& memory,\n"
      "             InputChange& change) const override {{\n"
      "    const TermState state = StateAt(TermTarget::{}, now, memory);\n"
      "    for (int i = 0; i < {}; ++i) {{\n{}",
      source.target, n, Before(term));
  const auto columns = ColumnSources(term);
  const std::string sign = info.sign < 0.0 ? "-" : "";
  for (std::size_t j = 0; j < columns.size(); ++j)
    text +=
        fmt::format("      change.Linear({}i, sample_input::{} + i, {}({}));\n",
                    j == 0 ? "" : fmt::format("{} + ", int(j) * n), source.input, sign, columns[j]);
  if (offset)
    text +=
        fmt::format("      change.Linear({}i, sample_input::{} + i, {}1.0);\n",
                    amplitudes == 0 ? "" : fmt::format("{} + ", amplitudes), source.input, sign);
  text +=
      "    }\n    memory[0] = 1.0;  // begun; what StateAt and the shape go on from\n"
      "    memory[5] = state.t_s;\n  }\n"
      "  bool NeedsPortPlace() const override { return true; }\n";
  if (IsStamp(term.target) && amplitudes == 0)  // what estimate takes off the stamps
    text += fmt::format("  int DelayInput() const override {{ return sample_input::{}; }}\n",
                        source.input);
  text +=
      "\n protected:\n"
      "  std::vector<Named> Names() const override {\n    return {";
  if (amplitudes > 0) text += fmt::format("{{\"amplitude\", {}}}", amplitudes);
  if (offset) text += fmt::format("{}{{\"offset\", {}}}", amplitudes > 0 ? ", " : "", n);
  text += "};\n  }\n";
  if (!term.at.empty())
    text += fmt::format(
        "\n private:\n  static constexpr double kAt[] = {{{}}};  // of the shape, as found\n", at);
  return text + "};\n\n}  // namespace\n\n" + Maker(name);
}

}  // namespace flextip::diagnosis
