#include "calibration/em/em_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/em/coverage.h"
#include "calibration/residual_statistics.h"
#include "core/linear_algebra.h"
#include "core/median.h"

namespace flextip {
namespace {

constexpr std::size_t kFewestPairs = 50, kMostForChoice = 1200;
constexpr double kLeastShare = 0.6;
constexpr const char* kRegistration = "em0.T_RF";
constexpr const char* kDistance = "em0.distance_from_tip_m";
constexpr const char* kField = "em0.field";

std::vector<EmPair> Used(const std::vector<EmPair>& pairs, const std::vector<double>& weights,
                         std::size_t most) {
  std::vector<EmPair> used;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (weights[i] > 0) used.push_back(pairs[i]);
  }
  const std::size_t every = 1 + (used.size() - 1) / most;
  std::vector<EmPair> thinned;
  for (std::size_t i = 0; i < used.size(); i += every) thinned.push_back(used[i]);
  return thinned;
}

/// 1 within `limit` times what is usual, 0 beyond.
std::vector<double> Inliers(const std::vector<EmPair>& pairs, const EmSolution& solution,
                            double limit) {
  std::vector<double> sigmas;
  sigmas.reserve(pairs.size());
  for (const EmPair& pair : pairs) sigmas.push_back(EmSigmas(pair, solution));
  const double scale = std::max(1e-9, RobustScale(sigmas));
  for (double& s : sigmas) s = s <= limit * scale ? 1.0 : 0.0;
  return sigmas;
}

/// Variance of the whitened residuals.
double NoiseVariance(const std::vector<EmPair>& pairs, const std::vector<double>& weights,
                     const EmSolution& solution, const EmDesign& design) {
  double sum = 0.0, rows = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (weights[i] == 0.0) continue;
    sum += std::pow(EmSigmas(pairs[i], solution), 2);
    rows += 3.0;
  }
  return sum / std::max(1.0, rows - design.Parameters());
}

/// With the distance free where it is certain enough then, else with that of `options`.
EmSolution FitWithDistance(const std::vector<EmPair>& pairs, const std::vector<double>& weights,
                           const EmOptions& options, const EmSolution& start, EmDesign& design) {
  design.free_distance = true;
  const EmSolution free = FitEm(pairs, weights, design, start);
  if (free.ok) {
    const double variance = free.covariance(6, 6) * NoiseVariance(pairs, weights, free, design);
    if (std::sqrt(variance) <= options.max_distance_sd_m) return free;
  }
  design.free_distance = false;
  EmSolution fixed = start;
  fixed.distance_m = options.distance_from_tip_m;
  return FitEm(pairs, weights, design, fixed);
}

/// Fits, takes out outliers, and again until they stay the same.
EmSolution FitWithoutOutliers(const std::vector<EmPair>& pairs, const EmOptions& options,
                              EmSolution solution, EmDesign& design, std::vector<double>& weights) {
  constexpr int kRounds = 8;
  solution = FitWithDistance(pairs, weights, options, solution, design);
  for (int round = 0; round < kRounds && solution.ok; ++round) {
    const auto next = Inliers(pairs, solution, OutlierLimit(pairs.size()));
    if (next == weights) break;
    weights = next;
    solution = FitEm(pairs, weights, design, solution);
  }
  return solution;
}

std::vector<Eigen::Vector3d> Places(const std::vector<EmPair>& pairs,
                                    const std::vector<double>& weights, const Pose& T_RF) {
  std::vector<Eigen::Vector3d> places;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (weights[i] > 0) places.push_back(T_RF * pairs[i].T_FS.p);
  }
  return places;
}

/// The standard deviation of the correction where it is least certain.
double GreatestFieldSd(const std::vector<Eigen::Vector3d>& places, const EmResult& result) {
  const int n = result.design.Coefficients(), fixed = result.design.Parameters() - n;
  double greatest = 0.0;
  const std::size_t every = 1 + places.size() / 100;
  for (std::size_t i = 0; i < places.size(); i += every) {
    const Eigen::Vector3d u =
        (places[i] - result.design.centre_m).cwiseQuotient(result.design.scale_m);
    const Eigen::VectorXd f = result.design.basis.At(u);
    Eigen::MatrixXd J(3, n);
    for (int k = 0; k < f.size(); ++k) J.middleCols<3>(3 * k) = f[k] * Eigen::Matrix3d::Identity();
    const Eigen::MatrixXd C = result.solution.covariance.block(fixed, fixed, n, n);
    greatest = std::max(greatest, (J * C * J.transpose()).diagonal().maxCoeff());
  }
  return std::sqrt(greatest);
}

