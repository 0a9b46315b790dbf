#include "plausibility/pictures/collar_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/median.h"
#include "plausibility/relations/relation.h"
#include "plausibility/scene.h"
#include "plausibility/timing/clocks.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kFewest = 3;
constexpr double kPlaceShare = 0.25, kScale = 1.8;
constexpr double kMoved_m = 0.02, kFits_m = 0.008, kOff_m = 0.015, kBetter = 0.25;

/// A place of the camera that would fit.
struct CameraFault {
  const char *id, *looks, *mend;
  Pose T_RC;
};

std::vector<CameraFault> CameraFaults(const Pose& T_RC) {
  Pose turned = T_RC;
  turned.R.col(1) = -T_RC.R.col(1);
  turned.R.col(2) = -T_RC.R.col(2);
  return {{"cam0.inverse", "T_RC looks inverted: of R in the camera",
           "write the inverse of T_RC in cam0/sensor.yaml", T_RC.Inverse()},
          {"cam0.axes", "T_RC looks made for a camera that looks along -z with y up",
           "change the sign of the second and third column of T_RC's rotation", turned}};
}

class PlaceCheck {
 public:
  PlaceCheck(const Recording& recording, const CollarPoses& poses, std::vector<Finding>& findings)
      : recording_(recording), poses_(poses), findings_(findings) {}

  void Run() {
    if (!recording_.wrist0 || !recording_.cam0->has_T_RC) return;
    if (Clock()) return;
    const Pose& T_RC = recording_.cam0->calibration.T_RC;
    const auto off = MedianDistance(T_RC);
    const double limit = kPlaceShare * recording_.instrument.length_m;
    if (!off) return;
    const std::string text = fmt::format(
        "the pictures have the tip {} from where wrist and port have it, up to {} is "
        "plausible",
        MetresText(*off), MetresText(limit));
    const bool identity = (T_RC.Matrix() - Eigen::Matrix4d::Identity()).norm() < 1e-6;
    if (*off > limit && identity) {
      Add("cam0.identity",
          "cam0: T_RC is the identity, as where nobody calibrated the camera's pose: " + text,
          "flextip calibrate hand-eye finds T_RC: --calibration hand_eye/calibration.yaml, or "
          "write it in cam0/sensor.yaml");
      return;
    }
    if (*off > limit) {
      for (const CameraFault& fault : CameraFaults(T_RC)) {
        const auto then = MedianDistance(fault.T_RC);
        if (!then || *then > 0.5 * limit) continue;
        Add(fault.id, fmt::format("cam0: {}: {}", fault.looks, text), fault.mend);
        return;
      }
    }
    if (Scale()) return;
    if (*off > limit)
      Add("cam0.pose", "cam0: " + text, "T_RC in cam0/sensor.yaml, by flextip calibrate hand-eye");
  }

 private:
  void Add(const std::string& id, std::string text, std::string mend) {
    findings_.push_back({Severity::kWrong, id, std::move(text), std::move(mend)});
  }

  std::optional<Vector3d> Expected(TimeNs t_ns) const {
    const auto wrist = PlaceAt(recording_, "wrist0", t_ns);
    if (!wrist) return {};
    return Vector3d(*wrist +
                    recording_.instrument.length_m * (recording_.p_RP - *wrist).normalized());
  }

  std::optional<double> MedianDistance(const Pose& T_RC) const {
    std::vector<double> distances;
    for (const auto& view : poses_) {
      if (const auto tip = Expected(view.t_ns))
        distances.push_back((T_RC * view.value.p - *tip).norm());
    }
    if (distances.size() < kFewest) return {};
    return Median(distances);
  }

