#include "diagnosis/effects/discovered/term_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/linear_algebra.h"

namespace flextip::diagnosis {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// A value of that unit as people read it: 0.82 mm.
std::string Shown(double value, const std::string& unit) {
  if (unit == "m") return fmt::format("{:.3g} mm", 1e3 * value);
  if (unit == "rad") return fmt::format("{:.3g} mrad", 1e3 * value);
  if (unit == "m_s") return fmt::format("{:.3g} mm/s", 1e3 * value);
  if (unit == "N_m") return fmt::format("{:.3g} N/m", value);
  if (unit == "1_m") return fmt::format("{:.3g} 1/m", value);
  if (unit.empty()) return fmt::format("{:.3g}", value);
  return fmt::format("{:.3g} {}", value, unit);
}

/// What a term adds: as Shown, a time in milliseconds.
std::string ShownSize(double value, const std::string& unit) {
  return unit == "s" ? fmt::format("{:.3g} ms", 1e3 * value) : Shown(value, unit);
}

/// " per m/s"; nothing where a slope has no unit below.
std::string Per(const std::string& unit) {
  if (unit.empty()) return "";
  return " per " + (unit == "m_s" ? "m/s" : unit);
}

std::string Spoken(TermVariable variable) {
  std::string name = Name(variable);
  std::replace(name.begin(), name.end(), '_', ' ');
  if (variable == TermVariable::kOwnValue) return "its own value";
  if (variable == TermVariable::kPosition) return "the place";
  if (variable == TermVariable::kPortForce) return "the port's force";
  if (variable == TermVariable::kImagePosition) return "the place in the image";
  return variable == TermVariable::kTime ? name : "the " + name;
}

std::string Suffixed(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + "_" + unit;
}

/// "m" over "s" as a suffix: m_s.
std::string Over(const std::string& unit, const std::string& by) {
  if (by.empty() || unit == by) return unit == by ? "" : unit;
  return unit.empty() ? "1_" + by : unit + "_" + by;
}

/// The phase that all inputs of a periodic term have in common.
double PhaseOf(const Term& term) {
  const Eigen::VectorXd a = term.amplitude.col(0), b = term.amplitude.col(1);
  return 0.5 * std::atan2(2.0 * a.dot(b), a.squaredNorm() - b.squaredNorm());
}

Eigen::VectorXd Swing(const Term& term) {
  const double phase = PhaseOf(term);
  return term.amplitude.col(0) * std::cos(phase) + term.amplitude.col(1) * std::sin(phase);
}

/// The amplitudes that give the direction.
Eigen::VectorXd Leading(const Term& term) {
  if (term.shape == TermShape::kConstant) return term.offset;
  if (term.shape == TermShape::kPeriodic) return Swing(term);
  if (term.shape == TermShape::kQuadratic && term.amplitude.cols() == 2)
    return term.amplitude.col(1);
  if (term.amplitude.cols() == 1) return term.amplitude.col(0);
  const SymmetricEigen axes(Eigen::MatrixXd(term.amplitude * term.amplitude.transpose()));
  return axes.vectors.col(axes.vectors.cols() - 1);
}

struct Numbers {
  std::vector<std::string> names;
  std::vector<double> values;
};

/// What depends on amplitude and offset.
Numbers Amplitudes(const Term& term) {
  const Eigen::VectorXd direction = DirectionOf(term);
  const std::string unit = InfoOf(term.target).unit, by = UnitOf(term.variable, term.target);
  Numbers n;
  const auto add = [&](const std::string& name, double value) {
    n.names.push_back(name);
    n.values.push_back(value);
  };
  const auto along = [&](Eigen::Index column) { return direction.dot(term.amplitude.col(column)); };
  switch (term.shape) {
    case TermShape::kConstant:
      add(Suffixed("amplitude", unit), direction.dot(term.offset));
      return n;
    case TermShape::kLinear:
      if (term.amplitude.cols() > 1) {
        add(Suffixed("slope", Over(unit, by)), term.amplitude.norm());
        return n;
      }
      [[fallthrough]];
    case TermShape::kBeyond:
    case TermShape::kBelow:
    case TermShape::kBand:
    case TermShape::kRelaxing:
    case TermShape::kPlay:
    case TermShape::kSmoothPlay:
    case TermShape::kPastPlane:
      add(Suffixed("slope", Over(unit, by)), along(0));
      break;
    case TermShape::kQuadratic:
      if (term.amplitude.cols() > 2) {
        const Eigen::Index linear = Dimension(term.variable);
        add(Suffixed("slope", Over(unit, by)), term.amplitude.leftCols(linear).norm());
        add("curvature", term.amplitude.rightCols(term.amplitude.cols() - linear).norm());
        return n;
      }
      add(Suffixed("slope", Over(unit, by)), along(0));
      add("curvature", along(1));
      break;
    case TermShape::kRadial:
      add(Suffixed("bend", unit), term.amplitude.norm());
      return n;
    case TermShape::kPeriodic: {
      add(Suffixed("amplitude", unit), Swing(term).norm());
      double phase = PhaseOf(term) + (direction.dot(Swing(term)) < 0.0 ? std::numbers::pi : 0.0);
      phase -= kTwoPi * std::floor(phase / kTwoPi);
      add("phase_rad", phase);
      break;
    }
    case TermShape::kSmooth:
      for (Eigen::Index j = 0; j < term.amplitude.cols(); ++j)
        add(Suffixed(fmt::format("knot_{}", j), unit), along(j));
      break;
    default:
      add(Suffixed("amplitude", unit), along(0));
  }
  if (term.offset.size() > 0) add(Suffixed("offset", unit), direction.dot(term.offset));
  return n;
}

/// The names of the shape's parameters.
std::vector<std::string> AtNames(const Term& term) {
  const std::string by = UnitOf(term.variable, term.target);
  switch (term.shape) {
    case TermShape::kLinear:
    case TermShape::kQuadratic:
      return ShapeParameters(term.shape, term.variable) == 0
                 ? std::vector<std::string>{}
                 : std::vector<std::string>{Suffixed("about", by)};
    case TermShape::kPeriodic:
      return {term.variable == TermVariable::kTime ? "frequency_hz" : Suffixed("waves_1", by)};
    case TermShape::kStep:
      return {Suffixed("at", by), Suffixed("within", by)};
    case TermShape::kBeyond:
    case TermShape::kBelow:
      return {Suffixed("at", by)};
    case TermShape::kBand:
      return {Suffixed("limit", by)};
    case TermShape::kTanh:
      return {Suffixed("width", by)};
    case TermShape::kExponential:
    case TermShape::kAfter:
      return {term.variable == TermVariable::kTime ? "time_constant_s" : Suffixed("scale", by),
              Suffixed("from", by)};
    case TermShape::kRelaxing:
      return {"time_constant_s"};
    case TermShape::kPlay:
    case TermShape::kSmoothPlay:
      return {Suffixed("half_width", by)};
    case TermShape::kInversePower:
      return {"place_x_m", "place_y_m", "place_z_m", "power"};
    case TermShape::kPastPlane:
      return {"normal_x", "normal_y", "normal_z", "plane_m"};
    case TermShape::kSmooth:
      return {Suffixed("from", by), Suffixed("to", by)};
    default:
      return {};
  }
}

}  // namespace

