#include "targets/collar/accuracy.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "targets/collar/tag_information.h"
#include "vision/tags/cells.h"
#include "vision/tags/collar_pose.h"

namespace flextip {
namespace {

constexpr double kModelNoise_px = 0.015;  // PhotometricOptions::model_noise_px
constexpr double kSeenCosine = 0.3;  // tags at 75 degrees are not read (docs/results/vision.md)
constexpr int kRolls = 7;            // within the angle of a face
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Returns the pose whose collar has its middle on the optical axis.
Pose PoseAt(const TagCollar& collar, double distance_m, double lean_rad, double roll_rad) {
  Eigen::Vector3d middle_E = Eigen::Vector3d::Zero();
  for (const CollarTag& tag : collar.tags) {
    middle_E += tag.T_EG.p / static_cast<double>(collar.tags.size());
  }
  Pose T_CE;
  T_CE.R = ExpRotation({0.0, -lean_rad, 0.0}) * ExpRotation({roll_rad, 0.0, 0.0});
  T_CE.p = Eigen::Vector3d(0.0, 0.0, distance_m) - T_CE.R * middle_E;
  return T_CE;
}

/// Returns what all tags in view tell of the pose by corners with an error of kModelNoise_px an
/// axis.
Matrix6 CornerInformation(const TagCollar& collar, const CameraCalibration& camera,
                          const Pose& T_CE) {
  Matrix6 information = Matrix6::Zero();
  for (const CollarTag& tag : collar.tags) {
    const Pose T_CG = T_CE * tag.T_EG;
    if (T_CG.R.col(2).dot(T_CG.p) < kSeenCosine * T_CG.p.norm()) continue;
    for (const Eigen::Vector3d& x_E : CornersInE(tag)) {
      const Eigen::Vector3d arm = T_CE.R * x_E, x = arm + T_CE.p;
      Eigen::Matrix<double, 2, 3> by_point;
      by_point << camera.fu_px / x.z(), 0.0, -camera.fu_px * x.x() / (x.z() * x.z()), 0.0,
          camera.fv_px / x.z(), -camera.fv_px * x.y() / (x.z() * x.z());
      Eigen::Matrix<double, 2, 6> J;
      J << -by_point * Skew(arm), by_point;
      information += J.transpose() * J / (kModelNoise_px * kModelNoise_px);
    }
  }
  return information;
}

/// Sums of squared errors.
struct Squares {
  double across = 0.0, depth = 0.0, direction = 0.0, worst = 0.0;
  int count = 0;

  void Add(const Matrix6& covariance, const Pose& T_CE) {
    const Eigen::Matrix3d turn = covariance.topLeftCorner<3, 3>();
    const Eigen::Matrix3d shift = covariance.bottomRightCorner<3, 3>();
    const Eigen::Vector3d along = T_CE.R.col(0);
    across += shift(0, 0) + shift(1, 1);
    depth += shift(2, 2);
    direction += turn.trace() - along.dot(turn * along);
    worst = std::max(worst, shift.trace());
    ++count;
  }
  TipError Rms() const {
    return {.tip_m = std::sqrt((across + depth) / count),
            .across_m = std::sqrt(across / count),
            .depth_m = std::sqrt(depth / count),
            .direction_rad = std::sqrt(direction / count),
            .worst_tip_m = std::sqrt(worst)};
  }
};

AccuracyAtDistance AccuracyAt(const TagCollar& collar, const ViewingConditions& conditions,
                              double distance_m) {
  Squares least, expected;
  for (int k = 0; k < kRolls; ++k) {
    const double roll =
        2.0 * std::numbers::pi * k / (kRolls * static_cast<double>(collar.tags.size()));
    const Pose T_CE = PoseAt(collar, distance_m, conditions.lean_rad, roll);
    const PixelSetting setting{conditions.camera, conditions.noise_grey, conditions.blur_px};
    const auto bound = PoseBoundOfPixels(collar, setting, T_CE);
    const Ldlt corners(CornerInformation(collar, conditions.camera, T_CE));
    if (!bound || !corners.IsPositive()) {
      throw InputError(
          fmt::format("collar: no tag is seen in the picture at {:g} mm", 1e3 * distance_m));
    }
    least.Add(*bound, T_CE);
    expected.Add(*bound + Matrix6(corners.Inverse()), T_CE);
  }
  return {.distance_m = distance_m, .least = least.Rms(), .expected = expected.Rms()};
}

void CheckConditions(const ViewingConditions& c) {
  const auto check = [](const char* what, double found, double least, double most) {
    if (found >= least && found <= most) return;
    throw InputError(
        fmt::format("{}: found {:g}, expected {:g} to {:g}", what, found, least, most));
  };
  check("noise in grey values", c.noise_grey, 0.05, 60.0);
  check("blur in px", c.blur_px, 0.2, 10.0);
  check("lean of the shaft in degrees", c.lean_rad * 180.0 / std::numbers::pi, -80.0, 80.0);
  check("focal length in px", c.camera.fu_px, 10.0, 1e5);
  check("pixels across", std::min(c.camera.width_px, c.camera.height_px), 16, 1e5);
}

}  // namespace

std::vector<AccuracyAtDistance> AccuracyOver(const TagCollar& collar,
                                             const ViewingConditions& conditions,
                                             const std::vector<double>& distances_m) {
  CheckConditions(conditions);
  if (collar.tags.empty()) throw InputError("a collar without tags");
  const CollarTag& tag = collar.tags.front();
  const double cell_m = tag.size_m / ReadTagCells(collar.family, tag.id).border_cells;
  std::vector<AccuracyAtDistance> table;
  for (const double distance_m : distances_m) {
    if (!(distance_m > 0.001) || distance_m > 10.0) {
      throw InputError(
          fmt::format("distance: found {:g} mm, expected 1 mm to 10 m", 1e3 * distance_m));
    }
    table.push_back(AccuracyAt(collar, conditions, distance_m));
    table.back().tag_px = conditions.camera.fu_px * tag.size_m / distance_m;
    table.back().cell_px = conditions.camera.fu_px * cell_m / distance_m;
  }
  return table;
}

double ReadableTo(double cell_m, const CameraCalibration& camera) {
  return camera.fu_px * cell_m / kLeastCell_px;
}

void CheckReadable(double tag_size_m, double cell_m, const CameraCalibration& camera,
                   double distance_m) {
  const double most_m = ReadableTo(cell_m, camera);
  if (distance_m <= most_m) return;
  throw InputError(fmt::format(
      "collar: at {:g} mm a tag of {:g} mm is {:.1f} px wide, {:.1f} px a cell, and {:g} px a cell "
      "are needed; stay within {:.0f} mm, take tags of {:.1f} mm, or a camera of more pixels",
      1e3 * distance_m, 1e3 * tag_size_m, camera.fu_px * tag_size_m / distance_m,
      camera.fu_px * cell_m / distance_m, kLeastCell_px, std::floor(1e3 * most_m),
      std::ceil(1e4 * tag_size_m * distance_m / most_m) / 10.0));
}

}  // namespace flextip
