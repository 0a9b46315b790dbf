#include "diagnosis/samples/load_smoothing.h"

#include <optional>
#include <vector>

#include "diagnosis/samples/smoothing.h"

namespace flextip::diagnosis {
namespace {

using Eigen::Vector3d;

// Samples around one: nearer ones share its noise.
constexpr std::size_t kNear = 9, kFar = 18, kEach = 4, kReach = kFar + kEach - 1;
// Standard deviations: further off is another load, and so much a load at rest seems to move.
constexpr double kNoNoise = 4.0, kRests = 3.0;

/// From near and far neighbours on both sides, so that the load's curvature cancels.
Vector3d AmidNeighbours(const std::vector<DiagnosisSample>& samples, std::size_t k) {
  Vector3d mean[2] = {Vector3d::Zero(), Vector3d::Zero()};
  double squares[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < kEach; ++i) {
    for (const int which : {0, 1}) {
      const std::size_t by = (which == 0 ? kNear : kFar) + i;
      mean[which] += (samples[k - by].f_tip_N + samples[k + by].f_tip_N) / (2.0 * kEach);
      squares[which] += static_cast<double>(by * by);
    }
  }
  const double ratio = squares[1] / squares[0];
  return (ratio * mean[0] - mean[1]) / (ratio - 1.0);
}

/// Near the ends: the mean of the samples there are, where they agree within their noise.
std::optional<Vector3d> AtRest(const std::vector<DiagnosisSample>& samples, std::size_t k) {
  std::vector<Vector3d> around_N;
  for (std::size_t by = kNear; by <= kReach; ++by) {
    if (k >= by) around_N.push_back(samples[k - by].f_tip_N);
    if (k + by < samples.size()) around_N.push_back(samples[k + by].f_tip_N);
  }
  if (around_N.size() < 2 * kEach) return {};
  Vector3d mean_N = Vector3d::Zero();
  for (const Vector3d& f_N : around_N) mean_N += f_N / double(around_N.size());
  for (const Vector3d& f_N : around_N)
    if ((f_N - mean_N).norm() > kRests * samples[k].force_noise_N) return {};
  return mean_N;
}

/// As the neighbours say; as read where that differs by more than noise, since the load itself
/// moves, and where nothing can be said: near the ends, and where samples are apart in time.
Vector3d LoadAround(const SampleSet& set, std::size_t k) {
  const DiagnosisSample& sample = set.samples[k];
  if (!set.resolved_in_time) return sample.f_tip_N;
  const bool amid = k >= kReach && k + kReach < set.samples.size();
  const auto around_N = amid ? AmidNeighbours(set.samples, k) : AtRest(set.samples, k);
  if (!around_N) return sample.f_tip_N;
  const bool moves = (*around_N - sample.f_tip_N).norm() > kNoNoise * sample.force_noise_N;
  return moves ? sample.f_tip_N : *around_N;
}

}  // namespace

void SmoothLoad(SampleSet& set) {
  std::vector<double> t_s;
  std::vector<Vector3d> f_N;
  for (const DiagnosisSample& sample : set.samples) {
    t_s.push_back(sample.t_s);
    f_N.push_back(sample.f_tip_N);
  }
  if (set.resolved_in_time) f_N = Smooth(t_s, f_N, set.noise.force_N).value;
  for (std::size_t k = 0; k < set.samples.size(); ++k) {
    set.samples[k].f_tip_N = f_N[k];
    set.samples[k].force_noise_N = set.noise.force_N;
  }
  for (std::size_t k = 0; k < set.samples.size(); ++k)
    set.samples[k].f_around_N = LoadAround(set, k);
}

}  // namespace flextip::diagnosis
