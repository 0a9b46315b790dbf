#include "calibration/camera/camera_board_shape.h"

#include <algorithm>
#include <cmath>

#include "calibration/camera/camera_bundle.h"
#include "core/median.h"

namespace flextip {
namespace {

constexpr int kRounds = 40;
constexpr double kSettled = 0.02;  // of noise and scatter, from one round to the next

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
  CameraSolution s = solution;
  s.shape.sd_m = sd_m.value_or(NoiseOnBoard(s));
  const BundleOptions options{.estimate_warp = s.warp_estimated, .estimate_shape = true};
  for (int round = 0; round < kRounds; ++round) {
    const double noise_px = s.noise_px, before_m = s.shape.sd_m;
    if (!AdjustBundle(s, options)) return false;
    if (!sd_m) s.shape.sd_m = s.shape.scatter_m;
    const auto near = [](double a, double b) { return std::abs(a - b) <= kSettled * b; };
    if (near(s.noise_px, noise_px) && near(s.shape.sd_m, before_m)) break;
  }
  solution = std::move(s);
  return true;
}

}  // namespace flextip