  /// Tags that are large in all their numbers are far away.
  bool Scale() {
    std::vector<double> ratios;
    const Pose T_CR = recording_.cam0->calibration.T_RC.Inverse();
    for (const auto& view : poses_) {
      const auto tip = Expected(view.t_ns);
      if (!tip) continue;
      const Vector3d p_CE = T_CR * *tip;
      if (p_CE.z() > 0.01) ratios.push_back(view.value.p.norm() / p_CE.norm());
    }
    if (ratios.size() < kFewest) return false;
    const double ratio = Median(ratios);
    if (ratio < kScale && ratio > 1.0 / kScale) return false;
    Add("tags0.scale",
        fmt::format("tags0: by their size the tags are {:.2f} times as far from the camera as "
                    "wrist and port have the tip",
                    ratio),
        fmt::format("size_m and T_EG in tags0/sensor.yaml: {:.2f} times as large; or T_RC of cam0",
                    1.0 / ratio));
    return true;
  }

  /// What is left of seen less expected tips about their mean, with the pictures `shift_s` later.
  struct Residual {
    double rms_m = 0.0, way_m = 0.0;  ///< and how far the expected tip gets
  };
  std::optional<Residual> ResidualAt(double shift_s) const {
    const auto shift = static_cast<TimeNs>(std::llround(shift_s * 1e9));
    const Pose& T_RC = recording_.cam0->calibration.T_RC;
    std::vector<Vector3d> differences, expected;
    for (const auto& view : poses_) {
      const auto tip = Expected(view.t_ns + shift);
      if (!tip) continue;
      expected.push_back(*tip);
      differences.emplace_back(T_RC * view.value.p - *tip);
    }
    constexpr std::size_t kViews = 4;
    if (expected.size() < kViews || 10 * expected.size() < 7 * poses_.size()) return {};
    const double n = static_cast<double>(expected.size());
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& d : differences) mean += d / n;
    Residual residual;
    for (const Vector3d& d : differences) residual.rms_m += (d - mean).squaredNorm() / n;
    residual.rms_m = std::sqrt(residual.rms_m);
    for (const Vector3d& p : expected)
      residual.way_m = std::max(residual.way_m, (p - expected.front()).norm());
    return residual;
  }

  /// The pictures at another time. Takes the doubt of the clock away where they fit as they are.
  bool Clock() {
    const auto now = ResidualAt(0.0);
    if (now && now->way_m > kMoved_m && now->rms_m < kFits_m) {
      std::erase_if(findings_, [](const Finding& f) {
        return f.id == "cam0.clock" && f.severity == Severity::kDoubtful;
      });
      return false;
    }
    if (now && now->rms_m < kOff_m) return false;
    const auto& wrist = recording_.wrist0->samples;
    const double from_s = 1e-9 * static_cast<double>(wrist.front().t_ns - poses_.back().t_ns);
    const double to_s = 1e-9 * static_cast<double>(wrist.back().t_ns - poses_.front().t_ns);
    constexpr double kLongest_s = 600.0, kStep_s = 0.1;
    double best_s = 0.0, least = now ? now->rms_m : 1e300;
    for (double shift = std::max(from_s, -kLongest_s); shift <= std::min(to_s, kLongest_s);
         shift += kStep_s) {
      const auto then = ResidualAt(shift);
      if (then && then->way_m > kMoved_m && then->rms_m < least)
        least = then->rms_m, best_s = shift;
    }
    const double before = now ? now->rms_m : 0.0;
    if (!now || least > kFits_m || least > kBetter * before || std::abs(best_s) < 0.5) return false;
    findings_.push_back(ClockFinding(
        "cam0", -best_s,
        fmt::format("with this offset the tips in the pictures follow wrist and port to {:.1f} mm, "
                    "without to {:.1f} mm",
                    1e3 * least, 1e3 * before)));
    return true;
  }

  const Recording& recording_;
  const CollarPoses& poses_;
  std::vector<Finding>& findings_;
};

}  // namespace

void CheckCollarPlaces(const Recording& recording, const CollarPoses& poses,
                       std::vector<Finding>& findings) {
  if (poses.empty()) return;
  for (const Finding& f : findings) {
    const bool camera = f.Subject() == "cam0" || f.Subject() == "wrist0" || f.Subject() == "port" ||
                        f.id.starts_with("instrument.length");
    if (camera && f.severity == Severity::kWrong) return;
  }
  PlaceCheck(recording, poses, findings).Run();
}

}  // namespace flextip::plausibility
