#include "diagnosis/evidence/force_volume.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <vector>

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kSamples = 100;

/// The parameters that scale what the force does.
std::vector<int> Compliances(const Replay& replay) {
  using namespace sample_input;
  std::vector<int> found;
  for (const auto& column : replay.Samples()[replay.Samples().size() / 2].columns)
    if (column.input == kTipCompliance || column.input == kPortCompliance ||
        column.input == kWristCompliance)
      found.push_back(column.parameter);
  return found;
}

/// A few of a replay's samples, with their forces.
class Thinned {
 public:
  explicit Thinned(const Replay& replay)
      : stride_(std::max<std::size_t>(1, replay.Samples().size() / kSamples)),
        samples_(Take(replay.Set(), stride_)),
        replay_(samples_, replay.Layout()) {
    std::vector<Eigen::Vector3d> forces_N;
    for (std::size_t k = 0; k < replay.Samples().size(); k += stride_)
      forces_N.push_back(replay.Samples()[k].f_tip_N);
    replay_.TakeSettings(replay);
    replay_.LeaveOut({});
    replay_.SetForces(forces_N);
  }

  /// Rows of the whole recording that forces take up with parameters `theta`; empty: no
  /// equilibrium.
  std::optional<double> At(const Eigen::VectorXd& theta) {
    if (!replay_.EvaluateWithForces(theta)) return {};
    const std::vector<double> shares = replay_.Whiten().force_share;
    return double(stride_) * std::accumulate(shares.begin(), shares.end(), 0.0);
  }

 private:
  static SampleSet Take(const SampleSet& samples, std::size_t stride) {
    SampleSet thin = samples;
    thin.samples.clear();
    for (std::size_t k = 0; k < samples.samples.size(); k += stride)
      thin.samples.push_back(samples.samples[k]);
    thin.resolved_in_time = false;  // rates do not matter here
    return thin;
  }

  std::size_t stride_;
  SampleSet samples_;
  Replay replay_;
};

}  // namespace

double ForceVolume(const Replay& replay) {
  if (replay.Set().has_load) return 0.0;
  Thinned thin(replay);
  Eigen::VectorXd rigid = replay.Theta();
  for (const int j : Compliances(replay)) rigid[j] = 0.0;
  const auto here = thin.At(replay.Theta()), reference = thin.At(rigid);
  return here && reference ? *here - *reference : 0.0;
}

}  // namespace flextip::diagnosis
