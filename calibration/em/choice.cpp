#include "calibration/em/choice.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr int kParts = 16;
constexpr double kGainSigmas = 2.6;  // one in a hundred by chance, of 16 parts
// Least standard error of a gain, in squares of the stated noise: without noise, the parts would
// differ by rounding errors, and all alike.
constexpr double kLeastError = 1e-9;

using Indices = std::vector<std::size_t>;

void Cut(const std::vector<Eigen::Vector3d>& places, Indices::iterator begin, Indices::iterator end,
         int first, int parts, std::vector<int>& part) {
  if (parts == 1) {
    for (auto i = begin; i != end; ++i) part[*i] = first;
    return;
  }
  Eigen::Vector3d low = places[*begin], high = low;
  for (auto i = begin; i != end; ++i) {
    low = low.cwiseMin(places[*i]);
    high = high.cwiseMax(places[*i]);
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const auto middle = begin + (end - begin) / 2;  // two halves are asked for, no median
  std::nth_element(begin, middle, end,
                   [&](std::size_t a, std::size_t b) { return places[a][axis] < places[b][axis]; });
  Cut(places, begin, middle, first, parts / 2, part);
  Cut(places, middle, end, first + parts / 2, parts / 2, part);
}

/// Each part's rows for a basis, about the start.
struct PartSums {
  FieldBasis basis = {};
  std::vector<std::vector<EmPair>> pairs = std::vector<std::vector<EmPair>>(kParts);
  std::vector<EmRows> rows = {};
  std::vector<Eigen::MatrixXd> H = {};
  std::vector<Eigen::VectorXd> g = {};
};

void Accumulate(const EmDesign& design, const EmSolution& start, PartSums& sums) {
  if (!sums.rows.empty() && sums.basis.kind == design.basis.kind &&
      sums.basis.order == design.basis.order) {
    return;
  }
  sums.basis = design.basis;
  sums.rows.clear();
  sums.H.clear();
  sums.g.clear();
  for (const auto& pairs : sums.pairs) {
    const EmRows& rows = sums.rows.emplace_back(RowsOf(pairs, design, start));
    sums.H.emplace_back(rows.J.transpose() * rows.J);
    sums.g.emplace_back(rows.J.transpose() * rows.r);
  }
}

struct PartErrors {
  bool ok = true;
  double square_m2 = 0.0;                  // summed over all parts
  std::vector<double> square_sigmas = {};  // mean whitened square, of each part
};

/// Each part by the others.
PartErrors HeldOut(const PartSums& sums, const EmDesign& design) {
  Eigen::MatrixXd H_all = sums.H[0];
  Eigen::VectorXd g_all = sums.g[0];
  for (int k = 1; k < kParts; ++k) {
    H_all += sums.H[k];
    g_all += sums.g[k];
  }
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(design.Coefficients());
  PartErrors errors;
  for (int k = 0; k < kParts; ++k) {
    const EmStep step = SolveStep(design, H_all - sums.H[k], g_all - sums.g[k], none, false);
    if (!step.ok) return {.ok = false};
    const Eigen::VectorXd r = sums.rows[k].r + sums.rows[k].J * step.step;
    errors.square_sigmas.push_back(r.squaredNorm() / static_cast<double>(r.size()));
    for (std::size_t i = 0; i < sums.pairs[k].size(); ++i) {
      const Eigen::Matrix3d L = Llt(sums.pairs[k][i].covariance).L();
      errors.square_m2 += (L * r.segment<3>(3 * static_cast<Eigen::Index>(i))).squaredNorm();
    }
  }
  return errors;
}

/// Mean of simpler less richer, in its standard errors.
double Gain(const PartErrors& simpler, const PartErrors& richer) {
  const double n = kParts;
  double mean = 0.0, square = 0.0;
  for (int k = 0; k < kParts; ++k) {
    mean += (simpler.square_sigmas[k] - richer.square_sigmas[k]) / n;
  }
  for (int k = 0; k < kParts; ++k) {
    square += std::pow(simpler.square_sigmas[k] - richer.square_sigmas[k] - mean, 2);
  }
  return mean / std::max(kLeastError, std::sqrt(square / (n * (n - 1))));
}

}  // namespace

std::vector<int> PartsOfSpace(const std::vector<Eigen::Vector3d>& places) {
  std::vector<int> part(places.size());
  Indices indices(places.size());
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  Cut(places, indices.begin(), indices.end(), 0, kParts, part);
  return part;
}

void ChooseField(const std::vector<EmPair>& pairs, const EmSolution& start,
                 std::vector<EmCandidate>& candidates) {
  std::vector<Eigen::Vector3d> places;
  places.reserve(pairs.size());
  for (const EmPair& pair : pairs) places.push_back(start.T_RF * pair.T_FS.p);
  const std::vector<int> part = PartsOfSpace(places);
  PartSums sums;
  for (std::size_t i = 0; i < pairs.size(); ++i) sums.pairs[part[i]].push_back(pairs[i]);
  PartErrors best_errors;
  EmCandidate* best = nullptr;
  for (EmCandidate& candidate : candidates) {
    if (!candidate.reason.empty()) continue;
    EmSolution from = start;
    from.field = {std::vector<double>(candidate.design.Coefficients(), 0.0),
                  candidate.design.centre_m, candidate.design.scale_m};
    Accumulate(candidate.design, from, sums);
    const PartErrors errors = HeldOut(sums, candidate.design);
    if (!errors.ok) {
      candidate.reason = "parts of the space leave it unknown";
      continue;
    }
    candidate.tried = true;
    candidate.heldout_rms_m =
        std::sqrt(errors.square_m2 / (3.0 * static_cast<double>(pairs.size())));
    candidate.gain_sigmas = best == nullptr ? 0.0 : Gain(best_errors, errors);
    if (best != nullptr && candidate.gain_sigmas < kGainSigmas) continue;
    if (best != nullptr) best->chosen = false;
    candidate.chosen = true;
    best = &candidate;
    best_errors = errors;
  }
}

}  // namespace flextip