Eigen::VectorXd DirectionOf(const Term& term) {
  Eigen::VectorXd v = Leading(term);
  const double norm = v.norm();
  if (!(norm > 0.0)) return Eigen::VectorXd::Unit(term.Inputs(), 0);
  Eigen::Index largest = 0;
  v.cwiseAbs().maxCoeff(&largest);
  const bool flip = term.shape == TermShape::kPeriodic && v[largest] < 0.0;
  return (flip ? -v : v) / norm;
}

std::vector<ReportedParameter> TermParameters(const Term& term, const Eigen::MatrixXd& covariance,
                                              const std::vector<double>& at_sd) {
  const Numbers found = Amplitudes(term);
  const Eigen::Index amplitudes = term.amplitude.size(), n = amplitudes + term.offset.size();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(Eigen::Index(found.values.size()), n);
  for (Eigen::Index j = 0; j < n && covariance.rows() >= n; ++j) {
    const double h = 1e-3 * std::sqrt(std::max(0.0, covariance(j, j)));
    if (h <= 0.0) continue;
    Term moved = term;
    (j < amplitudes ? moved.amplitude.reshaped()[j] : moved.offset[j - amplitudes]) += h;
    const Numbers at = Amplitudes(moved);
    for (std::size_t i = 0; i < at.values.size(); ++i) {
      double d = at.values[i] - found.values[i];
      if (found.names[i] == "phase_rad") d = std::remainder(d, kTwoPi);
      J(Eigen::Index(i), j) = d / h;
    }
  }
  std::vector<ReportedParameter> parameters;
  for (std::size_t i = 0; i < found.values.size(); ++i) {
    double variance = 0.0;
    const Eigen::RowVectorXd row = J.row(Eigen::Index(i));
    if (covariance.rows() >= n) variance = row * covariance.topLeftCorner(n, n) * row.transpose();
    parameters.push_back({found.names[i], {found.values[i]}, {std::sqrt(std::max(0.0, variance))}});
  }
  const std::vector<std::string> names = AtNames(term);
  for (std::size_t i = 0; i < names.size(); ++i)
    parameters.push_back({names[i], {term.at[i]}, {i < at_sd.size() ? at_sd[i] : 0.0}});
  return parameters;
}

