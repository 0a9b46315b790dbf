#include "apps/calibrate/camera/pictures.h"

#include <fmt/format.h>

#include "apps/common/drawing.h"
#include "recording/frames/frames.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr double kHalfCross_px = 4.0;
constexpr Colour kGood{60, 170, 40}, kBad{40, 40, 220}, kArrow{178, 114, 0}, kFound{80, 220, 60};

void DrawResiduals(Image& image, const SolvedView& view) {
  Drawing drawing(image);
  for (std::size_t i = 0; i < view.px.size(); ++i) {
    const Eigen::Vector2d end = view.px[i] + DrawnResidual(view.residual_px[i], image.width_px);
    drawing.Ring(view.px[i], 3, view.IsUsed(i) ? kGood : kBad);
    drawing.Line(view.px[i], end, view.IsUsed(i) ? kArrow : kBad);
  }
}

}  // namespace

Eigen::Vector2d DrawnResidual(const Eigen::Vector2d& residual_px, int width_px) {
  const double widest = 0.2 * width_px;
  const Eigen::Vector2d drawn = kResidualsLonger * residual_px;
  return drawn.norm() > widest ? Eigen::Vector2d(drawn * (widest / drawn.norm())) : drawn;
}

void DrawCameraPictures(const fs::path& folder, const CornersFile& corners,
                        const CameraCalibrationResult& result) {
  std::vector<const SolvedView*> solved(corners.views.size(), nullptr);
  for (const SolvedView& view : result.solution.views) solved[view.index] = &view;
  for (std::size_t i = 0; i < corners.views.size(); ++i) {
    const fs::path file = corners.views[i].name;
    if (!fs::exists(file)) continue;  // only its corners were kept
    Image image = ToColour(ReadImageFile(file));
    if (image.width_px != corners.width_px || image.height_px != corners.height_px) continue;
    Drawing drawing(image);
    if (solved[i]) {
      DrawResiduals(image, *solved[i]);
      drawing.Label(fmt::format("{:.3f} px", solved[i]->RmsPx()));
    } else {
      for (const auto& px : corners.views[i].sighting.px) drawing.Cross(px, kHalfCross_px, kFound);
      drawing.Label(result.views[i].reason);
    }
    WritePng(folder / "overlay" / fmt::format("{:04}_{}.png", i, file.stem().string()), image);
  }
}

}  // namespace flextip
