#include "calibration/boards/corners_file.h"
#include "tests/fuzz/files/input_folder.h"
#include "tests/fuzz/files/inputs.h"

namespace flextip {

int CheckCornersInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("corners.csv", TextOf(input));
  CornersFile corners;
  if (!ReadsOrRefuses([&] { corners = ReadCorners(file); })) return 0;
  for (const BoardView& view : corners.views) {
    Require(view.sighting.ids.size() == view.sighting.px.size());
    for (const auto& px : view.sighting.px) Require(px.cwiseAbs().maxCoeff() <= 1e6);
  }
  WriteCorners(folder / "again.csv", corners);
  Require(ReadCorners(folder / "again.csv").views.size() == corners.views.size());
  return 1;
}

}  // namespace flextip
