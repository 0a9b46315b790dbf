#include "targets/collar/verdict.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace flextip {
namespace {

constexpr double kSmallTag_px = 24.0;  // below, the tracker loses accuracy (docs/results/vision.md)
constexpr double kOk_m = 0.0005;       // what the tracker still calls ok, an axis

std::string ErrorText(const AccuracyAtDistance& at) {
  return fmt::format("{:.3f} mm and {:.3f}°", 1e3 * at.expected.tip_m,
                     180.0 / std::numbers::pi * at.expected.direction_rad);
}

}  // namespace

CalibrationVerdict JudgeCollar(const CollarDesign& d, const ViewingConditions& conditions,
                               const std::vector<AccuracyAtDistance>& accuracy) {
  CalibrationVerdict verdict;
  const AccuracyAtDistance &near = accuracy.front(), &far = accuracy.back();
  verdict.says = fmt::format(
      "{} tags of {:.4g} mm ({}) fit a shaft of {:g} mm and pass a port of {:.2f} mm. The tip is "
      "then seen to {} at {:.0f} mm.",
      d.wishes.faces, 1e3 * d.tag_size_m, d.collar.family, 1e3 * d.wishes.shaft_diameter_m,
      std::ceil(1e5 * d.outer_m) / 100.0, ErrorText(far), 1e3 * far.distance_m);
  if (far.tag_px < kSmallTag_px) {
    verdict.Beware(
        fmt::format("at {:.0f} mm a tag is {:.0f} px wide: it is read, but not every time; below "
                    "{:.0f} px tags "
                    "get lost",
                    1e3 * far.distance_m, far.tag_px, kSmallTag_px));
  }
  if (far.expected.tip_m > kOk_m) {
    verdict.Beware(fmt::format("at {:.0f} mm the tip is off by more than {:g} mm",
                               1e3 * far.distance_m, 1e3 * kOk_m));
  }
  verdict.Mention(
      "the errors are those of one picture with the tags where the file says; a tag glued 0.1 mm "
      "aside moves the tip by as much, until flextip calibrate tip finds it",
      false);
  verdict.Add(fmt::format("tip at {:.0f} mm", 1e3 * near.distance_m), ErrorText(near));
  verdict.Add(fmt::format("tip at {:.0f} mm", 1e3 * far.distance_m), ErrorText(far));
  verdict.Add("read up to",
              fmt::format("{:.0f} mm", 1e3 * ReadableTo(d.cell_m, conditions.camera)));
  verdict.Add("mount across its faces", fmt::format("{:.2f} mm", 1e3 * d.across_m));
  verdict.Add("bore", fmt::format("{:.2f} mm", 1e3 * d.bore_m));
  verdict.Add("length", fmt::format("{:.2f} mm", 1e3 * d.length_m));
  verdict.next =
      "print print.pdf at 100 %, print mount.stl, glue them; then take pictures and follow the tip";
  verdict.command =
      "flextip track pictures --camera cam.yaml --collar RESULT/tags0/sensor.yaml -o tracked";
  return verdict;
}

}  // namespace flextip
