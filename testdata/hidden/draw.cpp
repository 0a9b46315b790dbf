#include "testdata/hidden/draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "core/error.h"
#include "core/rotation.h"
#include "testdata/hidden/forms.h"

namespace flextip::hidden {
namespace {

using Rng = std::mt19937_64;

constexpr double kWithinTolerance = 2.0;  // tolerances; what is further off is not healthy

/// How a present effect's parameter is drawn around its neutral value.
enum class Form {
  kSigned,    ///< one number, either sign
  kPositive,  ///< one number without sign
  kAny,       ///< a vector of any direction
  kAcross,    ///< a vector at least half across the shaft
  kEntries,   ///< a matrix, every entry alike
  kGages,     ///< one to four of the entries
};

struct Row {
  const char *effect, *parameter;
  double tolerance, lowest, highest;  // of the deviation, for present effects
  Form form;

  std::span<const double> Neutral() const {
    return simulation::FindEffectParameter(effect, parameter).neutral;
  }
  int Count() const { return static_cast<int>(Neutral().size()); }
};

/// docs/effects.md with the plausible limits of a deviation; what is not a size (frequency, phase,
/// axis) is drawn apart.
constexpr Row kRows[] = {
    {"stiffness", "scale", 0.02, -0.4, 0.5, Form::kSigned},
    {"length", "delta_m", 0.0003, -0.008, 0.008, Form::kSigned},
    {"self_weight", "mass_per_length_kg_m", 0.003, 0.0, 0.15, Form::kPositive},
    {"precurvature", "curvature_1_m", 0.003, 0.0, 0.3, Form::kAny},
    {"port_offset", "offset_m", 0.0003, 0.0, 0.008, Form::kAcross},
    {"port_motion", "amplitude_m", 0.0001, 0.0, 0.004, Form::kAcross},
    {"port_compliance", "compliance_m_N", 0.00003, 0.0, 0.002, Form::kPositive},
    {"port_friction", "coefficient", 0.03, 0.0, 0.6, Form::kPositive},
    {"port_moment", "stiffness_Nm_rad", 0.005, 0.0, 0.3, Form::kPositive},
    {"shaft_load", "force_per_length_N_m", 0.02, 0.0, 1.0, Form::kAcross},
    {"wrist_compliance", "compliance_m_N", 0.00003, 0.0, 0.002, Form::kPositive},
    {"tip_compliance", "compliance_m_N", 0.00003, 0.0, 0.002, Form::kPositive},
    {"backlash", "width_m", 0.0001, 0.0, 0.003, Form::kPositive},
    {"em_distortion", "gradient", 0.001, 0.0, 0.03, Form::kEntries},
    {"em_latency", "delay_s", 0.003, 0.0, 0.15, Form::kPositive},
    {"camera_latency", "delay_s", 0.003, 0.0, 0.15, Form::kPositive},
    {"hand_eye", "rotation_rad", 0.001, 0.0, 0.04, Form::kAny},
    {"hand_eye", "translation_m", 0.0002, 0.0, 0.006, Form::kAny},
    {"focal_length", "scale", 0.002, -0.1, 0.1, Form::kSigned},
    {"tag_offset", "offset_m", 0.0002, 0.0, 0.004, Form::kAny},
    {"strain_gain", "gain", 0.01, -0.3, 0.3, Form::kGages},
    {"strain_drift", "rate_Nm_s", 0.00002, -0.002, 0.002, Form::kGages},
};

/// Drawn after all of the above, which stays as it was without them.
constexpr Row kLaterRows[] = {
    {"gage_rotation", "angle_rad", 0.005, -0.3, 0.3, Form::kSigned},
    {"strain_crosstalk", "matrix", 0.01, 0.0, 0.3, Form::kEntries},
    {"wrist_scale", "scale", 0.001, -0.04, 0.04, Form::kSigned},
    {"encoder_eccentricity", "amplitude_m", 0.00005, 0.0, 0.0015, Form::kPositive},
    {"em_clock", "rate", 0.00001, -0.0005, 0.0005, Form::kSigned},
    {"camera_clock", "rate", 0.00001, -0.0005, 0.0005, Form::kSigned},
    {"load_scale", "scale", 0.01, -0.3, 0.3, Form::kSigned},
    {"load_rotation", "rotation_rad", 0.005, 0.0, 0.25, Form::kAny},
    {"lens_radial", "k1", 0.005, -0.25, 0.25, Form::kSigned},
    {"camera_drift", "rotation_rate_rad_s", 0.00001, 0.0, 0.0005, Form::kAny},
    {"camera_drift", "translation_rate_m_s", 0.000002, 0.0, 0.0001, Form::kAny},
    {"em_interference", "amplitude_m", 0.00005, 0.0, 0.003, Form::kAny},
};

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}

/// A fresh one each time: no number is kept back from one parameter to the next.
double Normal(Rng& rng) { return std::normal_distribution<double>()(rng); }

double Sign(Rng& rng) { return Uniform(rng, 0.0, 1.0) < 0.5 ? -1.0 : 1.0; }

/// In tolerances, even in the logarithm.
double Magnitude(EffectSize size, Rng& rng) {
  const double range[3][2] = {{3.0, 5.0}, {8.0, 20.0}, {20.0, 40.0}};
  const auto& [from, to] = range[static_cast<int>(size)];
  return std::exp(Uniform(rng, std::log(from), std::log(to)));
}

Eigen::VectorXd Direction(int count, Rng& rng) {
  Eigen::VectorXd direction(count);
  do {
    for (double& x : direction) x = Normal(rng);
  } while (direction.norm() < 0.1);
  return direction.normalized();
}

/// Normal with a standard deviation of one, drawn again where it is beyond kWithinTolerance.
double CutNormal(Rng& rng) {
  double x = 0.0;
  do {
    x = Normal(rng);
  } while (std::abs(x) > kWithinTolerance);
  return x;
}

Eigen::VectorXd AbsentDeviation(const Row& row, Rng& rng, bool unsigned_value) {
  Eigen::VectorXd deviation(row.Count());
  for (double& x : deviation) {
    x = row.tolerance * CutNormal(rng);
    if (unsigned_value) x = std::abs(x);
  }
  return deviation;
}

Eigen::VectorXd GageDeviation(const Row& row, EffectSize size, Rng& rng) {
  Eigen::VectorXd deviation = AbsentDeviation(row, rng, false);
  std::vector<int> gages = {0, 1, 2, 3};
  std::shuffle(gages.begin(), gages.end(), rng);
  gages.resize(std::uniform_int_distribution<std::size_t>(1, 4)(rng));
  for (const int gage : gages) {
    deviation[gage] = Sign(rng) * row.tolerance * Magnitude(size, rng);
  }
  return deviation.cwiseMax(row.lowest).cwiseMin(row.highest);
}

Eigen::VectorXd PresentDeviation(const Row& row, const EffectDraw& draw, Rng& rng) {
  if (row.form == Form::kGages) return GageDeviation(row, draw.size, rng);
  const double size = row.tolerance * Magnitude(draw.size, rng);
  if (row.form == Form::kSigned) {
    return Eigen::VectorXd::Constant(1, std::clamp(Sign(rng) * size, row.lowest, row.highest));
  }
  Eigen::VectorXd direction =
      row.Count() == 1 ? Eigen::VectorXd::Ones(1) : Direction(row.Count(), rng);
  if (row.form == Form::kAcross) {
    while (direction.head<3>().cross(draw.mean_axis).norm() < 0.5) direction = Direction(3, rng);
  }
  if (row.form == Form::kEntries) {
    return (size * std::sqrt(double(row.Count())) * direction)
        .cwiseMax(-row.highest)
        .cwiseMin(row.highest);
  }
  return std::min(size, row.highest) * direction;
}

std::vector<double> Values(const Eigen::VectorXd& v) { return {v.data(), v.data() + v.size()}; }

/// What has no tolerance of its own: the breath's rhythm and the incision's rest axis.
void DrawOthers(const EffectDraw& draw, Rng& rng, HiddenLabel& label) {
  simulation::EffectParameters& breath = label.parameters["port_motion"];
  breath["frequency_hz"] = {Uniform(rng, 0.15, 0.5)};
  breath["phase_rad"] = {Uniform(rng, 0.0, 2.0 * std::numbers::pi)};
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  const double lean_y = 0.12 * Normal(rng), lean_x = 0.12 * Normal(rng);
  const Eigen::Vector2d lean(lean_x, lean_y);
  const bool along_x = Uniform(rng, 0.0, 1.0) < 0.4 && draw.mean_axis.x() > 0.9;
  if (!along_x) axis = (draw.mean_axis + NormalBasis(draw.mean_axis) * lean).normalized();
  label.parameters["port_moment"]["rest_axis"] = Values(axis);
}

void DrawLaterOthers(Rng& rng, HiddenLabel& label) {
  label.parameters["encoder_eccentricity"]["wavelength_m"] = {Uniform(rng, 0.015, 0.06)};
  label.parameters["encoder_eccentricity"]["phase_rad"] = {
      Uniform(rng, 0.0, 2.0 * std::numbers::pi)};
  label.parameters["em_interference"]["frequency_hz"] = {Uniform(rng, 1.5, 12.0)};
  label.parameters["em_interference"]["phase_rad"] = {Uniform(rng, 0.0, 2.0 * std::numbers::pi)};
}

bool Has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void CheckNames(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (!Has(simulation::CatalogueEffects(), name) && !Has(OtherForms(), name) &&
        !Has(LaterForms(), name)) {
      throw InputError(fmt::format(
          "effect \"{}\" is unknown: expected a name of docs/effects.md, or one of {}, {}", name,
          fmt::join(OtherForms(), ", "), fmt::join(LaterForms(), ", ")));
    }
  }
}

}  // namespace

