#include "bench/matrix_separable.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "bench/matrix_truth.h"
#include "diagnosis/effects/port_motion.h"
#include "diagnosis/generic_basis.h"
#include "diagnosis/hypothesis_fit.h"
#include "diagnosis/noise_level.h"

namespace flextip {
namespace {

constexpr double kWidth =
    3.0;  // of a present effect's prior, in typical sizes: the widest there is

/// The label's parameters of all effects; what it does not name is zero.
Eigen::VectorXd TrueTheta(const HiddenRecording& hidden, ParameterLayout& layout) {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  for (int b = 0; b < layout.EffectCount(); ++b) {
    const auto& block = layout.Blocks()[b];
    const std::string name = block.effect->Name();
    const EffectParameters truth = TruthOf(hidden, name);
    if (name == "port_motion") {
      static_cast<PortMotion&>(layout.MutableEffect(b))
          .SetFrequency(truth.at("frequency_hz").at(0));
    }
    std::vector<std::vector<double>> values;
    for (const ReportedParameter& parameter :
         block.effect->Report(Eigen::VectorXd::Zero(block.size),
                              Eigen::MatrixXd::Identity(block.size, block.size))) {
      const auto found = truth.find(parameter.name);
      values.push_back(found == truth.end() ? std::vector<double>(parameter.value.size(), 0.0)
                                            : found->second);
    }
    theta.segment(block.first, block.size) = block.effect->FromReported(values);
  }
  return theta;
}

/// Explanations of the data that one effect makes without noise.
class Explanations {
 public:
  Explanations(const LinearProblem& problem, const ParameterLayout& layout,
               const Eigen::VectorXd& theta, const Rows& may_miss, int effect)
      : H_(problem.total.H), layout_(layout), generic_sd_(GenericSd(problem, may_miss)) {
    const auto& block = layout.Blocks()[effect];
    Eigen::VectorXd truth = Eigen::VectorXd::Zero(problem.Size());
    truth.segment(block.first, block.size) = theta.segment(block.first, block.size);
    g_ = H_ * truth;
    c_ = truth.dot(g_);
  }

  /// Least |z - X x|^2 + |x / sd|^2 with nothing present.
  double CostOfNone() const { return CostOf({}, nullptr); }

  /// And with one effect. Where it would have to be negative and cannot, it is no help.
  double CostOf(int effect) const {
    Eigen::VectorXd mean;
    const double cost = CostOf({effect}, &mean);
    const auto& block = layout_.Blocks()[effect];
    for (int j = block.first; j < block.first + block.size; ++j)
      if (layout_.Parameter(j).positive && mean[j] < 0.0) return CostOfNone();
    return cost;
  }

 private:
  double CostOf(const std::vector<int>& present, Eigen::VectorXd* mean) const {
    Eigen::VectorXd sd(g_.size());
    sd << layout_.Widened(present, std::vector<double>(present.size(), kWidth)), generic_sd_;
    Eigen::MatrixXd M = sd.asDiagonal() * H_ * sd.asDiagonal();
    M.diagonal().array() += 1.0;
    const Eigen::VectorXd sg = sd.asDiagonal() * g_, x = M.llt().solve(sg);
    if (mean != nullptr) *mean = sd.asDiagonal() * x;
    return c_ - sg.dot(x);
  }

  const Eigen::MatrixXd& H_;
  const ParameterLayout& layout_;
  Eigen::VectorXd generic_sd_, g_;
  double c_ = 0.0;
};

}  // namespace

Separation MeasureSeparation(const Recording& recording, const HiddenRecording& hidden) {
  const SampleSet samples = MakeSampleSet(recording, "recording");
  ParameterLayout layout(samples, MakeCatalogue(samples));
  const int effect = layout.Find(hidden.label.present.at(0));
  if (effect < 0) return {};  // no sensor or motion that could show it
  const Eigen::VectorXd theta = TrueTheta(hidden, layout);
  Replay replay(samples, layout);
  // Samples without equilibrium are left out.
  replay.Evaluate(Eigen::VectorXd::Zero(layout.Size()));
  const SelectionOptions options;
  const Rows may_miss =
      MayMiss(ProblemHere(replay, GenericBasis(replay), options), options.discrepancy, options);
  replay.Evaluate(theta);
  replay.AdaptForcePrior();
  replay.SetNoiseScale(NoiseScale(replay));
  replay.Evaluate(theta);
  const LinearProblem problem = MakeLinearProblem(replay, GenericBasis(replay), 1);
  const Explanations explanations(problem, layout, theta, may_miss, effect);
  const double of_truth = explanations.CostOf(effect);
  Separation nearest{explanations.CostOfNone() - of_truth, "none"};
  if (nearest.value < kSeparable) return nearest;
  for (int b = 0; b < layout.EffectCount(); ++b) {
    if (b == effect) continue;
    const double value = explanations.CostOf(b) - of_truth;
    if (value < nearest.value) nearest = {value, layout.Blocks()[b].effect->Name()};
  }
  return nearest;
}

}  // namespace flextip
