#include "diagnosis/describe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "diagnosis/search/ambiguity.h"

namespace flextip::diagnosis {
namespace {

/// "the orientation of wrist0" for the channel wrist0_orientation_rad.
std::string SpokenName(const std::string& channel) {
  const auto first = channel.find('_'), last = channel.rfind('_');
  if (first == std::string::npos || first == last) return channel;
  return fmt::format("the {} of {}", channel.substr(first + 1, last - first - 1),
                     channel.substr(0, first));
}

Eigen::VectorXd ReportedValues(const ParameterLayout::Block& block, const Eigen::VectorXd& theta,
                               const Eigen::MatrixXd& covariance) {
  std::vector<double> values;
  for (const auto& p : block.effect->Report(theta, covariance))
    values.insert(values.end(), p.value.begin(), p.value.end());
  return Eigen::Map<Eigen::VectorXd>(values.data(), Eigen::Index(values.size()));
}

/// Of the reported numbers of `blocks`, from that of the fitted ones by differences.
Eigen::MatrixXd ReportedCovariance(const ParameterLayout& layout, const std::vector<int>& blocks,
                                   const Eigen::VectorXd& theta,
                                   const Eigen::MatrixXd& covariance) {
  Eigen::MatrixXd J(0, theta.size());
  for (const int b : blocks) {
    const auto& block = layout.Blocks()[b];
    const Eigen::VectorXd own = theta.segment(block.first, block.size);
    const Eigen::MatrixXd C = covariance.block(block.first, block.first, block.size, block.size);
    const auto rows = ReportedValues(block, own, C).size();
    J.conservativeResize(J.rows() + rows, Eigen::NoChange);
    J.bottomRows(rows).setZero();
    for (int j = 0; j < block.size; ++j) {
      const Eigen::VectorXd h = 1e-3 * std::sqrt(C(j, j)) * Eigen::VectorXd::Unit(block.size, j);
      J.col(block.first + j).tail(rows) =
          (ReportedValues(block, own + h, C) - ReportedValues(block, own - h, C)) / (2 * h[j]);
    }
  }
  return J * covariance.topLeftCorner(theta.size(), theta.size()) * J.transpose();
}

/// Of the first `effects` that are not `present`, those that act on sensors' readings or places
/// alone.
std::vector<int> SensorBlocks(const Replay& extended, int effects,
                              const std::vector<int>& present) {
  std::set<int> sensors, others;
  for (const ReplayedSample& sample : extended.Samples()) {
    for (const InputChange::Column& column : sample.columns) {
      const bool reading = column.input > sample_input::kTipCompliance &&
                           column.input != sample_input::kEmDelay &&
                           column.input != sample_input::kCameraDelay;
      const bool length = column.input == sample_input::kLength;  // where the sensors stand
      (reading || length ? sensors : others).insert(column.parameter);
    }
  }
  std::vector<int> blocks;
  for (int b = 0; b < effects; ++b) {
    const auto& block = extended.Layout().Blocks()[b];
    bool alone = std::find(present.begin(), present.end(), b) == present.end();
    for (int j = block.first; j < block.first + block.size; ++j)
      alone = alone && sensors.contains(j) && !others.contains(j);
    if (alone) blocks.push_back(b);
  }
  return blocks;
}

}  // namespace

std::string MemoryWarning(const ResidualMemory& memory) {
  return fmt::format(
      "what is left of {} remembers itself ({:.2f} from sample to sample): slow noise or an error "
      "of the model is in it, and the probability holds among the known causes alone; {}",
      SpokenName(memory.channel), memory.correlation,
      memory.SamplesAsOne() > 1.0
          ? fmt::format("{:.1f} samples count as one", memory.SamplesAsOne())
          : std::string("the noise taken covers the memory"));
}

void DescribeParameters(const Replay& extended, const Selection& selection,
                        const WeighedHypothesis& weighed, DiagnosisResult& result,
                        std::optional<int> effects) {
  const ParameterLayout& layout = extended.Layout();
  const int known = effects.value_or(layout.EffectCount());
  const Evidence evidence(selection.problem.total, layout, selection.generic_sd,
                          {.unknown_sd = {}});
  const Eigen::MatrixXd covariance = evidence.Covariance(weighed);
  Eigen::VectorXd theta = extended.Theta();
  for (int j = 0; j < layout.Size(); ++j)  // within tolerance the fit does not mind the sign
    if (layout.Parameter(j).positive) theta[j] = std::max(0.0, theta[j]);
  std::vector<int> named = weighed.hypothesis.effects;
  std::erase_if(named, [&](int b) { return b >= known; });
  result.covariance = ReportedCovariance(layout, named, theta, covariance);
  const std::vector<int> sensors = SensorBlocks(extended, known, named);
  result.sensor_tolerance.covariance = ReportedCovariance(layout, sensors, theta, covariance);
  for (const int b : sensors)
    result.sensor_tolerance.effects.push_back(layout.Blocks()[b].effect->Name());
  for (int b = 0; b < known; ++b) {
    const auto& block = layout.Blocks()[b];
    EffectFit fit{
        block.effect->Name(),
        block.effect->Report(theta.segment(block.first, block.size),
                             covariance.block(block.first, block.first, block.size, block.size))};
    const bool is_present = std::find(named.begin(), named.end(), b) != named.end();
    (is_present ? result.parameters : result.within_tolerance).push_back(std::move(fit));
  }
}

void DescribeAmbiguity(const Replay& extended, const Selection& selection,
                       const WeighedHypothesis& weighed, bool find_motion,
                       DiagnosisResult& result) {
  const ParameterLayout& layout = extended.Layout();
  const Ambiguity ambiguity = FindAmbiguity(extended, layout, selection, weighed, find_motion);
  for (const auto& group : ambiguity.groups) {
    std::vector<std::string> names;
    names.reserve(group.size());
    for (const int b : group) names.push_back(layout.Blocks()[b].effect->Name());
    result.indistinguishable.push_back(names);
  }
  result.separating_motion = ambiguity.separating_motion;
  result.separating_motion_score = ambiguity.separating_score;
}

void DescribeRecording(const Replay& extended, const Selection& selection, TimeNs start_ns,
                       DiagnosisResult& result) {
  const ParameterLayout& layout = extended.Layout();
  const SampleSet& samples = extended.Set();
  result.samples = int(samples.samples.size());
  result.failed_samples = extended.FailedSamples();
  result.fits = selection.fits;
  result.converged = selection.converged;
  result.has_load = samples.has_load;
  result.warnings.insert(result.warnings.begin(), samples.warnings.begin(), samples.warnings.end());
  result.noise_scale = extended.NoiseScales();
  result.centre_m = samples.centre;
  result.start_ns = start_ns;
  for (int b = 0; b < layout.EffectCount(); ++b) {
    const auto& block = layout.Blocks()[b];
    result.catalogue.push_back(block.effect->Name());
    result.summaries[block.effect->Name()] = block.effect->Summary();
    const Eigen::VectorXd tolerance = layout.Tolerances().segment(block.first, block.size);
    result.nominal.push_back(
        {block.effect->Name(), block.effect->Report(Eigen::VectorXd::Zero(block.size),
                                                    tolerance.cwiseAbs2().asDiagonal())});
  }
  const Rows sd = extended.RowNoise(samples.samples.size() / 2);
  for (int c = 0; c < kChannelCount; ++c)
    result.noise_sd[c] = std::sqrt(
        sd.segment(kChannels[c].first_row, kChannels[c].rows).squaredNorm() / kChannels[c].rows);
}

}  // namespace flextip::diagnosis
