#include "targets/collar/tag_information.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "vision/photometric/tag_blur.h"
#include "vision/photometric/tone_curve.h"

namespace flextip {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBlack = 0.05, kWhite = 0.6;  // light on the prints, of the sensor's range
constexpr double kGamma = 2.2, kGammaSd = 0.4;
constexpr double kLeastCosine = 0.1;
constexpr double kPixelVariance_px2 = 1.0 / 12.0;

// A pixel's unknowns: the pose's 6, the blur's 3, gamma, and 6 of the tag's own light.
constexpr int kShared = 10, kOwn = 6;
using SharedRow = Eigen::Matrix<double, kShared, 1>;
using OwnRow = Eigen::Matrix<double, kOwn, 1>;

/// The tag's plane in the picture. A ray (mx, my, 1) meets the tag at (u, v) = rows 0 and 1 over
/// row 2 of `to_tag` times the ray, in cells from its top left corner; row 2 is one over the depth.
struct TagPlane {
  Matrix3d to_tag;
  double middle, depth_m;

  TagPlane(const Pose& T_CG, double cell_m, int cells) : middle(0.5 * cells), depth_m(T_CG.p.z()) {
    const Vector3d normal = T_CG.R.col(2);
    to_tag.row(2) = normal.transpose() / normal.dot(T_CG.p);
    for (int i = 0; i < 2; ++i) {
      const Vector3d axis = T_CG.R.col(i);
      to_tag.row(i) =
          (axis.transpose() - axis.dot(T_CG.p) * to_tag.row(2)) / cell_m + middle * to_tag.row(2);
    }
  }
};

/// The sums of one tag: the shared unknowns' information less what its own light takes away.
struct TagSums {
  Eigen::Matrix<double, kShared, kShared> shared = Eigen::Matrix<double, kShared, kShared>::Zero();
  Eigen::Matrix<double, kShared, kOwn> cross = Eigen::Matrix<double, kShared, kOwn>::Zero();
  Eigen::Matrix<double, kOwn, kOwn> own = Eigen::Matrix<double, kOwn, kOwn>::Identity();
  int pixels = 0;

  void Add(const SharedRow& s, const OwnRow& o) {
    shared += s * s.transpose();
    cross += s * o.transpose();
    own += o * o.transpose();
    ++pixels;
  }
  Eigen::Matrix<double, kShared, kShared> Information() const {
    return shared - cross * Eigen::MatrixXd(Ldlt(own).Solve(cross.transpose()));
  }
};

/// Derivatives of a pixel's grey value in units of its noise.
class PixelRows {
 public:
  PixelRows(const PixelSetting& setting, const Pose& T_CE)
      : setting_(setting), T_CE_(T_CE), tone_(setting.camera.gamma.value_or(kGamma)) {}

  /// `m`: the ray; `uv`: its place on the tag; `c`: the pattern there.
  void Add(const TagPlane& plane, const Vector2d& m, const Vector3d& at, const PatternValue& c,
           TagSums& sums) const {
    const double light = kBlack + (kWhite - kBlack) * c.c;
    const ToneCurve::Value grey = tone_.At(static_cast<float>(light));
    const double by_light = grey.by_light / setting_.noise_grey;
    const Vector2d uv = at.head<2>() / at.z();
    Matrix2d by_ray;  // of (u, v)
    by_ray = (plane.to_tag.topLeftCorner<2, 2>() - uv * plane.to_tag.row(2).head<2>()) / at.z();
    const Vector2d slope = by_ray.transpose() * Vector2d(c.c_u, c.c_v);
    // A point X of the tag goes by dw x (X - p) + dp; the picture of the tag goes with it.
    const double depth = 1.0 / at.z();
    const Vector3d X = depth * Vector3d(m.x(), m.y(), 1.0);
    const Vector3d by_point =
        Vector3d(slope.x(), slope.y(), -slope.dot(m)) * (-(kWhite - kBlack) / depth);
    SharedRow shared;
    shared.head<3>() = by_light * (X - T_CE_.p).cross(by_point);
    shared.segment<3>(3) = by_light * by_point;
    Matrix2d bend;
    bend << c.c_uu, c.c_uv, c.c_uv, c.c_vv;
    const Matrix2d in_rays = by_ray.transpose() * bend * by_ray;
    const double fu = setting_.camera.fu_px, fv = setting_.camera.fv_px;
    const Vector3d by_blur(0.5 * in_rays(0, 0) / (fu * fu), in_rays(0, 1) / (fu * fv),
                           0.5 * in_rays(1, 1) / (fv * fv));
    shared.segment<3>(6) = by_light * (kWhite - kBlack) * by_blur;
    shared[9] = setting_.camera.gamma ? 0.0 : grey.by_gamma / setting_.noise_grey;
    const Vector2d place = uv / plane.middle - Vector2d::Ones();
    OwnRow own;
    own << 1.0 - c.c, (1.0 - c.c) * place, c.c, c.c * place;
    sums.Add(shared, by_light * own);
  }

