#include "bench/vision/clip.h"

#include <cmath>
#include <numbers>

#include "simulation/render/laparoscope.h"

namespace flextip::bench {
namespace {

constexpr double kDepth_m = 0.11, kBehindTip_m = 0.03, kGamma = 2.2;

TagCollar PlaneCollar(double size_m, int tags, int rows) {
  constexpr double kPitch = 1.35;  // of the tags over their size
  const int along = tags / rows;
  TagCollar collar;
  for (int i = 0; i < tags; ++i) {
    // Rows are half a tag apart along the shaft: the renderer makes one prism of tags side by side.
    const double row = i / along - 0.5 * (rows - 1);
    const double place = i % along - 0.5 * (along - 1) + 0.5 * row;
    const double back_m = kBehindTip_m + place * kPitch * size_m;
    CollarTag tag = RingCollar("tag36h11", size_m, 6, 1.0, back_m, i).tags[0];
    tag.T_EG.p += row * kPitch * size_m * tag.T_EG.R.col(1);
    collar.tags.push_back(tag);
  }
  return collar;
}

}  // namespace

Eigen::Vector3d ClipMiddle_E() { return {-kBehindTip_m, 0, 0}; }

Pose ClipPose(const ClipCase& one, int frame) {
  const double angle = frame * one.step_px / one.circle_px;
  const double circle_m = one.circle_px * kDepth_m / BenchCamera(one.width_px, kGamma).fu_px;
  const Eigen::Vector3d middle_C(circle_m * std::cos(angle), circle_m * std::sin(angle), kDepth_m);
  const double slow = 2 * std::numbers::pi * frame / 90;
  return CollarSeen(middle_C, 0.6 + 0.2 * std::cos(slow), 0.3 * std::sin(slow),
                    0.3 * std::sin(1.3 * slow), kBehindTip_m);
}

TagCollar ClipCollar(const ClipCase& one) {
  const double size_m = one.tag_px * kDepth_m / BenchCamera(one.width_px, kGamma).fu_px;
  return one.tags > 0 ? PlaneCollar(size_m, one.tags, one.rows)
                      : RingCollar("tag36h11", size_m, 6, 1.0, kBehindTip_m);
}

Clip MakeClip(const ClipCase& one, int frames) {
  Clip clip{BenchCamera(one.width_px, kGamma), ClipCollar(one), {}, {}};
  simulation::LaparoscopeOptions o;
  o.grey = true;
  o.exposure = 0.7;
  o.exposure_distance_m = kDepth_m;
  o.tissue.point_R = clip.camera.T_RC * Eigen::Vector3d(0, 0, kDepth_m + 0.05);
  o.tissue.normal_R = clip.camera.T_RC.R * Eigen::Vector3d(0.2, -0.3, -1).normalized();
  const simulation::Laparoscope scope(clip.camera, clip.collar, o);
  const double apothem_m = RingApothem_m("tag36h11", clip.collar.tags[0].size_m, 6, 1.0);
  for (int i = one.first; i < one.first + frames; ++i) {
    clip.T_CE.push_back(ClipPose(one, i));
    const simulation::ShaftCurve shaft =
        ArcShaft(clip.camera.T_RC * clip.T_CE.back(), 1.0, std::min(0.004, 1.2 * apothem_m));
    clip.frames.push_back(scope.Render(shaft, i));
  }
  return clip;
}

}  // namespace flextip::bench
