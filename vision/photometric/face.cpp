#include "vision/photometric/face.h"

#include <algorithm>
#include <cmath>

#include "vision/photometric/pixel_choice.h"
#include "vision/photometric/tag_blur.h"

namespace flextip {
namespace {

constexpr double kMinCosine = 0.105;         // of the angle between normal and view: 84 degrees
constexpr double kPixelVariance = 1.0 / 12;  // of a pixel's own square
constexpr float kReachOfUnknown = 3.2f;      // sigmas kept from what is not known
constexpr double kMaxBlur_cells = 1.6;
constexpr int kFewestPixels = 30;
constexpr float kSampledShare = 0.9f;     // of the pixels near edges: up to it they are drawn
constexpr double kFlatPart = 0.4;         // of drawn pixels, flat ones to those near edges
constexpr double kHiddenRim_cells = 0.5;  // of a tag's rim that a neighbour may hide

}  // namespace

// Rays to the tag's cells: (a, b, 1/z) = to_tag (mx, my, 1), u = a z, v = b z.
struct PhotometricFace::Geometry {
  Eigen::Matrix3f to_tag;
  Eigen::Matrix2f m_of_px;  // derivative of the ray at the tag's centre
  PatternBlur blur;         // on the tag, in cells, at its centre
  Eigen::Vector3f bend;     // of the light: by fu^2, fu fv, fv^2
  float half = 0, depth = 0;
  Pose T_CG;
  Eigen::Matrix2d spread_px = Eigen::Matrix2d::Identity();  // the blur, pixels included
  bool valid = false;

