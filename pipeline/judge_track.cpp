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
    judged.next = "look which tags a picture shows, by another family";
    judged.command = fmt::format("flextip detect PICTURE --family {} -o RESULT-tags",
                                 t.family == "tag36h11" ? "tag25h9" : "tag36h11");
  } else {
    judged.says = fmt::format(
        "{} tags of the family {} were found in {} frames, but no pose of the collar fits them.",
        t.tags, t.family, t.frames);
    judged.next = "compare ids, sizes and places of the tags with the collar that was printed";
    judged.command = fmt::format("flextip detect PICTURE --family {} -o RESULT-tags", t.family);
  }
  return judged;
}

/// What the misses have in common tells what to look at first.
void SayWhyNotByWrist(const TrackTotals& t, Judgement& judged) {
  constexpr double kSteady = 0.9;
  judged.Beware(fmt::format(
      "in {} frames the tags' tip is {:.3g} mm from where wrist and shaft can have it{}",
      t.not_by_wrist, 1e3 * t.from_wrist_m,
      t.steady_part > kSteady
          ? ", always the same way: the camera file is of another camera, place or zoom, the "
            "collar file of another collar, or the pictures are shifted or cut"
          : ", now here, now there: the camera's clock is late, or the pictures are turned, "
            "mirrored, scaled, or not in their order"));
  judged.next = "let check look for the fault among camera, collar, port and clocks";
  judged.command = "flextip check RECORDING -o RESULT-check";
}

void SayDoubts(const TrackTotals& t, Judgement& judged) {
  if (t.not_by_collar > 0) {
    judged.Beware(fmt::format(
        "in {} frames the tags are not where the collar file has them, one from another",
        t.not_by_collar));
    judged.next = "compare ids, sizes and places of the tags with the collar that was printed";
    judged.command = fmt::format("flextip detect PICTURE --family {} -o RESULT-tags", t.family);
  }
  if (t.stood_still > 0) {
    judged.Beware(
        fmt::format("{} pictures are those before once more, while the wrist moved: the camera or "
                    "its recorder stood still",
                    t.stood_still));
  }
  if (t.not_by_wrist > 0) SayWhyNotByWrist(t, judged);
}

/// Tags were seen, but none of them told a tip that holds.
Judgement NoTipThatHolds(const TrackTotals& t) {
  Judgement judged;
  judged.says = fmt::format("No tip of {} frames holds: their tags contradict {}.", t.frames,
                            t.not_by_wrist >= t.not_by_collar ? "wrist and shaft" : "the collar");
  SayDoubts(t, judged);
  judged.grade = Grade::kNotFound;
  return judged;
}

void SayNext(const TrackTotals& t, Judgement& judged) {
  judged.next = "take the tips into other programs";
  judged.command = "flextip export csv RESULT -o RESULT-tables";
  if (!t.has_wrist) return;
  judged.next = "estimate load, port and shape with these tips";
  judged.command = "flextip estimate RECORDING --tracked RESULT -o RESULT-estimate";
}

}  // namespace

Judgement JudgeTrack(const TrackTotals& t) {
  if (t.ok == 0) return t.not_by_wrist + t.not_by_collar > 0 ? NoTipThatHolds(t) : NoTip(t);
  Judgement judged;
  judged.says = fmt::format("The tip was seen in {} of {} frames", t.ok, t.frames);
  if (t.predicted > 0) judged.says += fmt::format(", predicted in {}", t.predicted);
  if (t.lost > 0) judged.says += fmt::format(", lost in {}", t.lost);
  judged.says += ".";
  SayNext(t, judged);
  SayDoubts(t, judged);
  if (static_cast<double>(t.ok) < kFewSeen * static_cast<double>(t.frames)) {
    judged.Beware("the tip was seen in less than half of the frames");
  }
  if (t.rms_px > kFarCorners_px) {
    judged.Beware(
        fmt::format("corners are {:.1f} px from where the collar has them: the lens, or the tags' "
                    "sizes and places, are not as the files say",
                    t.rms_px));
    judged.next = "measure the printed collar, and calibrate the camera";
    judged.command =
        "flextip calibrate camera board*.jpg --board chessboard:9x6:0.025 -o RESULT-camera";
  }
  if (!t.camera_has_pose) {
    judged.Beware(
        "the camera file states no pose T_RC: the tips are in the camera's frame, not in the "
        "robot's");
    if (t.has_wrist) {
      judged.next = "find the camera's pose, and track again with its calibration";
      judged.command = "flextip calibrate hand-eye RECORDING -o RESULT-hand-eye";
    } else {
      judged.next =
          "state T_RC in the camera file; the tip's movement is right without it, too, for other "
          "programs";
    }
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
