#include "arms/search/adequacy.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/linear_algebra.h"

namespace flextip::arms {
namespace {

constexpr double kInadequate = 4.0;  // chi-squared per measurement
constexpr double kExplains = 0.4;    // of the base's misfit, what a known answer must take away
constexpr double kSmooth = 0.05;     // of the base's error: a form that a right answer never misses
constexpr double kShows = 1.0;       // smooth squares per measurement, in stated noise
constexpr int kParts = 5;

/// The squares of one component that the basis predicts, each stretch from the others.
double SmoothSquares(const Channel& channel, const ChannelNoise& noise,
                     const Eigen::MatrixXd& basis, const Eigen::VectorXd& step, Eigen::Index c) {
  const Eigen::Index rows = channel.Rows(), C = channel.Components(), functions = basis.cols();
  std::vector<Eigen::MatrixXd> H(kParts, Eigen::MatrixXd::Zero(functions, functions));
  std::vector<Eigen::VectorXd> g(kParts, Eigen::VectorXd::Zero(functions));
  Eigen::MatrixXd all = 1e-6 * Eigen::MatrixXd::Identity(functions, functions);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(functions);
  for (Eigen::Index k = 0; k < rows; ++k) {
    if (!noise.keep(k, c)) continue;
    const auto part = std::size_t(PartOf(k, rows, kParts));
    H[part] += basis.row(k).transpose() * basis.row(k);
    const double left = channel.residual(k, c) - channel.derivative.row(k * C + c).dot(step);
    g[part] += basis.row(k).transpose() * (left / noise.floor[c]);
  }
  for (std::size_t part = 0; part < kParts; ++part) {
    all += H[part];
    right += g[part];
  }
  double squares = 0.0;
  for (std::size_t part = 0; part < kParts; ++part) {
    const Eigen::VectorXd a = Llt(all - H[part]).Solve(right - g[part]);
    // |e|^2 - |e - B a|^2 of the stretch that was left out.
    squares += 2.0 * a.dot(g[part]) - a.dot(H[part] * a);
  }
  return std::max(0.0, squares);
}

/// From the best answer to where all effects of the catalogue together would lead.
Eigen::VectorXd StepToAll(const Replay& replay, const Found& found, const Basis& basis,
                          const SearchOptions& options) {
  const Layout& layout = replay.GetLayout();
  diagnosis::WeighedHypothesis all;
  for (int b = 0; b < layout.EffectCount(); ++b) all.hypothesis.effects.push_back(b);
  all.scales.assign(all.hypothesis.effects.size(), 3.0);
  const Problem problem = MakeProblem(replay, found.noise, basis, found.sizes, options.parts);
  const diagnosis::Evidence evidence(problem.total, layout.Prior(), found.generic_sd,
                                     {.scales = {0.3, 3.0}, .unknown_sd = {}});
  return evidence.Mode(all, evidence.Covariance(all)).head(layout.Size()) - replay.Theta();
}

bool Counts(const Channel& channel, const Replay& replay) {
  return channel.kind != Kind::kTorque ||
         !replay.GetLayout().Recordings().front().arm.links.empty();
}

}  // namespace

double Misfit::PerMeasurement() const { return squares / std::max(1.0, count); }

Misfit MisfitOf(const Replay& replay, const Noise& noise) {
  Misfit misfit;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    if (!Counts(channel, replay)) continue;
    for (Eigen::Index k = 0; k < channel.Rows(); ++k)
      for (Eigen::Index c = 0; c < channel.Components(); ++c) {
        if (!noise[i].keep(k, c)) continue;
        misfit.squares += std::pow(channel.residual(k, c) / noise[i].floor[c], 2);
        misfit.count += 1.0;
      }
  }
  return misfit;
}

double SquaresOfAnotherForm(const Replay& replay, const Found& found, const Basis& basis,
                            const SearchOptions& options) {
  if (replay.GetLayout().Recordings().size() > 1) return 0.0;
  const Eigen::VectorXd step = StepToAll(replay, found, basis, options);
  double squares = 0.0;
  for (std::size_t i = 0; i < found.noise.size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    if (!Counts(channel, replay)) continue;
    for (Eigen::Index c = 0; c < channel.Components(); ++c)
      squares += SmoothSquares(channel, found.noise[i], basis.OfJoints(i), step, c);
  }
  return squares;
}

bool IsUnknown(const Misfit& base, const Misfit& best, double squares_of_another_form) {
  const bool explains_little =
      best.PerMeasurement() >= kInadequate && best.squares >= (1.0 - kExplains) * base.squares;
  const bool has_another_form = squares_of_another_form > kShows * best.count &&
                                squares_of_another_form > kSmooth * kSmooth * base.squares;
  return explains_little || has_another_form;
}

}  // namespace flextip::arms
