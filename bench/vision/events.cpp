#include <algorithm>
#include <functional>
#include <map>
#include <numbers>

#include "bench/vision/sequence.h"

namespace flextip::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kOtherIds = 10;  // the other instrument's first id

// The place of the collar's middle (in C) in a frame.
Vector3d CollarMiddle(const VisionSequence& s, double frame) {
  const Pose T_CE = s.motion.T_RC.Inverse() * s.motion.TipAt(frame / VisionSequence::kRate_hz);
  return T_CE * Vector3d(s.collar.tags[0].T_EG.p.x(), 0, 0);
}

int Middle(simulation::FrameRange frames) { return (frames.first + frames.last) / 2; }

// Ids of tags in view in the middle of the event, those that face the camera most first.
std::vector<int> TagsSeen(const VisionSequence& s, simulation::FrameRange frames) {
  const Pose T_CE =
      s.motion.T_RC.Inverse() * s.motion.TipAt(Middle(frames) / VisionSequence::kRate_hz);
  std::vector<std::pair<double, int>> facing;
  for (const CollarTag& tag : s.collar.tags) {
    const Pose T_CG = T_CE * tag.T_EG;
    facing.emplace_back(-T_CG.R.col(2).dot(T_CG.p.normalized()), tag.id);
  }
  std::sort(facing.begin(), facing.end());
  std::vector<int> ids;
  ids.reserve(facing.size());
  for (const auto& [away, id] : facing) ids.push_back(id);
  return ids;
}

// Another shaft before the collar, which it crosses.
void AddPassingInstrument(simulation::FrameRange frames, Draw& draw, VisionSequence& s) {
  const Pose& T_RC = s.camera.T_RC;
  const Vector3d at_C = draw.Between(0.55, 0.9) * CollarMiddle(s, Middle(frames));
  const double angle = draw.Between(0, 2 * std::numbers::pi);
  const Vector3d along(std::cos(angle), std::sin(angle), draw.Between(-0.3, 0.3));
  const Vector3d across(-std::sin(angle), std::cos(angle), 0);
  const int length = frames.last - frames.first + 1;
  const double way_m = draw.Between(0.02, 0.06);
  simulation::Occluder o;
  o.radius_m = draw.Between(0.0015, 0.005);
  o.specular = draw.Between(0, 1);
  o.albedo_bgr.setConstant(draw.Between(0.02, 0.3));
  o.first_frame = frames.first;
  o.last_frame = frames.last;
  const Vector3d start_C = at_C - 0.5 * way_m * across;
  const double reach_m = draw.Chance(0.5) ? 0.15 : 0.01;  // right across, or its end only
  o.a_R = T_RC * (start_C - 0.15 * along);
  o.b_R = T_RC * (start_C + reach_m * along);
  o.velocity_R = T_RC.R * (way_m / length * across);
  s.options.occluders.push_back(o);
}

void AddLeaving(simulation::FrameRange frames, Draw& draw, VisionSequence& s) {
  TipMotion& m = s.motion;
  const double half_height_m = 0.5 * s.camera.height_px / s.camera.fv_px * m.p_CE0.z();
  m.excursion_m = {draw.Between(-0.02, 0.02), draw.Sign() * (half_height_m + 0.045), 0};
  // As fast as anything here: 150 mm/s, of a ramp whose steepest slope is 1.5 times its mean.
  m.ramp_frames = static_cast<int>(1.5 * m.excursion_m.norm() / 0.15 * VisionSequence::kRate_hz);
  m.excursion = {frames.first, frames.first + 2 * m.ramp_frames + draw.Whole(0, 15)};
}

void AddBlood(simulation::FrameRange frames, Draw& draw, VisionSequence& s) {
  const std::vector<int> ids = TagsSeen(s, frames);
  const double size_m = s.collar.tags[0].size_m;
  const int count = draw.Whole(1, std::min(3, static_cast<int>(ids.size())));
  for (int i = 0; i < count; ++i) {
    simulation::Stain stain;
    stain.frames = frames;
    stain.tag_id = ids[static_cast<std::size_t>(i)];
    stain.centre_m = size_m * Vector2d(draw.Between(-0.5, 0.5), draw.Between(-0.5, 0.5));
    stain.radius_m = size_m * draw.Between(0.1, 0.5);
    stain.albedo_bgr = {0.02, 0.02, draw.Between(0.12, 0.4)};
    stain.opacity = draw.Between(0.5, 1.0);
    s.options.hazards.stains.push_back(stain);
  }
}