void DescribeResiduals(const std::vector<EmPair>& pairs, const std::vector<double>& weights,
                       const EmSolution& before, EmResult& result) {
  const double limit = OutlierLimit(pairs.size());
  double before_m2 = 0.0, after_m2 = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EmResidual& r = result.residuals.emplace_back();
    r.before_R = EmError(pairs[i], before);
    r.after_R = EmError(pairs[i], result.solution);
    r.place_R = ApplyField(result.solution.field, result.solution.T_RF * pairs[i].T_FS.p);
    r.sigmas = EmSigmas(pairs[i], result.solution) / result.noise_scale;
    r.used = weights[i] > 0;
    if (!r.used) {
      r.reason = fmt::format("{:.2f} mm off: {:.1f} sigmas; the limit is {:.1f}",
                             1e3 * r.after_R.norm(), r.sigmas, limit);
      continue;
    }
    ++result.used;
    before_m2 += r.before_R.squaredNorm();
    after_m2 += r.after_R.squaredNorm();
  }
  result.rms_before_m = std::sqrt(before_m2 / std::max(1, 3 * result.used));
  result.rms_after_m = std::sqrt(after_m2 / std::max(1, 3 * result.used));
}

/// The sensor's x axis beside the shaft; a tilt that stays in the sensor's own frame is its mount.
void DescribeAngles(const std::vector<EmPair>& pairs, EmResult& result) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const auto shaft_in_S = [&](std::size_t i) -> Eigen::Vector3d {
    return (result.solution.T_RF.R * pairs[i].T_FS.R).transpose() * pairs[i].t_RE;
  };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (result.residuals[i].used) mean += shaft_in_S(i);
  }
  mean.normalize();
  result.tilt_rad = std::atan2(mean.tail<2>().norm(), mean.x());
  double sum = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d t = shaft_in_S(i);
    EmResidual& r = result.residuals[i];
    r.angle_rad = std::atan2(t.cross(mean).norm(), t.dot(mean));
    if (r.used) sum += r.angle_rad * r.angle_rad;
  }
  result.angle_rms_rad = std::sqrt(sum / std::max(1, result.used));
}

void DescribeLag(const std::vector<EmPair>& pairs, EmResult& result) {
  std::vector<Eigen::Vector3d> errors;
  std::vector<bool> used;
  for (const EmResidual& r : result.residuals) {
    errors.push_back(r.after_R);
    used.push_back(r.used);
  }
  result.lag = LagOf(pairs, errors, used, result.solution.distance_m);
}

/// Noise of one component of a typical pair, as found (m).
double TypicalNoise(const std::vector<EmPair>& pairs, double noise_scale) {
  std::vector<double> variances;
  variances.reserve(pairs.size());
  for (const EmPair& pair : pairs) variances.push_back(pair.covariance.trace() / 3.0);
  return noise_scale * std::sqrt(Median(variances));
}

/// What keeps the registration from being known; empty where it is.
std::string RegistrationDoubt(const EmCoverage& coverage, const EmOptions& options,
                              const EmResult& result, double noise_m) {
  constexpr double kLeastOverNoise = 4.0;
  const Eigen::Vector3d spread_mm = 1e3 * coverage.spread_m;
  if (!result.solution.ok || coverage.spread_m[1] < kLeastOverNoise * noise_m) {
    return fmt::format(
        "the sensor stayed near a line ({:.1f} x {:.1f} x {:.1f} mm rms): the turn about it is "
        "unknown",
        spread_mm[2], spread_mm[1], spread_mm[0]);
  }
  const Eigen::Matrix3d turn = result.solution.covariance.topLeftCorner<3, 3>();
  const double sd_rad = std::sqrt(std::max(0.0, SymmetricEigenvalues(turn)[2]));
  if (sd_rad <= options.max_rotation_sd_rad) return "";
  return fmt::format(
      "the sensor moved too little ({:.1f} x {:.1f} x {:.1f} mm rms): the turn of the EM system is "
      "known to {:.3f} rad only",
      spread_mm[2], spread_mm[1], spread_mm[0], sd_rad);
}

void NameUnobservable(const EmOptions& options, EmResult& result) {
  if (!result.IsUsable()) {
    for (const char* name : {kRegistration, kDistance, kField}) {
      result.unobservable.push_back({name, result.message});
    }
    return;
  }
  if (!result.design.free_distance) {
    result.unobservable.push_back(
        {kDistance,
         fmt::format("the shaft's direction does not tell it from {}; {:.1f} mm were supposed",
                     result.design.basis.kind == FieldKind::kNone ? "where the EM system stands"
                                                                  : "the field",
                     1e3 * options.distance_from_tip_m)});
  }
  const auto refused = std::find_if(result.candidates.begin(), result.candidates.end(),
                                    [](const EmCandidate& c) { return !c.reason.empty(); });
  if (result.design.basis.kind == FieldKind::kNone && refused != result.candidates.end()) {
    result.unobservable.push_back({kField, refused->reason});
  }
}