 private:
  const PixelSetting& setting_;
  const Pose& T_CE_;
  ToneCurve tone_;
};

/// The rectangle of pixels that holds the plate: first and last column, first and last row; empty
/// where a corner is behind the camera.
std::optional<std::array<int, 4>> PixelsOf(const Pose& T_CG, double half_m,
                                           const CameraCalibration& camera) {
  Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const double x : {-half_m, half_m}) {
    for (const double y : {-half_m, half_m}) {
      const Vector3d X = T_CG * Vector3d(x, y, 0.0);
      if (X.z() <= 0.0) return std::nullopt;
      const Vector2d px(camera.fu_px * X.x() / X.z() + camera.cu_px,
                        camera.fv_px * X.y() / X.z() + camera.cv_px);
      low = low.cwiseMin(px);
      high = high.cwiseMax(px);
    }
  }
  const auto within = [](double value, int size) {
    return static_cast<int>(std::clamp(value, -1.0, static_cast<double>(size)));
  };
  return std::array{std::max(0, within(std::floor(low.x()), camera.width_px)),
                    std::min(camera.width_px - 1, within(std::ceil(high.x()), camera.width_px)),
                    std::max(0, within(std::floor(low.y()), camera.height_px)),
                    std::min(camera.height_px - 1, within(std::ceil(high.y()), camera.height_px))};
}

TagSums SumsOf(const CollarTag& tag, const TagCells& cells, const PixelSetting& setting,
               const Pose& T_CE) {
  TagSums sums;
  const Pose T_CG = T_CE * tag.T_EG;
  const double cell_m = tag.size_m / cells.border_cells;
  const CameraCalibration& camera = setting.camera;
  const auto pixels = PixelsOf(T_CG, 0.5 * cells.cells * cell_m, camera);
  if (!pixels) return sums;
  const TagPlane plane(T_CG, cell_m, cells.cells);
  const double variance_px2 = setting.blur_px * setting.blur_px + kPixelVariance_px2;
  const Vector2d spread(variance_px2 / (camera.fu_px * camera.fu_px),
                        variance_px2 / (camera.fv_px * camera.fv_px));
  const PatternBlur blur =
      BlurOnTag(plane.to_tag, spread.asDiagonal(), plane.middle, plane.depth_m);
  const BlurredPattern pattern(cells);
  const PixelRows rows(setting, T_CE);
  for (int y = (*pixels)[2]; y <= (*pixels)[3]; ++y) {
    for (int x = (*pixels)[0]; x <= (*pixels)[1]; ++x) {
      const Vector2d m((x - camera.cu_px) / camera.fu_px, (y - camera.cv_px) / camera.fv_px);
      const Vector3d at = plane.to_tag * Vector3d(m.x(), m.y(), 1.0);
      const Vector2d uv = at.head<2>() / at.z();
      if (uv.minCoeff() < 0.0 || uv.maxCoeff() > cells.cells) continue;
      const auto u = static_cast<float>(uv.x()), v = static_cast<float>(uv.y());
      if (!pattern.Known(u, v, 0.0f, 0.0f)) continue;
      const auto nearness = static_cast<float>(plane.depth_m * at.z());
      rows.Add(plane, m, at, pattern.At(u, v, blur, nearness), sums);
    }
  }
  return sums;
}

}  // namespace

bool FacesCamera(const Pose& T_CG) {
  return T_CG.p.z() > 0.0 && T_CG.R.col(2).dot(T_CG.p) > kLeastCosine * T_CG.p.norm();
}

std::optional<Eigen::Matrix<double, 6, 6>> PoseBoundOfPixels(const TagCollar& collar,
                                                             const PixelSetting& setting,
                                                             const Pose& T_CE) {
  Eigen::Matrix<double, kShared, kShared> information =
      Eigen::Matrix<double, kShared, kShared>::Zero();
  int pixels = 0;
  for (const CollarTag& tag : collar.tags) {
    if (!FacesCamera(T_CE * tag.T_EG)) continue;
    const TagSums sums = SumsOf(tag, ReadTagCells(collar.family, tag.id), setting, T_CE);
    information += sums.Information();
    pixels += sums.pixels;
  }
  if (pixels == 0) return std::nullopt;
  // As wide as the quantities themselves, so that what a few pixels cannot tell stays finite.
  for (int i = 6; i < 9; ++i) information(i, i) += 1.0;
  information(9, 9) += 1.0 / (kGammaSd * kGammaSd);
  const Ldlt ldlt(information);
  if (!ldlt.IsPositive()) return std::nullopt;
  const Eigen::MatrixXd covariance = ldlt.Inverse();
  return Eigen::Matrix<double, 6, 6>(covariance.topLeftCorner<6, 6>());
}

}  // namespace flextip
