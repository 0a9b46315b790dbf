#include "diagnosis/search/ambiguity.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "diagnosis/evidence/generic_basis.h"
#include "diagnosis/planning/imagined_samples.h"
#include "diagnosis/search/motion_library.h"

namespace flextip::diagnosis {
namespace {

// An alternative that the measured data themselves rule out is not the same signal.
constexpr double kRuledOut = 12.0;  // in log odds

/// Least cost of explaining the noise-free data of `truth` with prior standard deviations `sd`.
double CostOf(const Eigen::MatrixXd& H, const Eigen::VectorXd& truth, const Eigen::VectorXd& sd) {
  const Eigen::VectorXd g = H * truth;
  Eigen::MatrixXd M = sd.asDiagonal() * H * sd.asDiagonal();
  M.diagonal().array() += 1.0;
  const Eigen::VectorXd sg = sd.asDiagonal() * g;
  return truth.dot(g) - sg.dot(Eigen::VectorXd(Llt(M).Solve(sg)));
}

/// Effects that could stand in the place of `effect` with this data.
std::vector<int> AlikeTo(int effect, const LinearProblem& problem, const ParameterLayout& layout,
                         const Selection& selection, const Eigen::VectorXd& theta,
                         const WeighedHypothesis& weighed) {
  const auto& present = weighed.hypothesis.effects;
  std::vector<Hypothesis> swapped;
  std::vector<int> others;
  for (int b = 0; b < layout.EffectCount(); ++b) {
    if (std::find(present.begin(), present.end(), b) != present.end()) continue;
    Hypothesis h = weighed.hypothesis;
    std::replace(h.effects.begin(), h.effects.end(), effect, b);
    std::sort(h.effects.begin(), h.effects.end());
    swapped.push_back(h);
    others.push_back(b);
  }
  // Three and more at once were not all weighed.
  std::vector<Hypothesis> weighed_here = swapped;
  weighed_here.push_back(weighed.hypothesis);
  const Evidence evidence(problem.total, layout, selection.generic_sd, {.unknown_sd = {}});
  const auto scored = Score(evidence, layout.EffectCount(), weighed_here, SelectionOptions{},
                            selection.corrections);
  const auto found = [&](const Hypothesis& h) {
    for (const auto& s : scored)
      if (s.weighed.hypothesis == h) return s.log_posterior;
    return -1e300;
  };
  const double best = found(weighed.hypothesis);
  std::vector<char> alike(others.size(), 0);
  tbb::parallel_for(std::size_t{0}, others.size(), [&](std::size_t i) {
    if (best - found(swapped[i]) > kRuledOut) return;
    const double apart =
        Separation(problem, layout, selection.generic_sd, theta, present, effect, others[i]);
    alike[i] = apart < kInseparable ? 1 : 0;
  });
  std::vector<int> group{effect};
  for (std::size_t i = 0; i < others.size(); ++i)
    if (alike[i]) group.push_back(others[i]);
  return group;
}

/// The motion of the library with the largest worst separation within the groups.
void FindMotion(const Replay& replay, const ParameterLayout& layout,
                const WeighedHypothesis& weighed, Ambiguity& ambiguity) {
  auto motions = MotionLibrary(replay.Set());
  const Eigen::VectorXd& theta = replay.Theta();
  std::vector<double> worst(motions.size(), -1.0);
  for (std::size_t m = 0; m < motions.size(); ++m) {
    if (!MeasureByModel(motions[m].samples, layout, theta)) continue;
    Replay imagined(motions[m].samples, layout);
    if (!imagined.Evaluate(theta)) continue;
    const LinearProblem problem = MakeLinearProblem(imagined, {}, 1);
    double least = 1e300;
    for (const auto& group : ambiguity.groups)
      for (std::size_t i = 1; i < group.size(); ++i)
        least = std::min(least, Separation(problem, layout, Eigen::VectorXd(), theta,
                                           weighed.hypothesis.effects, group[0], group[i]));
    worst[m] = least;
  }
  const auto best = std::max_element(worst.begin(), worst.end());
  if (best == worst.end() || *best < 0.0) return;
  ambiguity.separating_motion = motions[std::size_t(best - worst.begin())].text;
  ambiguity.separating_score = *best;
}

}  // namespace

double Separation(const LinearProblem& problem, const ParameterLayout& layout,
                  const Eigen::VectorXd& generic_sd, const Eigen::VectorXd& theta,
                  const std::vector<int>& blocks, int replaced, int other) {
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(problem.Size());
  for (const int b : blocks) {
    const auto& block = layout.Blocks()[b];
    truth.segment(block.first, block.size) = theta.segment(block.first, block.size);
  }
  std::vector<int> swapped = blocks;
  std::replace(swapped.begin(), swapped.end(), replaced, other);
  const auto prior = [&](const std::vector<int>& present) {
    Eigen::VectorXd sd(problem.Size());
    sd << layout.Widened(present, std::vector<double>(present.size(), 1.0)), generic_sd;
    return sd;
  };
  return CostOf(problem.total.H, truth, prior(swapped)) -
         CostOf(problem.total.H, truth, prior(blocks));
}

Ambiguity FindAmbiguity(const Replay& replay, const ParameterLayout& layout,
                        const Selection& selection, const WeighedHypothesis& weighed,
                        bool find_motion) {
  Ambiguity ambiguity;
  bool any = false;
  for (const int effect : weighed.hypothesis.effects) {
    ambiguity.groups.push_back(
        AlikeTo(effect, selection.problem, layout, selection, replay.Theta(), weighed));
    any = any || ambiguity.groups.back().size() > 1;
  }
  if (any && find_motion) FindMotion(replay, layout, weighed, ambiguity);
  return ambiguity;
}

}  // namespace flextip::diagnosis
