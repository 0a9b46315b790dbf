#include "plausibility/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/median.h"

namespace flextip::plausibility {
namespace {

constexpr double kSoftest_Pa = 1e9, kStiffest_Pa = 400e9;

struct Unit {
  double factor;
  const char* name;
};

class Limits {
 public:
  Limits(const Recording& given, Recording& repaired) : given_(given), repaired_(repaired) {}

  std::vector<Finding> findings;

  void AddAll() {
    Length();
    Diameter();
    Stiffness();
    Gravity();
    if (given_.strain0) Stations();
    if (given_.load0) LoadSize();
    if (given_.em0) EmDistance();
    if (given_.cam0) Camera(given_.cam0->calibration, "cam0");
    if (given_.cam1) Camera(given_.cam1->calibration, "cam1");
    if (given_.tags0) Tags();
  }

 private:
  void Wrong(const std::string& id, std::string text, std::string mend) {
    findings.push_back({Severity::kWrong, id, std::move(text), std::move(mend)});
  }
  void Doubtful(const std::string& id, std::string text, std::string mend) {
    findings.push_back({Severity::kDoubtful, id, std::move(text), std::move(mend)});
  }

  void Length() {
    double& length = repaired_.instrument.length_m;
    constexpr double kLongest_m = 3.0, kShortest_m = 0.05;
    if (length >= kShortest_m && length <= kLongest_m) return;
    if (length < kShortest_m) {
      Doubtful("instrument.length", fmt::format("length_m: {:.4g}: no shaft is so short", length),
               "");
      return;
    }
    // 42 can be centimetres, 420 millimetres.
    const Unit unit = length > 100.0  ? Unit{1e-3, "millimetres"}
                      : length > 30.0 ? Unit{1e-2, "centimetres"}
                                      : Unit{0.0254, "inches"};
    Wrong("instrument.length_unit",
          fmt::format("length_m: {:.4g} looks like {}: no shaft is so long", length, unit.name),
          fmt::format("length_m: {:.4g} in recording.yaml", length * unit.factor));
    length *= unit.factor;
  }

  void Diameter() {
    double& diameter = repaired_.instrument.outer_diameter_m;
    constexpr double kThickest_m = 0.05, kThinnest_m = 1e-4;
    if (!(diameter > 0.0) || (diameter >= kThinnest_m && diameter <= kThickest_m)) return;
    if (diameter < kThinnest_m) {
      Doubtful("instrument.diameter_unit",
               fmt::format("outer_diameter_m: {:.4g}: no shaft is so thin", diameter), "");
      return;
    }
    Wrong("instrument.diameter_unit",
          fmt::format("outer_diameter_m: {:.4g} looks like millimetres: no shaft is so thick",
                      diameter),
          fmt::format("outer_diameter_m: {:.4g} in recording.yaml", 1e-3 * diameter));
    diameter *= 1e-3;
  }

  void Stiffness() {
    const double diameter = repaired_.instrument.outer_diameter_m;
    double& EI = repaired_.instrument.bending_stiffness_Nm2;
    if (!(diameter > 0.0) || !(EI > 0.0)) return;
    const double I = std::numbers::pi * std::pow(diameter, 4) / 64.0, modulus = EI / I;
    if (modulus <= kStiffest_Pa && (modulus >= kSoftest_Pa || modulus >= 1e-3 * kSoftest_Pa)) {
      // A tube has less than its outer diameter's section: down to a thousandth there are some.
      if (modulus < kSoftest_Pa) {
        Doubtful("instrument.stiffness",
                 fmt::format("bending_stiffness_Nm2: {:.4g} makes a modulus of {:.2g} GPa with the "
                             "diameter of {:.3g} mm: metals have 40 to 250, polymers 1 to 5",
                             EI, 1e-9 * modulus, 1e3 * diameter),
                 "");
      }
      return;
    }
    for (const Unit unit : {Unit{1e-6, "N mm2"}, Unit{1e-4, "N cm2"}, Unit{1e-3, "mN m2"},
                            Unit{1e3, "kN m2"}, Unit{1e6, "N m2 times a million"}}) {
      const double then = modulus * unit.factor;
      if (then < 8e9 || then > 300e9) continue;
      Wrong(
          "instrument.stiffness",
          fmt::format("bending_stiffness_Nm2: {:.4g} looks like {}: with the diameter of {:.3g} mm "
                      "its modulus would be {:.3g} GPa, steel has 200",
                      EI, unit.name, 1e3 * diameter, 1e-9 * modulus),
          fmt::format("bending_stiffness_Nm2: {:.4g} in recording.yaml", EI * unit.factor));
      EI *= unit.factor;
      return;
    }
    Wrong(
        "instrument.stiffness",
        fmt::format("bending_stiffness_Nm2: {:.4g} makes a modulus of {:.3g} GPa with the diameter "
                    "of {:.3g} mm, steel has 200",
                    EI, 1e-9 * modulus, 1e3 * diameter),
        "E I: modulus (Pa) times pi d^4 / 64");
  }

