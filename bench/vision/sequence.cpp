#include "bench/vision/sequence.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/rotation.h"

namespace flextip::bench {
namespace {

using Eigen::Vector3d;

constexpr double kPortDistance_m = 0.16;
constexpr double kMaxMotion_px = 30;  // between two frames

// A collar of a size in pixels, its middle before the camera, on a shaft that leans any way.
void DrawInstrument(const std::vector<std::string>& families, Draw& draw, VisionSequence& s) {
  const double depth_m = draw.Between(0.06, 0.14);
  s.tag_px = draw.Between(18, 60);
  const double size_m = s.tag_px * depth_m / s.camera.fu_px;
  const std::string family = draw.OneOf(families);
  const int sides = draw.OneOf(std::vector<int>{4, 5, 6, 6, 8});
  const double plate = draw.Between(family == "tag36h11" ? 0.93 : 1.0, 1.15);
  const double apothem_m = RingApothem_m(family, size_m, sides, plate);
  const double behind_m = size_m + draw.Between(0.004, 0.025);
  s.collar = RingCollar(family, size_m, sides, plate, behind_m);
  s.shaft_diameter_m = std::min(0.008, draw.Between(0.5, 1.2) * apothem_m);
  s.shaft_radius_m = draw.Between(0.25, 3.0);
  const double lean = draw.Between(-0.5, 0.7), around = draw.Between(0, 2 * std::numbers::pi);
  const Vector3d d_C(std::cos(lean) * std::cos(around), std::cos(lean) * std::sin(around),
                     std::sin(lean));
  const double down = draw.Between(-0.12, 0.12), across = draw.Between(-0.25, 0.25);
  const Vector3d middle_C = depth_m * Vector3d(across, down, 1);
  TipMotion& m = s.motion;
  m.T_RC = s.camera.T_RC;
  m.p_CE0 = middle_C + behind_m * d_C;
  m.p_CP = m.p_CE0 - kPortDistance_m * d_C;
  m.roll_rad = draw.Between(-std::numbers::pi, std::numbers::pi);
}

// Swings of which the fastest goes with `speed_m_s`, though never beyond kMaxMotion_px in a frame.
void DrawMotion(Draw& draw, VisionSequence& s) {
  TipMotion& m = s.motion;
  const double px_per_m = s.camera.fu_px / m.p_CE0.z();
  const double limit_m_s = kMaxMotion_px / px_per_m * VisionSequence::kRate_hz;
  s.speed_m_s = std::min(draw.Between(0.0, 0.15), limit_m_s);
  const double z = draw.Between(0, 0.5), y = draw.Between(0.1, 0.6), x = draw.Between(0.2, 1);
  const Vector3d share = Vector3d(x, y, z).normalized();
  for (int i = 0; i < 3; ++i) {
    m.hz[i] = draw.Between(0.4, 1.5);
    m.phase[i] = draw.Between(0, 2 * std::numbers::pi);
    const double largest_m = (i == 2 ? 0.15 : 0.25) * m.p_CE0.z();
    m.swing_m[i] = std::min(share[i] * s.speed_m_s / (2 * std::numbers::pi * m.hz[i]), largest_m);
  }
  m.roll_swing_rad = draw.Between(0, 0.5);
  m.roll_hz = draw.Between(0.2, 0.8);
}

void DrawPicture(Draw& draw, VisionSequence& s) {
  simulation::LaparoscopeOptions& o = s.options;
  const double depth_m = s.motion.p_CE0.z();
  const Pose& T_RC = s.camera.T_RC;
  o.exposure_distance_m = depth_m;
  o.exposure = draw.Between(0.3, 0.9);
  o.blur_sigma_px = draw.Between(0.5, 1.1);
  o.full_well_electrons = draw.Between(4000, 15000);
  o.tissue.point_R = T_RC * Vector3d(0, 0, depth_m + draw.Between(0.04, 0.1));
  const double tilt_y = draw.Between(-0.5, 0.5), tilt_x = draw.Between(-0.5, 0.5);
  const Vector3d tilt(tilt_x, tilt_y, -1);
  o.tissue.normal_R = T_RC.R * tilt.normalized();
}

}  // namespace

Pose TipMotion::TipAt(double t_s) const {
  Vector3d p_C = p_CE0;
  for (int i = 0; i < 3; ++i) {
    p_C[i] += swing_m[i] * std::sin(2 * std::numbers::pi * hz[i] * t_s + phase[i]);
  }
  if (excursion.last >= excursion.first) {
    const double frame = t_s * VisionSequence::kRate_hz;
    const double out = std::min(frame - excursion.first, excursion.last - frame) / ramp_frames;
    const double u = std::clamp(out, 0.0, 1.0);
    p_C += u * u * (3 - 2 * u) * excursion_m;
  }
  const Vector3d d_C = (p_C - p_CP).normalized();
  const double roll = roll_rad + roll_swing_rad * std::sin(2 * std::numbers::pi * roll_hz * t_s);
  const Eigen::Matrix3d R_CE =
      RotationWithoutTwist(Vector3d::UnitX(), d_C) * ExpRotation({roll, 0, 0});
  return T_RC * Pose{R_CE, p_C};
}

bool VisionSequence::InEvent(int frame) const {
  return std::any_of(in_event.begin(), in_event.end(),
                     [&](const simulation::FrameRange& range) { return range.Has(frame); });
}

simulation::ShaftCurve VisionSequence::CurveAt(double t_s) const {
  return ArcShaft(motion.TipAt(t_s), shaft_radius_m, shaft_diameter_m);
}

Image VisionSequence::Render(const simulation::Laparoscope& scope, int frame) const {
  const double t_s = frame / kRate_hz;
  if (!motion_blur.Has(frame)) return scope.Render(CurveAt(t_s), frame);
  const auto place_px = [&](double t) {
    const Vector3d p_C = motion.T_RC.Inverse() * motion.TipAt(t).p;
    return Eigen::Vector2d(p_C.head<2>() / p_C.z() * camera.fu_px);
  };
  const double way_px =
      (place_px(t_s + 0.5 * exposure_s) - place_px(t_s - 0.5 * exposure_s)).norm();
  const int instants = std::clamp(static_cast<int>(std::lround(way_px / 1.5)), 2, 9);
  std::vector<simulation::ShaftCurve> during;
  during.reserve(instants);
  for (int i = 0; i < instants; ++i) {
    during.push_back(CurveAt(t_s + ((i + 0.5) / instants - 0.5) * exposure_s));
  }
  return scope.Render(during, frame);
}

VisionSequence DrawSequence(std::uint64_t seed, int number, int frames, int width_px,
                            const std::vector<std::string>& families,
                            const std::vector<std::string>& events) {
  Draw draw(seed, static_cast<std::uint64_t>(number));
  VisionSequence s;
  s.number = number;
  s.camera = BenchCamera(width_px, 2.2);
  s.options.seed = seed + static_cast<std::uint64_t>(number);
  DrawInstrument(families, draw, s);
  DrawMotion(draw, s);
  DrawPicture(draw, s);
  // Each event in turn; every third sequence has a second one.
  s.events = {events[static_cast<std::size_t>(number) % events.size()]};
  if (s.events[0] != "none" && draw.Chance(1.0 / 3)) {
    const std::string& second = draw.OneOf(events);
    if (second != "none" && second != s.events[0]) s.events.push_back(second);
  }
  for (const std::string& event : s.events) {
    const int first = draw.Whole(frames / 5, frames / 2);
    const simulation::FrameRange range{first, std::min(frames - 1, first + draw.Whole(8, 40))};
    AddEvent(event, range, draw, s);
  }
  if (draw.Chance(0.2)) s.camera.gamma.reset();  // the video has it, the tracker is not told
  return s;
}

}  // namespace flextip::bench