std::string SensorOf(const std::string& effect) {
  if (effect.starts_with("em_")) return "em0";
  if (effect.starts_with("strain_") || effect == "gage_rotation") return "strain0";
  if (effect.starts_with("load_")) return "load0";
  const bool camera = Has({"camera_latency", "camera_clock", "camera_drift", "hand_eye",
                           "focal_length", "lens_radial", "tag_offset"},
                          effect);
  return camera ? "vision0" : "";
}

const std::vector<std::string>& OtherForms() {
  static const std::vector<std::string> names = {"port_grip", "taper", "shaft_tissue",
                                                 "second_contact", "strain_clip"};
  return names;
}

HiddenLabel DrawEffects(const EffectDraw& draw, Rng& rng) {
  CheckNames(draw.present);
  HiddenLabel label;
  label.present = draw.present;
  const auto draw_row = [&](const Row& row) {
    // A seed of its own: the others do not change with what is present, nor with draws thrown away.
    Rng own(rng());
    const bool present = Has(draw.present, row.effect);
    Eigen::VectorXd deviation = Eigen::VectorXd::Zero(row.Count());
    if (present) {
      deviation = PresentDeviation(row, draw, own);
    } else if (!draw.exact) {
      const bool weight = std::string(row.effect) == "self_weight";
      deviation =
          AbsentDeviation(row, own, row.form == Form::kPositive && (!weight || draw.massless));
    }
    for (int i = 0; i < row.Count(); ++i) deviation[i] += row.Neutral()[i];
    label.parameters[row.effect][row.parameter] = Values(deviation);
  };
  for (const Row& row : kRows) draw_row(row);
  DrawOthers(draw, rng, label);
  for (const Row& row : kLaterRows) draw_row(row);
  DrawLaterOthers(rng, label);
  return label;
}

}  // namespace flextip::hidden