void FillCovariance(const std::vector<EmPair>& pairs, const std::vector<double>& weights,
                    EmResult& result) {
  const double variance = NoiseVariance(pairs, weights, result.solution, result.design);
  std::vector<Eigen::Vector3d> whitened;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (weights[i] == 0.0) continue;
    const Eigen::Matrix3d L = Llt(pairs[i].covariance).L();
    whitened.emplace_back(L.inverse() * EmError(pairs[i], result.solution));
  }
  result.noise_scale = std::max(1e-9, std::sqrt(variance));
  result.correlation_time = CorrelationTime(whitened);
  result.solution.covariance *= variance * result.correlation_time;
}

/// The design of the candidate that was chosen.
EmDesign ChosenDesign(const EmResult& result) {
  for (const EmCandidate& c : result.candidates) {
    if (c.chosen) return c.design;
  }
  return {};
}

void Solve(const std::vector<EmPair>& pairs, const EmOptions& options, const EmSolution& start,
           std::vector<double>& weights, EmResult& result) {
  result.design = ChosenDesign(result);
  result.solution = FitWithoutOutliers(pairs, options, start, result.design, weights);
  if (!result.solution.ok) return;
  FillCovariance(pairs, weights, result);
  if (!result.design.free_distance ||
      std::sqrt(result.solution.covariance(6, 6)) <= options.max_distance_sd_m) {
    return;
  }
  // Noise that lasts left it less certain than it seemed.
  result.design.free_distance = false;
  EmSolution fixed = result.solution;
  fixed.distance_m = options.distance_from_tip_m;
  result.solution = FitEm(pairs, weights, result.design, fixed);
  if (result.solution.ok) FillCovariance(pairs, weights, result);
}

/// A field that is not known well enough somewhere the sensor was is none.
bool RefuseVagueField(const std::vector<Eigen::Vector3d>& places, const EmOptions& options,
                      EmResult& result) {
  if (result.design.basis.kind == FieldKind::kNone) return false;
  const double sd_m = result.solution.ok ? GreatestFieldSd(places, result)
                                         : std::numeric_limits<double>::infinity();
  if (sd_m <= options.max_field_sd_m) return false;
  for (EmCandidate& c : result.candidates) {
    if (c.chosen) c.reason = fmt::format("the field is known to {:.2f} mm only", 1e3 * sd_m);
    c.chosen = c.design.basis.kind == FieldKind::kNone;
  }
  return true;
}

}  // namespace

const char* Name(EmStatus status) {
  switch (status) {
    case EmStatus::kOk:
      return "ok";
    case EmStatus::kTooFewPairs:
      return "too few samples";
    case EmStatus::kUnobservable:
      return "unobservable";
    case EmStatus::kNoAgreement:
      return "no agreement";
  }
  return "";
}

EmResult CalibrateEm(const std::vector<EmPair>& pairs, const EmOptions& options) {
  EmResult result;
  if (pairs.size() < kFewestPairs) {
    result.message = fmt::format("{} samples with a reference, expected {} at least", pairs.size(),
                                 kFewestPairs);
    NameUnobservable(options, result);
    return result;
  }
  // A field may put many samples off a plain registration: at first only what is grossly off goes.
  constexpr double kGross = 3.0;
  const EmSolution robust = RobustEm(pairs, options.distance_from_tip_m);
  std::vector<double> weights = Inliers(pairs, robust, kGross * OutlierLimit(pairs.size()));
  EmDesign plain;
  const EmSolution first = FitWithDistance(pairs, weights, options, robust, plain);
  const auto places = Places(pairs, weights, first.T_RF);
  const EmCoverage coverage = CoverageOf(places);
  result.candidates = FieldCandidates(coverage);
  if (first.ok) ChooseField(Used(pairs, weights, kMostForChoice), first, result.candidates);
  Solve(pairs, options, first, weights, result);
  if (RefuseVagueField(places, options, result)) Solve(pairs, options, first, weights, result);
  DescribeResiduals(pairs, weights, FitWithDistance(pairs, weights, options, first, plain), result);
  DescribeAngles(pairs, result);
  DescribeLag(pairs, result);
  result.message =
      RegistrationDoubt(coverage, options, result, TypicalNoise(pairs, result.noise_scale));
  result.status = result.message.empty() ? EmStatus::kOk : EmStatus::kUnobservable;
  if (result.used < kLeastShare * static_cast<double>(pairs.size())) {
    result.status = EmStatus::kNoAgreement;
    result.message =
        fmt::format("only {} of {} samples fit one registration", result.used, pairs.size());
  }
  NameUnobservable(options, result);
  return result;
}

}  // namespace flextip