void AddDirt(simulation::FrameRange frames, Draw& draw, VisionSequence& s) {
  const std::vector<int> ids = TagsSeen(s, frames);
  const double size_m = s.collar.tags[0].size_m;
  for (int i = draw.Whole(4, 10); i > 0; --i) {
    simulation::Stain speck;
    speck.frames = frames;
    speck.tag_id =
        ids[static_cast<std::size_t>(draw.Whole(0, std::min(2, static_cast<int>(ids.size()) - 1)))];
    speck.centre_m = size_m * Vector2d(draw.Between(-0.6, 0.6), draw.Between(-0.6, 0.6));
    speck.radius_m = size_m * draw.Between(0.02, 0.08);
    speck.albedo_bgr = Vector3d(0.05, 0.08, 0.12) * draw.Between(0.3, 4);
    if (s.options.hazards.stains.size() < 14) s.options.hazards.stains.push_back(speck);
  }
}

// A second instrument beside the collar, with tags of the same family and size.
void AddOtherTags(simulation::FrameRange frames, Draw& draw, VisionSequence& s) {
  if (!s.options.hazards.others.empty()) return;
  const Vector3d at_C = CollarMiddle(s, Middle(frames));
  const double angle = draw.Between(0, 2 * std::numbers::pi);
  const double size_m = s.collar.tags[0].size_m;
  simulation::OtherInstrument other;
  other.frames = frames;
  other.collar = RingCollar(s.collar.family, size_m, 6, 1.05, 0.02, kOtherIds);
  Pose T_CE;
  T_CE.R = Eigen::AngleAxisd(angle, Vector3d::UnitZ()) *
           Eigen::AngleAxisd(draw.Between(-0.5, 0.5), Vector3d::UnitY()) *
           Eigen::AngleAxisd(draw.Between(-3, 3), Vector3d::UnitX());
  T_CE.p = at_C + Vector3d(draw.Between(-0.03, 0.03), draw.Between(-0.02, 0.02),
                           draw.Between(-0.015, 0.015));
  other.curve = ArcShaft(s.camera.T_RC * T_CE, 1.0, 0.005);
  other.velocity_R = s.camera.T_RC.R * Vector3d(draw.Between(-1, 1), draw.Between(-1, 1), 0) * 1e-3;
  s.options.hazards.others.push_back(other);
}

using Adder = std::function<void(simulation::FrameRange, Draw&, VisionSequence&)>;

const std::map<std::string, Adder>& Adders() {
  static const std::map<std::string, Adder> adders = {
      {"none", [](simulation::FrameRange, Draw&, VisionSequence&) {}},
      {"instrument", AddPassingInstrument},
      {"leaves", AddLeaving},
      {"blood", AddBlood},
      {"dirt", AddDirt},
      {"other_tags", AddOtherTags},
      {"smoke",
       [](simulation::FrameRange f, Draw& draw, VisionSequence& s) {
         const double light = draw.Between(0.1, 0.5);
         s.options.hazards.smoke.push_back({f, draw.Between(0.15, 0.7), Vector3d::Constant(light),
                                            draw.Between(0.2, 0.9), draw.Between(30, 150),
                                            draw.Between(0, 8)});
       }},
      {"defocus",
       [](simulation::FrameRange f, Draw& draw, VisionSequence& s) {
         s.options.hazards.defocus.push_back({f, draw.Between(1.0, 5.0)});
       }},
      {"motion_blur",
       [](simulation::FrameRange f, Draw& draw, VisionSequence& s) {
         s.motion_blur = f;
         s.exposure_s = draw.Between(0.008, 0.03);
       }},
      {"exposure",
       [](simulation::FrameRange f, Draw& draw, VisionSequence& s) {
         const double factor = draw.Chance(0.5) ? draw.Between(1.5, 4) : draw.Between(0.1, 0.6);
         s.options.hazards.exposure_steps.push_back({f, factor, draw.Between(3, 20)});
       }},
      {"highlight",
       [](simulation::FrameRange f, Draw& draw, VisionSequence& s) {
         const double bulge = draw.Between(0.2, 0.8) / s.collar.tags[0].size_m;
         s.options.hazards.gloss.push_back({f, draw.Between(0.7, 3), bulge});
       }},
      {"mirrored",
       [](simulation::FrameRange f, Draw& draw, VisionSequence& s) {
         const std::vector<int> ids = TagsSeen(s, f);
         s.options.hazards.mirrored_tags.push_back(ids[0]);
         if (draw.Chance(0.3)) s.options.hazards.mirrored_tags.push_back(ids[1]);
       }},
  };
  return adders;
}

}  // namespace

const std::vector<std::string>& VisionEvents() {
  static const std::vector<std::string> names = {
      "none",     "instrument", "leaves",    "smoke", "defocus",    "motion_blur",
      "exposure", "blood",      "highlight", "dirt",  "other_tags", "mirrored"};
  return names;
}

void AddEvent(const std::string& event, simulation::FrameRange frames, Draw& draw,
              VisionSequence& sequence) {
  Adders().at(event)(frames, draw, sequence);
  if (event == "none") return;
  if (event == "leaves") frames = sequence.motion.excursion;
  if (event == "mirrored") frames = simulation::FrameRange{};
  sequence.in_event.push_back(frames);
}

}  // namespace flextip::bench
