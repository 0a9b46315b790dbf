#include "targets/board/verdict.h"

#include <fmt/format.h>

#include <algorithm>

#include "targets/collar/accuracy.h"

namespace flextip {

BoardReach ReachOf(const BoardFace& face, const CameraCalibration& camera) {
  const Eigen::Vector2d size = face.extent.sizes();
  return {.fills_at_m = std::max(camera.fu_px * size.x() / camera.width_px,
                                 camera.fv_px * size.y() / camera.height_px),
          .readable_to_m = ReadableTo(face.cell_m, camera)};
}

CalibrationVerdict JudgeBoard(const std::string& spec, const BoardFace& face,
                              const BoardOnPaper& place, const BoardReach& reach) {
  CalibrationVerdict verdict;
  const Eigen::Vector2d size_mm = 1e3 * face.extent.sizes();
  verdict.says = fmt::format(
      "A board of {:.1f} x {:.1f} mm on {}. It fills the camera's view at {:.0f} mm and is read up "
      "to {:.0f} mm.",
      size_mm.x(), size_mm.y(), place.paper.name, 1e3 * reach.fills_at_m,
      1e3 * reach.readable_to_m);
  if (reach.readable_to_m < 1.5 * reach.fills_at_m) {
    verdict.Beware(
        "its parts are too small for this camera: it is read only where it more than fills the "
        "view; take fewer, larger squares");
  }
  verdict.Add("width", fmt::format("{:.1f} mm", size_mm.x()));
  verdict.Add("height", fmt::format("{:.1f} mm", size_mm.y()));
  verdict.Add("smallest part", fmt::format("{:.2f} mm", 1e3 * face.cell_m));
  verdict.next =
      "print print.pdf at 100 %, check the rulers, glue it flat; then take 20 pictures of it from "
      "all sides";
  verdict.command =
      fmt::format("flextip calibrate camera pictures/*.png --board {} -o camera", spec);
  return verdict;
}

}  // namespace flextip
