#include "calibration/camera/board_shape.h"

#include <algorithm>
#include <cmath>

#include "calibration/camera/bundle.h"
#include "core/median.h"

namespace flextip {
namespace {

// What the noise is on the board, over the views: where the scatter starts.
double NoiseOnBoard(const CameraSolution& s) {
  std::vector<double> m_per_px;
  for (const SolvedView& view : s.views) {
    m_per_px.push_back(view.T_CB.p.norm() / s.camera.fu_px);
  }
  return s.noise_px * Median(m_per_px);
}

}  // namespace

std::pair<double, double> SizeOf(const BoardShape& shape) {
  double squares = 0.0, longest = 0.0;
  for (const auto& [id, offset] : shape.offset_B) {
    squares += offset.squaredNorm();
    longest = std::max(longest, offset.norm());
  }
  const auto count = static_cast<double>(std::max<std::size_t>(1, shape.offset_B.size()));
  return {std::sqrt(squares / count), longest};
}

bool EstimateBoardShape(CameraSolution& solution, std::optional<double> sd_m) {
  const BundleOptions options{.estimate_warp = solution.warp_estimated, .estimate_shape = true};
  return SettleBoardShape(solution, sd_m, NoiseOnBoard(solution),
                          [&](CameraSolution& s) { return AdjustBundle(s, options); });
}

}  // namespace flextip