  void Gravity() {
    Eigen::Vector3d& g = repaired_.gravity_m_s2;
    const double norm = g.norm();
    if (norm == 0.0) {  // how a recording says that it has none
      if (given_.instrument.mass_per_length_kg_m > 0.0) {
        Doubtful("gravity.size", "gravity_m_s2 is zero, but the shaft has a mass",
                 "gravity_m_s2: [0.0, 0.0, -9.81] in recording.yaml, or its direction in R");
      }
      return;
    }
    if (std::abs(norm - 9.81) < 0.05 * 9.81) return;
    const auto as = [&](double factor) {
      const Eigen::Vector3d mended = factor * g;
      return fmt::format("gravity_m_s2: [{:.4g}, {:.4g}, {:.4g}] in recording.yaml", mended.x(),
                         mended.y(), mended.z());
    };
    for (const Unit unit :
         {Unit{9.81, "multiples of g"}, Unit{1e-3, "mm/s2"}, Unit{1e-2, "cm/s2"}}) {
      if (std::abs(norm * unit.factor - 9.81) > 0.05 * 9.81) continue;
      Wrong(
          "gravity.unit",
          fmt::format("gravity_m_s2 looks like {}: its size is {:.4g}, not 9.81", unit.name, norm),
          as(unit.factor));
      g *= unit.factor;
      return;
    }
    Wrong("gravity.size", fmt::format("gravity_m_s2 has the size {:.4g}, not 9.81", norm),
          as(9.81 / norm));
  }

  void Stations() {
    const double length = repaired_.instrument.length_m;
    auto& s = repaired_.strain0->station_from_wrist_m;
    if (s[1] > 30.0 * length) {
      Wrong("strain0.stations",
            fmt::format("strain0: the stations at {:.4g} and {:.4g} m look like millimetres", s[0],
                        s[1]),
            fmt::format("stations_from_wrist_m: [{:.4g}, {:.4g}] in strain0/sensor.yaml",
                        1e-3 * s[0], 1e-3 * s[1]));
      s[0] *= 1e-3, s[1] *= 1e-3;
      return;
    }
    if (s[0] > 0.0 && s[1] < length && s[0] < s[1]) return;
    if (s[0] > s[1] && s[1] > 0.0 && s[0] < length) {
      Wrong("strain0.stations",
            fmt::format(
                "strain0: the first station, at {:.4g} m, lies beyond the second, at {:.4g} m",
                s[0], s[1]),
            fmt::format("stations_from_wrist_m: [{:.4g}, {:.4g}], or exchange the columns as well",
                        s[1], s[0]));
      std::swap(s[0], s[1]);
      return;
    }
    Wrong("strain0.stations",
          fmt::format(
              "strain0: the stations at {:.4g} and {:.4g} m do not lie on the shaft of {:.4g} "
              "m",
              s[0], s[1], length),
          "stations_from_wrist_m: distances from the wrist along the shaft, the nearer one first");
    repaired_.strain0.reset();
  }

  void LoadSize() {
    std::vector<double> sizes;
    for (const auto& f : given_.load0->f_tip_N) sizes.push_back(f.value.norm());
    constexpr double kLargest_N = 100.0;
    const double large = Quantile(sizes, 0.9);
    if (large < kLargest_N) return;
    // In mN more often than not; the relations to other sensors may say grams.
    load_is_large_ = true;
    findings.push_back(
        {Severity::kWrong, "load0.large",
         fmt::format("load0: forces reach {:.4g} N, an instrument's tip has some N", large),
         "import with --unit load0=mN where the numbers are mN"});
  }

  void EmDistance() {
    const double length = repaired_.instrument.length_m;
    double& distance = repaired_.em0->distance_from_tip_m;
    if (distance >= 0.0 && distance <= length) return;
    const bool mm = distance > length && 1e-3 * distance < length;
    Wrong("em0.distance",
          fmt::format("em0: distance_from_tip_m: {:.4g} is beyond the shaft of {:.4g} m{}",
                      distance, length, mm ? ": it looks like millimetres" : ""),
          mm ? fmt::format("distance_from_tip_m: {:.4g} in em0/sensor.yaml", 1e-3 * distance) : "");
    if (mm) distance *= 1e-3;
  }

