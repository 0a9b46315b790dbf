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

OnsetEvidence Weigh(const Reduced& reduced, const WatchedBlock& block,
                    const WatchedParameters& parameters) {
  const int n = block.widened;
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
  for (int i = 0; i < n; ++i) {
    evidence.farthest = std::max(
        evidence.farthest, std::abs(best.mean[i]) / block.typical[static_cast<std::size_t>(i)]);
  }
  const double size = best.mean.norm();
  if (size > 0.0) {
    const SmallVector along = best.mean / size;
    evidence.beyond = size - 2.0 * std::sqrt(std::max(0.0, along.dot(best.covariance * along)));
  }
  // What is told: the value itself, or the length of several.
  const int first = block.drifts ? 0 : block.row->first, count = block.row->count;
  SmallVector told = SmallVector::Zero(), by = SmallVector::Zero();
  for (int i = first; i < first + count; ++i) {
    by[i] = parameters.Tolerance(block.first + i);
    told[i] = by[i] * best.mean[i];
  }
  evidence.value = count == 1 ? told[first] : told.norm();
  if (count > 1 && evidence.value > 0.0) by = by.cwiseProduct(told) / evidence.value;
  evidence.sd = std::sqrt(std::max(0.0, by.dot(best.covariance * by)));
  return evidence;
}

}  // namespace

void Growth::TakeOlder(const Information& since, const Information& block, int first) {
  constexpr double kHalf = 0.5;  // a block grows by half of its own time
  own += cross.middleRows<kCount>(first) + cross.middleRows<kCount>(first).transpose() +
         since.H.block<kCount, kCount>(first, first) +
         kHalf * kHalf * block.H.block<kCount, kCount>(first, first);
  cross += since.H.middleCols<kCount>(first) + kHalf * block.H.middleCols<kCount>(first);
  g += since.g.segment<kCount>(first) + kHalf * block.g.segment<kCount>(first);
}

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
  return Weigh(reduced, block, parameters);
}

OnsetEvidence AllSamples::Of(const WatchedBlock& block, const WatchedParameters& parameters,
                             const Growth& growth) const {
  const Eigen::Matrix<double, kParameters, Growth::kCount> across = factor_.SolveL(growth.cross);
  Reduced reduced;
  reduced.S.topLeftCorner<Growth::kCount, Growth::kCount>() =
      growth.own - across.transpose() * across;
  reduced.g.head<Growth::kCount>() = growth.g - across.transpose() * whitened_g_;
  return Weigh(reduced, block, parameters);
}

double AllSamples::OfAll(const WatchedParameters& parameters) const {
  Information::Vector sd = Information::Vector::Zero();
  for (const WatchedBlock& block : parameters.Blocks()) {
    if (block.drifts) continue;
    for (int i = 0; i < block.widened; ++i)
      sd[block.first + i] = block.typical[static_cast<std::size_t>(i)];
  }
  Information::Matrix M = part_.H;
  M.noalias() -= whitened_part_.transpose() * whitened_part_;
  M = sd.asDiagonal() * M * sd.asDiagonal();
  M.diagonal().array() += 1.0;
  const Llt<kParameters> factor(M);
  if (!factor.Succeeded()) return 0.0;
  const Information::Vector b =
      factor.SolveL(sd.cwiseProduct(part_.g - whitened_part_.transpose() * whitened_g_));
  return 0.5 * b.squaredNorm() - 0.5 * factor.LogDeterminant();
}

}  // namespace flextip::diagnosis::running
