#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "plausibility/limits/limits.h"

namespace flextip::plausibility {
namespace {

// Focal lengths over the picture's width: a view of 136 degrees, and one of 7.
constexpr double kWidest = 0.2, kNarrowest = 8.0;
constexpr double kCentre = 0.13;  // of the picture: how far a principal point is off the middle

class CameraLimits {
 public:
  CameraLimits(const std::string& name, CameraCalibration& camera, std::vector<Finding>& findings)
      : name_(name), camera_(camera), findings_(findings) {}

  void CheckAll() {
    if (camera_.width_px <= 0 || camera_.height_px <= 0) return;
    CheckRotation();
    if (CheckResolution()) return;
    const bool principal_point = CheckPrincipalPoint();
    const bool focal_length = CheckFocalLength(!principal_point);
    if (principal_point || focal_length) camera_.fu_px = 0.0;  // its view says nothing
  }

 private:
  void Add(Severity severity, const char* kind, const std::string& text, std::string mend) {
    findings_.push_back({severity, name_ + kind, name_ + ": " + text, std::move(mend)});
  }
  double X() const { return camera_.cu_px / camera_.width_px; }
  double Y() const { return camera_.cv_px / camera_.height_px; }

  void CheckRotation() {
    const Eigen::Matrix3d& R = camera_.T_RC.R;
    const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).norm();
    if (off <= 1e-2 && R.determinant() > 0.0) return;
    Add(Severity::kWrong, ".T_RC",
        fmt::format("the rotation of T_RC is none: its determinant is {:.3g}", R.determinant()),
        "T_RC: rotation by rows, with the translation in the last column");
  }

  /// The principal point lies where the middle of a larger or smaller picture would be.
  bool CheckResolution() {
    if (std::abs(X() - 0.5) < kCentre) return false;
    for (const double k : {2.0, 0.5, 4.0, 0.25}) {
      const double limit = std::min(kCentre, 0.2 * k * 0.5);
      if (std::abs(X() - 0.5 * k) > limit || std::abs(Y() - 0.5 * k) > limit) continue;
      const double w = camera_.width_px, h = camera_.height_px;
      Add(Severity::kWrong, ".resolution",
          fmt::format("intrinsics look like those of {:g} x {:g} pixels: the principal point "
                      "{:.0f}, {:.0f} is {} of a picture of {} x {}",
                      k * w, k * h, camera_.cu_px, camera_.cv_px,
                      k > 1.0 ? "near the corner" : "in the upper left", camera_.width_px,
                      camera_.height_px),
          fmt::format("intrinsics: [{:.6g}, {:.6g}, {:.6g}, {:.6g}] in {}/sensor.yaml",
                      camera_.fu_px / k, camera_.fv_px / k, (camera_.cu_px + 0.5) / k - 0.5,
                      (camera_.cv_px + 0.5) / k - 0.5, name_));
      camera_.fu_px /= k, camera_.fv_px /= k, camera_.cu_px /= k, camera_.cv_px /= k;
      return true;
    }
    return false;
  }

  bool CheckPrincipalPoint() {
    if (X() >= 0.0 && X() <= 1.0 && Y() >= 0.0 && Y() <= 1.0) return false;
    Add(Severity::kWrong, ".principal_point",
        fmt::format("the principal point {:.4g}, {:.4g} is outside the picture of {} x {}",
                    camera_.cu_px, camera_.cv_px, camera_.width_px, camera_.height_px),
        "intrinsics: [fu, fv, cu, cv] in pixels, in this order");
    return true;
  }

  bool CheckFocalLength(bool square_too) {
    const double over_width = camera_.fu_px / camera_.width_px;
    if (over_width < kWidest || over_width > kNarrowest) {
      const double view_deg = 2.0 * std::atan(0.5 / over_width) * 180.0 / std::numbers::pi;
      Add(Severity::kWrong, ".focal_length",
          fmt::format("a focal length of {:.4g} px over a width of {} px is a field of view of "
                      "{:.1f} degrees{}",
                      camera_.fu_px, camera_.width_px, view_deg,
                      over_width < kWidest ? ": it looks like millimetres" : ""),
          "intrinsics: [fu, fv, cu, cv] in pixels: mm divided by the pixel's size");
      return true;
    }
    const double ratio = camera_.fu_px / camera_.fv_px;
    constexpr double kSquare = 1.4;
    if (!square_too || (ratio < kSquare && ratio > 1.0 / kSquare)) return false;
    Add(Severity::kDoubtful, ".focal_length",
        fmt::format("the focal lengths {:.4g} and {:.4g} px make pixels that are not square",
                    camera_.fu_px, camera_.fv_px),
        "intrinsics: [fu, fv, cu, cv] in pixels, in this order");
    return true;
  }

  const std::string name_;
  CameraCalibration& camera_;
  std::vector<Finding>& findings_;
};

}  // namespace

void CheckCamera(const std::string& name, CameraCalibration& camera,
                 std::vector<Finding>& findings) {
  CameraLimits(name, camera, findings).CheckAll();
}

}  // namespace flextip::plausibility