  void Camera(const CameraCalibration& c, const std::string& name) {
    if (c.width_px <= 0 || c.height_px <= 0) return;
    const double w = c.width_px, h = c.height_px;
    const double x = c.cu_px / w, y = c.cv_px / h;
    const auto near = [](double a, double b) { return std::abs(a - b) < 0.13; };
    for (const double k : {2.0, 0.5, 4.0, 0.25}) {
      if (!near(x, 0.5 * k) || !near(y, 0.5 * k) || std::abs(x - 0.5) < 0.13) continue;
      if (k < 1.0 && !(std::abs(x - 0.5 * k) < 0.1 * k && std::abs(y - 0.5 * k) < 0.1 * k))
        continue;
      Wrong(
          name + ".resolution",
          fmt::format("{}: intrinsics look like those of {:g} x {:g} pixels: the principal point "
                      "{:.0f}, {:.0f} is {} of a picture of {} x {}",
                      name, k * w, k * h, c.cu_px, c.cv_px,
                      k > 1.0 ? "near the corner" : "in the upper left", c.width_px, c.height_px),
          fmt::format("intrinsics: [{:.6g}, {:.6g}, {:.6g}, {:.6g}] in {}/sensor.yaml", c.fu_px / k,
                      c.fv_px / k, (c.cu_px + 0.5) / k - 0.5, (c.cv_px + 0.5) / k - 0.5, name));
      if (name == "cam0") {
        CameraCalibration& mended = repaired_.cam0->calibration;
        mended.fu_px /= k, mended.fv_px /= k, mended.cu_px /= k, mended.cv_px /= k;
      }
      return;
    }
    bool odd = false;
    if (x < -0.1 || x > 1.1 || y < -0.1 || y > 1.1) {
      odd = true;
      Wrong(name + ".principal_point",
            fmt::format("{}: the principal point {:.4g}, {:.4g} is outside the picture of {} x {}",
                        name, c.cu_px, c.cv_px, c.width_px, c.height_px),
            "intrinsics: [fu, fv, cu, cv] in pixels, in this order");
    }
    const double widest = c.fu_px / w, ratio = c.fu_px / c.fv_px;
    constexpr double kWidest = 0.2, kNarrowest = 8.0;
    if (widest < kWidest || widest > kNarrowest) {
      Wrong(name + ".focal_length",
            fmt::format(
                "{}: a focal length of {:.4g} px over a width of {} px is a field of view of "
                "{:.1f} degrees{}",
                name, c.fu_px, c.width_px, 2.0 * std::atan(0.5 / widest) * 180.0 / std::numbers::pi,
                widest < kWidest ? ": it looks like millimetres" : ""),
            "intrinsics: [fu, fv, cu, cv] in pixels: mm divided by the pixel's size");
      odd = true;
    } else if (!odd && (ratio < 0.7 || ratio > 1.4)) {
      Doubtful(
          name + ".focal_length",
          fmt::format("{}: the focal lengths {:.4g} and {:.4g} px make pixels that are not square",
                      name, c.fu_px, c.fv_px),
          "intrinsics: [fu, fv, cu, cv] in pixels, in this order");
      odd = true;
    }
    if (odd && name == "cam0") repaired_.cam0->calibration.fu_px = 0.0;  // its view says nothing
    const Eigen::Matrix3d& R = c.T_RC.R;
    if ((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() > 1e-2 || R.determinant() < 0.0) {
      Wrong(name + ".T_RC",
            fmt::format("{}: the rotation of T_RC is none: its determinant is {:.3g}", name,
                        R.determinant()),
            "T_RC: rotation by rows, with the translation in the last column");
    }
  }

  void Tags() {
    const auto& tags = given_.tags0->tags;
    if (tags.empty()) return;
    double largest = 0.0;
    for (const CollarTag& tag : tags) largest = std::max(largest, tag.size_m);
    constexpr double kLargest_m = 0.06;
    if (largest > kLargest_m) {
      Wrong("tags0.unit",
            fmt::format("tags0: a tag of {:.4g} m looks like {}: none so large fits an instrument",
                        largest, largest > 0.9 ? "millimetres" : "centimetres"),
            fmt::format("size_m: {:.4g} in tags0/sensor.yaml",
                        largest > 0.9 ? 1e-3 * largest : 1e-2 * largest));
      repaired_.tags0.reset();
      return;
    }
    // Tags around the shaft at one place are sides of a prism.
    std::map<long, std::vector<const CollarTag*>> rings;
    for (const CollarTag& tag : tags) rings[std::lround(tag.T_EG.p.x() * 1e3)].push_back(&tag);
    for (const auto& [x_mm, ring] : rings) {
      if (ring.size() < 3) continue;
      double radius = 0.0, size = 0.0;
      for (const CollarTag* tag : ring) {
        radius = std::max(radius, tag->T_EG.p.tail<2>().norm());
        size = std::max(size, tag->size_m);
      }
      const double side =
          2.0 * radius * std::tan(std::numbers::pi / static_cast<double>(ring.size()));
      if (size <= 1.05 * side) continue;
      Wrong("tags0.size",
            fmt::format(
                "tags0: {} tags of {:.3g} mm do not fit around the collar: a radius of {:.3g} "
                "mm leaves {:.3g} mm for each",
                ring.size(), 1e3 * size, 1e3 * radius, 1e3 * side),
            "size_m, the black border's outer edge, and T_EG in tags0/sensor.yaml");
      return;
    }
  }

  const Recording& given_;
  Recording& repaired_;
  bool load_is_large_ = false;
};

}  // namespace

std::vector<Finding> CheckLimits(const Recording& recording, Recording& repaired) {
  Limits limits(recording, repaired);
  limits.AddAll();
  return limits.findings;
}

}  // namespace flextip::plausibility
