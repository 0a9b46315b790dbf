#include "diagnosis/running/onset_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace flextip::diagnosis::running {
namespace {

constexpr std::array kSizes{0.3, 1.0, 3.0};  // in typical ones
constexpr double kLeast = 1e-300;

using Small = Eigen::Matrix<double, kMostWidened, kMostWidened>;
using SmallVector = Eigen::Matrix<double, kMostWidened, 1>;

/// The sums of what set in, all else eliminated; unused rows are empty.
struct Reduced {
  Small S = Small::Zero();
  SmallVector g = SmallVector::Zero();
};

/// For a prior of these standard deviations. The mean and covariance are in units of the tolerance.
struct Weighed {
  double log_ratio = 0.0;
  SmallVector mean = SmallVector::Zero();
  Small covariance = Small::Zero();
};

Weighed Weigh(const Reduced& reduced, const SmallVector& sd, bool positive) {
  const auto D = sd.asDiagonal();
  const Small M = Small::Identity() + D * reduced.S * D;
  const Llt<kMostWidened> factor(M);
  Weighed weighed;
  if (!factor.Succeeded()) {
    weighed.log_ratio = std::log(kLeast);
    return weighed;
  }
  const SmallVector b = D * reduced.g;
  const SmallVector x = factor.Solve(b);
  weighed.log_ratio = 0.5 * b.dot(x) - 0.5 * factor.LogDeterminant();
  weighed.mean = D * x;
  weighed.covariance = D * factor.Inverse() * D;
  if (positive) {  // half a normal as prior
    const double deviations = weighed.mean[0] / std::sqrt(weighed.covariance(0, 0));
    weighed.log_ratio += std::log(std::max(kLeast, std::erfc(-deviations / std::numbers::sqrt2)));
  }
  return weighed;
}

}  // namespace

double AddLogarithms(double a, double b) {
  const double larger = std::max(a, b);
  return std::isinf(larger) ? larger : larger + std::log1p(std::exp(std::min(a, b) - larger));
}

void AllSamples::Take(const Information& all) {
  factor_ = Llt<kParameters>(all.H + Information::Matrix::Identity());
  whitened_g_ = factor_.SolveL(all.g);
}

void AllSamples::Since(const Information& part) {
  part_ = part;
  whitened_part_ = factor_.SolveL(part.H);
}

OnsetEvidence AllSamples::Of(const WatchedBlock& block, const WatchedParameters& parameters) const {
  const int n = block.widened, c = block.first;
  Reduced reduced;
  for (int i = 0; i < n; ++i) {
    const auto of_i = whitened_part_.col(c + i);
    reduced.g[i] = part_.g[c + i] - of_i.dot(whitened_g_);
    for (int j = 0; j < n; ++j)
      reduced.S(i, j) = part_.H(c + i, c + j) - of_i.dot(whitened_part_.col(c + j));
  }
  OnsetEvidence evidence;
  evidence.log_ratio = -std::numeric_limits<double>::infinity();
  Weighed best;
  best.log_ratio = evidence.log_ratio;
  for (const double size : kSizes) {
    SmallVector sd = SmallVector::Ones();
    for (int i = 0; i < n; ++i) sd[i] = size * block.typical[static_cast<std::size_t>(i)];
    const Weighed weighed = Weigh(reduced, sd, block.positive);
    evidence.log_ratio =
        AddLogarithms(evidence.log_ratio, weighed.log_ratio - std::log(double(kSizes.size())));
    if (weighed.log_ratio > best.log_ratio) best = weighed;
  }
  const double size = best.mean.norm();
  if (size > 0.0) {
    const SmallVector along = best.mean / size;
    evidence.beyond = size - 2.0 * std::sqrt(std::max(0.0, along.dot(best.covariance * along)));
  }
  // What is told: the value itself, or the length of several.
  const int first = block.row->first, count = block.row->count;
  SmallVector told = SmallVector::Zero(), by = SmallVector::Zero();
  for (int i = first; i < first + count; ++i) {
    by[i] = parameters.Tolerance(c + i);
    told[i] = by[i] * best.mean[i];
  }
  evidence.value = count == 1 ? told[first] : told.norm();
  if (count > 1 && evidence.value > 0.0) by = by.cwiseProduct(told) / evidence.value;
  evidence.sd = std::sqrt(std::max(0.0, by.dot(best.covariance * by)));
  return evidence;
}

}  // namespace flextip::diagnosis::running
