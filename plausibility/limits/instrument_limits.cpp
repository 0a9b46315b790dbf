#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "plausibility/limits/limits.h"

namespace flextip::plausibility {
namespace {

constexpr double kShortest_m = 0.05, kLongest_m = 3.0;
constexpr double kThinnest_m = 1e-4, kThickest_m = 0.05;
// A tube's modulus counts with its full section: down to a thousandth of a polymer's there are
// some.
constexpr double kSoftest_Pa = 1e9, kSoftestTube_Pa = 1e6, kStiffest_Pa = 400e9;
constexpr double kGravity_m_s2 = 9.81;

double ModulusOf(double EI_Nm2, double diameter_m) {
  return 64.0 * EI_Nm2 / (std::numbers::pi * std::pow(diameter_m, 4));
}

struct Unit {
  double factor;
  const char* name;
};

class InstrumentLimits {
 public:
  InstrumentLimits(Recording& recording, std::vector<Finding>& findings)
      : recording_(recording), findings_(findings) {}

  void Length() {
    double& length = recording_.instrument.length_m;
    if (length >= kShortest_m && length <= kLongest_m) return;
    if (length < kShortest_m) {
      Add(Severity::kDoubtful, "instrument.length",
          fmt::format("length_m: {:.4g}: no shaft is so short", length), "");
      return;
    }
    // 42 can be centimetres, 420 millimetres.
    const Unit unit = length > 100.0  ? Unit{1e-3, "millimetres"}
                      : length > 30.0 ? Unit{1e-2, "centimetres"}
                                      : Unit{0.0254, "inches"};
    Add(Severity::kWrong, "instrument.length_unit",
        fmt::format("length_m: {:.4g} looks like {}: no shaft is so long", length, unit.name),
        fmt::format("length_m: {:.4g} in recording.yaml", length * unit.factor));
    length *= unit.factor;
  }

  void Diameter() {
    double& diameter = recording_.instrument.outer_diameter_m;
    if (!(diameter > 0.0) || (diameter >= kThinnest_m && diameter <= kThickest_m)) return;
    if (diameter < kThinnest_m) {
      Add(Severity::kDoubtful, "instrument.diameter_unit",
          fmt::format("outer_diameter_m: {:.4g}: no shaft is so thin", diameter), "");
      return;
    }
    Add(Severity::kWrong, "instrument.diameter_unit",
        fmt::format("outer_diameter_m: {:.4g} looks like millimetres: no shaft is so thick",
                    diameter),
        fmt::format("outer_diameter_m: {:.4g} in recording.yaml", 1e-3 * diameter));
    diameter *= 1e-3;
  }

  void Stiffness() {
    const double diameter = recording_.instrument.outer_diameter_m;
    double& EI = recording_.instrument.bending_stiffness_Nm2;
    if (!(diameter > 0.0) || !(EI > 0.0)) return;
    const double modulus = ModulusOf(EI, diameter);
    if (modulus >= kSoftest_Pa && modulus <= kStiffest_Pa) return;
    const std::string found = fmt::format("bending_stiffness_Nm2: {:.4g}", EI);
    const std::string of_diameter = fmt::format("with the diameter of {:.3g} mm", 1e3 * diameter);
    if (modulus >= kSoftestTube_Pa && modulus < kSoftest_Pa) {
      Add(Severity::kDoubtful, "instrument.stiffness",
          fmt::format("{} makes a modulus of {:.2g} GPa {}: metals have 40 to 250, polymers 1 to 5",
                      found, 1e-9 * modulus, of_diameter),
          "");
      return;
    }
    for (const Unit unit : {Unit{1e-6, "N mm2"}, Unit{1e-4, "N cm2"}, Unit{1e-3, "mN m2"},
                            Unit{1e3, "kN m2"}, Unit{1e6, "N m2 times a million"}}) {
      constexpr double kPolymer_Pa = 8e9, kSteel_Pa = 300e9;
      const double then = modulus * unit.factor;
      if (then < kPolymer_Pa || then > kSteel_Pa) continue;
      Add(Severity::kWrong, "instrument.stiffness",
          fmt::format("{} looks like {}: {} its modulus would be {:.3g} GPa, steel has 200", found,
                      unit.name, of_diameter, 1e-9 * modulus),
          fmt::format("bending_stiffness_Nm2: {:.4g} in recording.yaml", EI * unit.factor));
      EI *= unit.factor;
      return;
    }
    Add(Severity::kWrong, "instrument.stiffness",
        fmt::format("{} makes a modulus of {:.3g} GPa {}, steel has 200", found, 1e-9 * modulus,
                    of_diameter),
        "E I: modulus (Pa) times pi d^4 / 64");
  }

  void Gravity() {
    constexpr double kAlike = 0.05;
    Eigen::Vector3d& g = recording_.gravity_m_s2;
    const double norm = g.norm();
    if (norm == 0.0) {  // how a recording says that it has none
      if (!(recording_.instrument.mass_per_length_kg_m > 0.0)) return;
      Add(Severity::kDoubtful, "gravity.size", "gravity_m_s2 is zero, but the shaft has a mass",
          "gravity_m_s2: [0.0, 0.0, -9.81] in recording.yaml, or its direction in R");
      return;
    }
    const auto is_gravity = [](double size) {
      return std::abs(size - kGravity_m_s2) < kAlike * kGravity_m_s2;
    };
    if (is_gravity(norm)) return;
    const auto mend = [&](double factor) {
      return fmt::format("gravity_m_s2: [{:.4g}, {:.4g}, {:.4g}] in recording.yaml", factor * g.x(),
                         factor * g.y(), factor * g.z());
    };
    for (const Unit unit :
         {Unit{9.81, "multiples of g"}, Unit{1e-3, "mm/s2"}, Unit{1e-2, "cm/s2"}}) {
      if (!is_gravity(norm * unit.factor)) continue;
      Add(Severity::kWrong, "gravity.unit",
          fmt::format("gravity_m_s2 looks like {}: its size is {:.4g}, not 9.81", unit.name, norm),
          mend(unit.factor));
      g *= unit.factor;
      return;
    }
    Add(Severity::kWrong, "gravity.size",
        fmt::format("gravity_m_s2 has the size {:.4g}, not 9.81", norm),
        mend(kGravity_m_s2 / norm));
  }

 private:
  void Add(Severity severity, const std::string& id, std::string text, std::string mend) {
    findings_.push_back({severity, id, std::move(text), std::move(mend)});
  }

  Recording& recording_;
  std::vector<Finding>& findings_;
};

}  // namespace

bool IsShaftsStiffness(double EI_Nm2, double diameter_m) {
  if (!(diameter_m > 0.0)) return true;
  const double modulus = ModulusOf(EI_Nm2, diameter_m);
  return modulus >= kSoftestTube_Pa && modulus <= kStiffest_Pa;
}

void CheckInstrument(const std::set<std::string>& unknown, Recording& recording,
                     std::vector<Finding>& findings) {
  InstrumentLimits limits(recording, findings);
  if (recording.has_shaft) {  // an arm alone has no instrument to judge
    if (!unknown.contains("length")) limits.Length();
    limits.Diameter();
    if (!unknown.contains("stiffness")) limits.Stiffness();
  }
  limits.Gravity();
}

}  // namespace flextip::plausibility
