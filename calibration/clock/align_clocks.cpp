#include "calibration/clock/align_clocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/clock/clock_fit.h"
#include "core/error.h"

namespace flextip {
namespace {

constexpr double kSpeedBandwidth_s = 0.12;
constexpr std::size_t kBySpeed = 6, kByMisfit = 6;
// Twice the log likelihood by which the best offset must surpass all others: hundreds of them.
constexpr double kTelling = 25.0;
constexpr double kNeighbours_s = 0.2;
constexpr double kMostSd_s = 0.1;

void Fail(StreamClock& clock, ClockStatus status, const std::string& reason) {
  clock.status = status;
  clock.reason = reason;
}

/// Quick fits from all likely starts, the best first, each at an offset of its own.
std::vector<ClockFit> Candidates(const Motion& target, const Motion& reference,
                                 Predictors& predictors, const MisfitProfile& profile,
                                 const ClockOptions& options) {
  std::vector<double> starts = LikelyOffsets(
      SmoothMotion(target, std::max(kSpeedBandwidth_s, UsualBandwidth(target))), target.own_rows,
      SmoothMotion(reference, std::max(kSpeedBandwidth_s, UsualBandwidth(reference))),
      reference.own_rows, options.most_offset_s, options.least_overlap_s, kBySpeed);
  const std::vector<double> by_misfit = BestOffsets(profile, kByMisfit);
  starts.insert(starts.end(), by_misfit.begin(), by_misfit.end());
  std::vector<double> apart;
  const auto is_near = [](double a) {
    return [a](double b) { return std::abs(a - b) < kNeighbours_s; };
  };
  std::vector<ClockFit> fits;
  for (const double start_s : starts) {
    if (std::any_of(apart.begin(), apart.end(), is_near(start_s))) continue;
    apart.push_back(start_s);
    const ClockFit fit = QuickFit(target, predictors, start_s, 0.0, true);
    if (fit.converged && std::abs(fit.offset_s) <= options.most_offset_s + 0.5) fits.push_back(fit);
  }
  std::sort(fits.begin(), fits.end(),
            [](const ClockFit& a, const ClockFit& b) { return a.brought > b.brought; });
  std::vector<ClockFit> own;
  for (const ClockFit& fit : fits) {
    const auto beside = [&](const ClockFit& other) {
      return std::abs(other.offset_s - fit.offset_s) < kNeighbours_s;
    };
    if (std::none_of(own.begin(), own.end(), beside)) own.push_back(fit);
  }
  return own;
}

double Residuals(const Motion& target, const ClockFit& fit) {
  return static_cast<double>(fit.samples) * target.own_rows;
}

/// What evidence differs by because two offsets compare parts of the streams that are not the same:
/// four standard deviations of the sum of squares over these parts.
double Chance(const Motion& target, const ClockFit& fit, double other_s) {
  const double span_s = std::max(1e-9, target.t_s.back() - target.t_s.front());
  const double apart = std::min(1.0, 2.0 * std::abs(other_s - fit.offset_s) / span_s);
  return 4.0 * std::sqrt(2.0 * apart * Residuals(target, fit));
}

StreamClock Compare(const Motion& target, const Motion& reference, TimeNs epoch_ns,
                    const ClockOptions& options) {
  StreamClock clock{.stream = target.stream, .reference = reference.stream};
  Predictors predictors(reference);
  clock.profile =
      MisfitOver(target, predictors.Smooth(), options.most_offset_s, options.least_overlap_s);
  const bool any = std::any_of(clock.profile.misfit.begin(), clock.profile.misfit.end(),
                               [](double m) { return !std::isnan(m); });
  if (!any) {
    Fail(clock, ClockStatus::kTooShort,
         fmt::format("{} and {} have less than {:g} s in common at every offset within {:g} s",
                     target.stream, reference.stream, options.least_overlap_s,
                     options.most_offset_s));
    return clock;
  }
  const std::vector<ClockFit> candidates =
      Candidates(target, reference, predictors, clock.profile, options);
  const ClockFit fit =
      candidates.empty() ? ClockFit{} : FitClock(target, predictors, candidates.front().offset_s);
  if (!fit.converged) {
    Fail(clock, ClockStatus::kNotConverged,
         fmt::format("no offset of {} against {} came to rest", target.stream, reference.stream));
    return clock;
  }
  clock.offset_s = fit.offset_s;
  clock.rate = fit.rate;
  clock.origin_ns = epoch_ns + std::llround(1e9 * fit.origin_s);
  clock.covariance = fit.covariance;
  clock.misfit = fit.misfit;
  clock.samples = fit.samples;
  const auto as_good = [&](const ClockFit& other) {
    return std::abs(other.offset_s - candidates.front().offset_s) > kNeighbours_s &&
           Residuals(target, candidates.front()) * (candidates.front().brought - other.brought) <
               kTelling + Chance(target, fit, other.offset_s);
  };
  const double sd_s = std::sqrt(fit.covariance(0, 0));
  const double residuals = Residuals(target, fit);
  const double chance = fit.parameters + 3.0 * std::sqrt(2.0 * fit.parameters);
  if (sd_s > kMostSd_s) {
    Fail(clock, ClockStatus::kNoSharedMotion,
         fmt::format("{} tells its clock against {} to {:.0f} ms only", target.stream,
                     reference.stream, 1e3 * sd_s));
  } else if (residuals * fit.brought < kTelling + chance) {
    Fail(clock, ClockStatus::kNoSharedMotion,
         fmt::format("{} does not move as {} does at any offset within {:g} s", target.stream,
                     reference.stream, options.most_offset_s));
  } else if (std::any_of(candidates.begin(), candidates.end(), as_good) ||
             std::abs(fit.offset_s - candidates.front().offset_s) > kNeighbours_s) {
    Fail(clock, ClockStatus::kAmbiguous,
         fmt::format("other offsets of {} against {} fit nearly as well: the motion is too slow, "
                     "too small or repeats itself",
                     target.stream, reference.stream));
  } else {
    clock.status = ClockStatus::kOk;
  }
  return clock;
}

/// The clock against the main reference, by way of a stream whose clock is known.
StreamClock Through(StreamClock clock, const StreamClock& between) {
  const double since_s =
      1e-9 * static_cast<double>(clock.origin_ns - between.origin_ns) + clock.offset_s;
  clock.by = clock.reference;
  clock.reference = between.reference;
  clock.offset_s += between.offset_s + between.rate * since_s;
  clock.rate += between.rate + clock.rate * between.rate;
  Eigen::Matrix2d by_between;
  by_between << 1.0, since_s, 0.0, 1.0;
  clock.covariance += by_between * between.covariance * by_between.transpose();
  return clock;
}

}  // namespace

const char* Name(ClockStatus status) {
  switch (status) {
    case ClockStatus::kOk:
      return "ok";
    case ClockStatus::kTooShort:
      return "too short";
    case ClockStatus::kNoSharedMotion:
      return "no shared motion";
    case ClockStatus::kAmbiguous:
      return "ambiguous";
    case ClockStatus::kNotConverged:
      break;
  }
  return "not converged";
}

ClockResult AlignClocks(const Recording& recording, const ClockOptions& options) {
  const Motions motions = MotionsOf(recording);
  const std::string known = motions.Names();
  if (motions.streams.size() < 2) {
    throw InputError(fmt::format(
        "the recording has {}, expected two of wrist0, em0, vision0, load0 and strain0 that move",
        known.empty() ? "none of these streams that moves" : known + " alone"));
  }
  const Motion* reference =
      options.reference.empty() ? &motions.streams.front() : motions.Find(options.reference);
  if (reference == nullptr) {
    throw InputError(fmt::format("the reference is {}: expected one of the streams that move, {}",
                                 options.reference, known));
  }
  ClockResult result{.reference = reference->stream};
  for (const Motion& target : motions.streams) {
    if (&target == reference) continue;
    result.streams.push_back(Compare(target, *reference, motions.epoch_ns, options));
  }
  const std::vector<StreamClock> direct = result.streams;
  for (StreamClock& clock : result.streams) {
    for (const StreamClock& between : direct) {
      if (clock.IsUsable() || !between.IsUsable()) continue;
      const StreamClock other = Compare(*motions.Find(clock.stream), *motions.Find(between.stream),
                                        motions.epoch_ns, options);
      if (other.IsUsable()) clock = Through(other, between);
    }
  }
  return result;
}

Calibration ClockEntries(const ClockResult& result, const std::string& camera) {
  Calibration calibration;
  calibration.kind = "clocks";
  std::map<std::string, Eigen::Matrix3d> covariance;  // of rate_at, offset, rate by the name
  for (const StreamClock& clock : result.streams) {
    const std::string name = clock.stream == "vision0" ? camera : clock.stream;
    if (!clock.IsUsable()) {
      calibration.unobservable.push_back({name + ".time_offset_s", clock.reason});
      continue;
    }
    calibration.numbers[name + ".time_offset_s"] = {clock.offset_s};
    calibration.numbers[name + ".time_origin_s"] = {1e-9 * static_cast<double>(clock.origin_ns)};
    calibration.numbers[name + ".time_rate"] = {clock.rate};
    Eigen::Matrix3d& block = covariance[name];
    block.setZero();
    block(0, 0) = clock.covariance(0, 0);
    block(0, 2) = block(2, 0) = clock.covariance(0, 1);
    block(2, 2) = clock.covariance(1, 1);
  }
  const auto n = static_cast<Eigen::Index>(3 * covariance.size());
  calibration.covariance = Eigen::MatrixXd::Zero(n, n);
  Eigen::Index at = 0;
  for (const auto& [name, block] : covariance) {
    calibration.covariance.block<3, 3>(at, at) = block;
    at += 3;
  }
  return calibration;
}

}  // namespace flextip