  struct Place {
    float u, v, z, nearness;  // z: depth; nearness: the middle's over it
  };
  Place At(float mx, float my) const {
    const float w = to_tag(2, 0) * mx + to_tag(2, 1) * my + to_tag(2, 2);
    const float z = 1 / w;
    return {(to_tag(0, 0) * mx + to_tag(0, 1) * my + to_tag(0, 2)) * z,
            (to_tag(1, 0) * mx + to_tag(1, 1) * my + to_tag(1, 2)) * z, z, depth * w};
  }
};

PhotometricFace::PhotometricFace(const CollarTag& tag, const TagCells& cells,
                                 const std::array<Side, 4>& sides)
    : tag_(tag), pattern_(cells), cell_m_(tag.size_m / cells.border_cells), sides_(sides) {}

double PhotometricFace::Cosine(const Pose& T_CE) const {
  const Pose T_CG = T_CE * tag_.T_EG;
  return T_CG.R.col(2).dot(T_CG.p) / T_CG.p.norm();
}

// Returns the limits of the tag's surroundings in cells from the top left corner: u low, u high, v
// low, v high. A neighbour that is turned more toward the camera may hide this tag's rim: its plate
// need not end where the planes meet.
Eigen::Vector4f PhotometricFace::Limits(const Pose& T_CE) const {
  Eigen::Vector4f limits;
  const double half = 0.5 * pattern_.Cells(), border = 0.5 * tag_.size_m / cell_m_;
  for (int i = 0; i < 4; ++i) {
    double reach = sides_[i].reach_m / cell_m_;
    if (sides_[i].neighbour_T_EG) {
      const Pose T_CN = T_CE * *sides_[i].neighbour_T_EG;
      if (T_CN.R.col(2).dot(T_CN.p) / T_CN.p.norm() > Cosine(T_CE)) {
        reach = std::min(reach, border - kHiddenRim_cells);
      }
    }
    limits[i] = static_cast<float>(half + (i % 2 == 0 ? -reach : reach));
  }
  return limits;
}

PhotometricFace::Geometry PhotometricFace::Place(const CameraModel& camera, const Pose& T_CE,
                                                 const Optics& optics) const {
  Geometry g;
  Pose T_CG = T_CE * tag_.T_EG;
  T_CG.p -= optics.print_offset_m * T_CG.R.col(2);
  const double half = 0.5 * pattern_.Cells();
  Eigen::Matrix3d from_tag;
  from_tag << cell_m_ * T_CG.R.col(0), cell_m_ * T_CG.R.col(1),
      T_CG.p - half * cell_m_ * (T_CG.R.col(0) + T_CG.R.col(1));
  const Eigen::Matrix3d to_tag = from_tag.inverse();
  if (!to_tag.allFinite()) return g;
  g.to_tag = to_tag.cast<float>();
  g.half = static_cast<float>(half);
  g.depth = static_cast<float>(T_CG.p.z());
  // The light of a matt surface, lit from the lens, bends over the tag. It falls with the square of
  // the distance and aslant, |p|^-3 in all. The linear part is left to the slopes.
  const double distance2 = T_CG.p.squaredNorm(), side2 = std::pow(half * cell_m_, 2) / distance2;
  const Eigen::Vector2d along = T_CG.R.leftCols<2>().transpose() * T_CG.p / std::sqrt(distance2);
  g.bend = (side2 * Eigen::Vector3d(7.5 * along[0] * along[0] - 1.5, 15 * along[0] * along[1],
                                    7.5 * along[1] * along[1] - 1.5))
               .cast<float>();

  Eigen::Matrix2d spread_px;
  spread_px << optics.blur_px2[0] + kPixelVariance, optics.blur_px2[1], optics.blur_px2[1],
      optics.blur_px2[2] + kPixelVariance;
  Eigen::Matrix<double, 2, 3> J;
  if (!camera.Project(T_CG.p, &J)) return g;
  const Eigen::Matrix2d m_of_px = (T_CG.p.z() * J.leftCols<2>()).inverse();
  g.blur = BlurOnTag(to_tag, m_of_px * spread_px * m_of_px.transpose(), half, T_CG.p.z());
  if (!(g.blur.sigma_u < kMaxBlur_cells && g.blur.sigma_v < kMaxBlur_cells)) return g;
  g.m_of_px = m_of_px.cast<float>();
  g.T_CG = T_CG;
  g.spread_px = spread_px;
  g.valid = true;
  return g;
}

bool PhotometricFace::IsSeen(const CameraModel& camera, const Pose& T_CE) const {
  if (Cosine(T_CE) < kMinCosine) return false;
  const auto px = camera.Project(T_CE * tag_.T_EG.p);
  const CameraCalibration& c = camera.Calibration();
  return px && px->x() > 0 && px->y() > 0 && px->x() < c.width_px - 1 && px->y() < c.height_px - 1;
}

double PhotometricFace::PixelsPerSigma(const CameraModel& camera, const Pose& T_CE,
                                       const Optics& optics) const {
  Eigen::Matrix<double, 2, 3> J;
  if (!camera.Project(T_CE * tag_.T_EG.p, &J)) return 0;
  const double cell_px = J(0, 0) * cell_m_ * 0.5 * (1 + Cosine(T_CE));
  const double sigma_px =
      std::sqrt(0.5 * (optics.blur_px2[0] + optics.blur_px2[2]) + kPixelVariance);
  return 2 * sigma_px * cell_px * pattern_.Edges();
}

void PhotometricFace::SelectPixels(const CameraModel& camera, const LensMap& lens,
                                   const Image& image, const Pose& T_CE, const Optics& optics,
                                   const Choice& choice) {
  pixels_.Clear();
  const Geometry g = Place(camera, T_CE, optics);
  if (!g.valid) return;
  const Pose T_CG = T_CE * tag_.T_EG;
  const double reach = 0.5 * cell_m_ * pattern_.Cells();
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  TagRegion region;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const auto px = camera.Project(T_CG * Eigen::Vector3d((i - 1) * reach, (j - 1) * reach, 0));
      if (!px) return;
      region.places_px[j][i] = *px;
      low = low.cwiseMin(*px);
      high = high.cwiseMax(*px);
    }
  }
  const auto& p = region.places_px;
  region.x0 = std::max(0, static_cast<int>(low.x()));
  region.y0 = std::max(0, static_cast<int>(low.y()));
  region.x1 = std::min(lens.WidthPx() - 1, static_cast<int>(high.x()) + 1);
  region.y1 = std::min(lens.HeightPx() - 1, static_cast<int>(high.y()) + 1);
  region.to_tag = g.to_tag;
  region.unknown_u = kReachOfUnknown * g.blur.sigma_u;
  region.unknown_v = kReachOfUnknown * g.blur.sigma_v;
  region.limits = Limits(T_CE) + Eigen::Vector4f(region.unknown_u, -region.unknown_u,
                                                 region.unknown_v, -region.unknown_v);
  region.edge_u = std::min(choice.reach * g.blur.sigma_u, 0.99f);
  region.edge_v = std::min(choice.reach * g.blur.sigma_v, 0.99f);
  region.stride = choice.stride;
  if (choice.share < kSampledShare) {
    // Where cells are small the edges' bands overlap: at random places, taken together.
    const auto& middle = p[1][1];
    const Eigen::Vector2d across = 2 * (p[1][2] - middle), down = 2 * (p[2][1] - middle);
    const double area_px = std::abs(across.x() * down.y() - across.y() * down.x());
    const double bands_px = choice.reach * PixelsPerSigma(camera, T_CE, optics);
    const double all = area_px > 0 ? area_px * -std::expm1(-bands_px / area_px) : 0;
    // Pixels that are drawn at random come twice: of n pixels n (1 - exp(-draws / n)) are seen.
    region.samples = static_cast<int>(std::lround(-all * std::log1p(-choice.share)));
    region.flat_samples = static_cast<int>(std::lround(kFlatPart * choice.share * all));
  }
  ChoosePixels(region, pattern_, lens, image, pixels_);
}