std::string TextOf(const Term& term) {
  const TermTargetInfo& info = InfoOf(term.target);
  const std::string unit = info.unit, by = UnitOf(term.variable, term.target);
  const std::string what = info.spoken, on = Spoken(term.variable);
  const auto parameters = Amplitudes(term);
  const double size = parameters.values.empty() ? 0.0 : parameters.values[0];
  const std::string much = ShownSize(std::abs(size), unit);
  const auto at = [&](std::size_t i) { return Shown(term.at[i], by); };
  switch (term.shape) {
    case TermShape::kConstant:
      return fmt::format("{} is off by {} everywhere", what, much);
    case TermShape::kLinear:
      if (unit == by && term.variable != TermVariable::kTime)
        return fmt::format("{} changes by {:.3g} of {}", what, std::abs(size), on);
      return fmt::format("{} changes in proportion to {}, by {}{}", what, on, much, Per(by));
    case TermShape::kQuadratic:
      return fmt::format("{} changes with {} as a parabola", what, on);
    case TermShape::kPeriodic:
      if (term.variable == TermVariable::kTime)
        return fmt::format("{} swings by {} at {:.4g} Hz", what, much, term.at[0]);
      return fmt::format("{} swings by {} with {}, once every {}", what, much, on,
                         Shown(1.0 / term.at[0], by));
    case TermShape::kStep:
      return fmt::format("{} jumps by {} where {} passes {}", what, much, on, at(0));
    case TermShape::kBeyond:
      return fmt::format("{} goes off where {} is beyond {}", what, on, at(0));
    case TermShape::kBelow:
      return fmt::format("{} goes off where {} is below {}", what, on, at(0));
    case TermShape::kBand:
      return fmt::format("{} goes off where {} is more than {} from zero", what, on, at(0));
    case TermShape::kTanh:
      return fmt::format("{} is off by up to {} with {}, saturating at about {}", what, much, on,
                         at(0));
    case TermShape::kExponential:
      return fmt::format(
          "{} {} by {} with {}, on a scale of {}", what,
          FormOf(term) == TermForm::kDecaying ? "has an error that decays" : "drifts", much, on,
          at(0));
    case TermShape::kAfter:
      return fmt::format("{} jumps by {} where {} passes {} and recovers within about {}", what,
                         much, on, at(1), at(0));
    case TermShape::kRelaxing:
      return fmt::format("{} follows changes of {} and relaxes within about {:.3g} s", what, on,
                         term.at[0]);
    case TermShape::kPlay:
    case TermShape::kSmoothPlay:
      return fmt::format("{} depends on the way that {} came: hysteresis of {}", what, on,
                         Shown(2.0 * term.at[0], by));
    case TermShape::kInversePower:
      return fmt::format(
          "{} is off near ({:.3f}, {:.3f}, {:.3f}) m in R, with the distance to the power -{:.2g}",
          what, term.at[0], term.at[1], term.at[2], term.at[3]);
    case TermShape::kPastPlane:
      return fmt::format(
          "{} goes off where the place is beyond a plane of normal ({:.2f}, {:.2f}, {:.2f}) in R",
          what, term.at[0], term.at[1], term.at[2]);
    case TermShape::kRadial:
      return fmt::format("{} is off by the cube of {}, as through a lens", what, on);
    case TermShape::kSmooth:
      return fmt::format("{} changes smoothly with {} between {} and {}; no simple form fits", what,
                         on, at(0), at(1));
  }
  return what;
}

}  // namespace flextip::diagnosis
