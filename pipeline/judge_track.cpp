#include "pipeline/judge_track.h"

#include <fmt/format.h>

namespace flextip {
namespace {

constexpr double kFewSeen = 0.5;      // of all frames
constexpr double kFarCorners_px = 1;  // a sharp picture of the right collar leaves a tenth of it

Judgement NoTip(const TrackTotals& t) {
  Judgement judged;
  judged.grade = Grade::kNotFound;
  if (t.tags == 0) {
    judged.says =
        fmt::format("No tag of the family {} was found in {} frames.", t.family, t.frames);
    judged.next = "look which tags a picture shows";
    judged.command = "flextip detect PICTURE --family FAMILY";
  } else {
    judged.says = fmt::format(
        "{} tags of the family {} were found in {} frames, but no pose of the collar fits them.",
        t.tags, t.family, t.frames);
    judged.next = "compare ids, sizes and places of the tags with the collar that was printed";
  }
  return judged;
}

}  // namespace

Judgement JudgeTrack(const TrackTotals& t) {
  if (t.ok == 0) return NoTip(t);
  Judgement judged;
  judged.says = fmt::format("The tip was seen in {} of {} frames", t.ok, t.frames);
  if (t.predicted > 0) judged.says += fmt::format(", predicted in {}", t.predicted);
  if (t.lost > 0) judged.says += fmt::format(", lost in {}", t.lost);
  judged.says += ".";
  if (static_cast<double>(t.ok) < kFewSeen * static_cast<double>(t.frames)) {
    judged.Beware("the tip was seen in less than half of the frames");
  }
  if (t.rms_px > kFarCorners_px) {
    judged.Beware(
        fmt::format("corners are {:.1f} px from where the collar has them: the lens, or the tags' "
                    "sizes and places, are not as the files say",
                    t.rms_px));
    judged.next = "measure the printed collar, and calibrate the camera";
    judged.command = "flextip calibrate camera IMAGE... --board SPEC -o CAMERA";
  }
  if (!t.camera_has_pose) {
    judged.Beware(
        "the camera file states no pose T_RC: the tips are in the camera's frame, not in the "
        "robot's");
    judged.next = "find the camera's pose, and pass it with --calibration";
    judged.command = "flextip calibrate hand-eye RECORDING -o HAND_EYE";
  }
  if (t.score.frames > 0) {
    judged.Mention(fmt::format("against the truth the tip was {:.3g} mm off (RMS), {:.3g} mm at "
                               "most; {:.0f} % of the errors lie inside their 95 % ellipsoid",
                               1e3 * t.score.RmsError(), 1e3 * t.score.max_error_m,
                               100 * t.score.ShareInside()),
                   false);
  }
  return judged;
}

}  // namespace flextip