// A straight line through light against whiteness.
double PhotometricFace::GuessLevels(const CameraModel& camera, const Pose& T_CE,
                                    const Optics& optics, const ToneCurve& tone) {
  const Geometry g = Place(camera, T_CE, optics);
  if (!g.valid || Pixels() < kFewestPixels) return 0;
  double n = 0, c1 = 0, c2 = 0, l1 = 0, l2 = 0, cl = 0;
  for (std::size_t i = 0; i < pixels_.grey.size(); ++i) {
    if (pixels_.part[i] == 0) continue;
    const auto at = g.At(pixels_.mx[i], pixels_.my[i]);
    const double c = pattern_.At(at.u, at.v, g.blur, at.nearness).c;
    const double light = tone.Light(pixels_.grey[i]);
    n += 1, c1 += c, c2 += c * c, l1 += light, l2 += light * light, cl += c * light;
  }
  const double spread = c2 - c1 * c1 / n;
  if (spread < 1e-3 * n) return 0;
  const double contrast = (cl - c1 * l1 / n) / spread;
  const double black = std::max(0.0, (l1 - contrast * c1) / n);
  levels << black, 0, 0, black + contrast, 0, 0;
  const double spread_light = l2 - l1 * l1 / n;
  return contrast > 0 ? contrast * std::sqrt(spread / spread_light) : 0;
}

void PhotometricFace::Accumulate(const CameraModel& camera, const Pose& T_CE,
                                 const Eigen::Vector3d& pivot_C, const Optics& optics,
                                 const ToneCurve& tone, const RobustRule& rule,
                                 FaceSums& sums) const {
  const Geometry g = Place(camera, T_CE, optics);
  if (!g.valid) return;
  const FaceModel model{g.to_tag, g.m_of_px, pivot_C.cast<float>(), g.blur, g.depth,
                        g.half,   g.bend,    levels.cast<float>()};
  FaceSums::Rows rows;
  AddFaceRows(pixels_, model, pattern_, tone, rule, rows, sums);
  sums.Finish(rows, g.T_CG.R.col(2),
              SpreadOfTag(g.T_CG, pivot_C, g.m_of_px.cast<double>(), g.spread_px));
}

}  // namespace flextip
