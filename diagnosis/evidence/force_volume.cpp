#include "diagnosis/evidence/force_volume.h"

#include <algorithm>
#include <cmath>
#include <numbers>
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

/// One sample of each of `kSamples` equal stretches, each at another place of its stretch: every
/// so many samples would meet a slower sensor always, or never.
std::vector<std::size_t> Few(std::size_t all) {
  std::vector<std::size_t> few;
  const double stretch = std::max(1.0, double(all) / double(kSamples));
  for (std::size_t i = 0; i < std::min(all, kSamples); ++i) {
    const double turns = double(i) * std::numbers::phi;
    few.push_back(std::size_t((double(i) + turns - std::floor(turns)) * stretch));
  }
  return few;
}

/// A few of a replay's samples, with their forces.
class Thinned {
 public:
  explicit Thinned(const Replay& replay)
      : few_(Few(replay.Samples().size())),
        one_is_(double(replay.Samples().size()) / double(few_.size())),
        samples_(Take(replay.Set(), few_)),
        replay_(samples_, replay.Layout()) {
    std::vector<Eigen::Vector3d> forces_N;
    for (const std::size_t k : few_) forces_N.push_back(replay.Samples()[k].f_tip_N);
    replay_.TakeSettings(replay);
    replay_.LeaveOut({});
    replay_.SetForces(forces_N);
  }

  /// Rows of the whole recording that forces take up with parameters `theta`; empty: no
  /// equilibrium.
  std::optional<double> At(const Eigen::VectorXd& theta) {
    if (!replay_.EvaluateWithForces(theta)) return {};
    const std::vector<double> shares = replay_.Whiten().force_share;
    return one_is_ * std::accumulate(shares.begin(), shares.end(), 0.0);
  }

 private:
  static SampleSet Take(const SampleSet& samples, const std::vector<std::size_t>& few) {
    SampleSet thin = samples;
    thin.samples.clear();
    for (const std::size_t k : few) thin.samples.push_back(samples.samples[k]);
    thin.resolved_in_time = false;  // rates do not matter here
    return thin;
  }

  std::vector<std::size_t> few_;
  double one_is_;  ///< samples of the recording
  SampleSet samples_;
  Replay replay_;
};

}  // namespace

double ForceVolume(const Replay& replay, double squares, double rows) {
  if (replay.Set().has_load) return 0.0;
  Thinned thin(replay);
  Eigen::VectorXd rigid = replay.Theta();
  for (const int j : Compliances(replay)) rigid[j] = 0.0;
  const auto here = thin.At(replay.Theta()), reference = thin.At(rigid);
  if (!here || !reference) return 0.0;
  return (*here - *reference) * std::min(1.0, squares / std::max(1.0, rows - *here));
}

}  // namespace flextip::diagnosis
