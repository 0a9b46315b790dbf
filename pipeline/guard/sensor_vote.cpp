#include "pipeline/guard/sensor_vote.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "core/linear_algebra.h"
#include "pipeline/tip_fusion.h"

namespace flextip {
namespace {

constexpr double kClearly = 20.0;  // of chi-squared: odds of 2e4 to 1
constexpr double kFar = 10.0;      // times the limit of chi-squared
constexpr double kLoose_m = 0.03;  // a wrist or port elsewhere is looked for within some of these
// Of votes in a row that named no sensor: from then on they are taken less often.
constexpr int kUnnamed = 2;
constexpr double kUnnamedTime = 0.5;  // of resume_after_s, until the next

double Seconds(TimeNs span_ns) { return 1e-9 * static_cast<double>(span_ns); }

/// The sensors decide on places whatever the controller uses; tissue is not learnt here.
EstimatorOptions OptionsOf(EstimatorOptions options, double port_prior_m) {
  options.use_positions = true;
  options.estimate_tissue = false;
  options.compare_sensors = true;
  options.fit_beam = false;
  options.port_prior_m = port_prior_m;
  return options;
}

std::uint8_t Bit(int sensor) { return static_cast<std::uint8_t>(1U << sensor); }

constexpr int kTurn = static_cast<int>(VotedSensor::kWristTurn);

double ChiSquared(const Eigen::Vector3d& difference, const Eigen::Matrix3d& covariance) {
  return difference.dot(Ldlt(covariance).Solve(difference));
}

/// By how much chi-squared of all would be above that of the others, by the linear model; zero
/// where the others do not say what the sensor should.
double MisfitOf(VotedSensor sensor, const Measurements& z, const VotedShaft& others) {
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  if (sensor == VotedSensor::kTip && z.tip)
    return ChiSquared(z.tip->p_RE - others.tip.p, z.tip->covariance_m2 + others.tip.covariance_m2);
  if (sensor == VotedSensor::kEm && z.em) {
    const double noise_m =
        std::hypot(z.em->position_noise_m, z.em->distance_from_tip_m * z.em->orientation_noise_rad);
    return ChiSquared(*MeasuredTip({.em = z.em}, true) - others.tip.p,
                      noise_m * noise_m * unit + others.tip.covariance_m2);
  }
  if (sensor == VotedSensor::kLoad && z.load) {
    const double noise_N = z.load->force_noise_N;
    return ChiSquared(z.load->f_tip_N - others.f_tip_N,
                      noise_N * noise_N * unit + others.force_covariance_N2);
  }
  return 0.0;
}

void Mark(bool doubtful, Supervision& found) {
  if (doubtful && found.doubt == Stop::kNone) found.doubt = Stop::kTipDisagrees;
}

}  // namespace

std::uint8_t SensorsOf(const Measurements& z) {
  std::uint8_t bits = 0;
  const auto add = [&](bool has, VotedSensor sensor) {
    if (has) bits |= Bit(static_cast<int>(sensor));
  };
  add(z.tip && z.tip->status != TipStatus::kLost, VotedSensor::kTip);
  add(z.em.has_value(), VotedSensor::kEm);
  add(z.port_direction.has_value(), VotedSensor::kPortDirection);
  add(z.strain.has_value(), VotedSensor::kStrain);
  add(z.load.has_value(), VotedSensor::kLoad);
  add(z.R_RW.has_value(), VotedSensor::kWristTurn);
  return bits;
}

void Drop(VotedSensor sensor, Measurements& z) {
  switch (sensor) {
    case VotedSensor::kTip:
      z.tip.reset();
      break;
    case VotedSensor::kEm:
      z.em.reset();
      break;
    case VotedSensor::kPortDirection:
      z.port_direction.reset();
      break;
    case VotedSensor::kStrain:
      z.strain.reset();
      break;
    case VotedSensor::kLoad:
      z.load.reset();
      break;
    case VotedSensor::kWristTurn:
      z.R_RW.reset();
      break;
  }
}

SensorVote::SensorVote(const EstimatorOptions& estimator, const SupervisorOptions& options)
    : options_(options),
      limits_(options.false_alarm),
      doubts_(options.doubt),
      tolerated_(options.tolerances),
      all_(OptionsOf(estimator, estimator.port_prior_m)),
      without_one_(OptionsOf(estimator, estimator.port_prior_m)),
      loose_(OptionsOf(estimator, kLoose_m)) {}

SensorVote::Ballot SensorVote::Ask(ShaftEstimator& estimator, const Measurements& z,
                                   const ShaftChange& change) const {
  const ShaftEstimate estimate = estimator.Update(tolerated_.Widened(z), change);
  const bool fitted =
      estimate.status == EstimateStatus::kOk || estimate.status == EstimateStatus::kUnobservable;
  Ballot ballot;
  ballot.limit = limits_.Of(estimate.measurements);
  ballot.chi2 = estimate.chi2;
  ballot.doubtful = std::any_of(
      estimate.misfits.begin(), estimate.misfits.end(),
      [this](const SensorMisfit& misfit) { return misfit.chi2 > doubts_.Of(misfit.degrees); });
  ballot.agrees = fitted && estimate.chi2 <= ballot.limit;
  ballot.from_all_starts = estimate.from_all_starts;
  if (ballot.agrees && estimate.status == EstimateStatus::kOk)
    ballot.shaft = VotedShaft{{estimate.p_RE, estimate.p_RE_covariance_m2},
                              estimate.model.f_tip_N,
                              estimate.covariance.bottomRightCorner<3, 3>()};
  return ballot;
}

/// A fit from the last load may have ended beside the least squares.
SensorVote::Ballot SensorVote::AskTwice(ShaftEstimator& estimator, const Measurements& z,
                                        const ShaftChange& change) const {
  const Ballot ballot = Ask(estimator, z, change);
  if (ballot.agrees || ballot.from_all_starts) return ballot;
  estimator.Reset();
  return Ask(estimator, z, change);
}

SensorVote::Ballot SensorVote::AskWithout(int sensor, Measurements z, const ShaftChange& change) {
  Drop(static_cast<VotedSensor>(sensor), z);
  return AskTwice(without_one_, z, change);
}

/// The sensors that were out a moment ago, as bits.
std::uint8_t SensorVote::Lately(TimeNs t_ns) const {
  std::uint8_t lately = 0;
  for (int i = 0; i < kVotedSensors; ++i) {
    const TimeNs out_ns = out_ns_[static_cast<std::size_t>(i)];
    if (out_ns != 0 && Seconds(t_ns - out_ns) <= options_.resume_after_s) lately |= Bit(i);
  }
  return lately;
}

/// The one sensor that Choose takes wherever the others agree without it; -1: there is none.
int SensorVote::LikeliestOut(TimeNs t_ns, std::uint8_t jumped, std::uint8_t candidates) const {
  const auto lately = static_cast<std::uint8_t>(Lately(t_ns) & candidates);
  const auto likely = lately != 0 ? lately : static_cast<std::uint8_t>(jumped & candidates);
  return std::popcount(likely) == 1 && likely != Bit(kTurn) ? std::countr_zero(likely) : -1;
}

/// The one sensor that was out a moment ago, and is still far from what the others say, who agree:
/// nobody else needs to be asked. `ballot`: without it.
std::optional<int> SensorVote::WhoStaysOut(TimeNs t_ns, const Measurements& z,
                                           const ShaftChange& change, Ballot& ballot) {
  const auto lately = static_cast<std::uint8_t>(Lately(t_ns) & SensorsOf(z));
  if (std::popcount(lately) != 1) return {};
  const int sensor = std::countr_zero(lately);
  Measurements rest = z;
  Drop(static_cast<VotedSensor>(sensor), rest);
  ballot = Ask(without_one_, rest, change);
  if (!ballot.agrees || !ballot.shaft) return {};
  const double misfit =
      MisfitOf(static_cast<VotedSensor>(sensor), tolerated_.Widened(z), *ballot.shaft);
  if (!(misfit > kFar * ballot.limit)) return {};
  ballot.chi2 += misfit;
  return sensor;
}

/// The sensor to take out; -1 where it cannot be told, -2 where none alone explains it.
int SensorVote::Choose(TimeNs t_ns, std::uint8_t jumped,
                       const std::array<Ballot, kVotedSensors>& without,
                       std::uint8_t candidates) const {
  std::uint8_t explain = 0;
  for (int i = 0; i < kVotedSensors; ++i) {
    if ((candidates & Bit(i)) != 0 && without[static_cast<std::size_t>(i)].agrees)
      explain |= Bit(i);
  }
  if (explain == 0) return -2;
  // Without the wrist's turn nobody knows about which axes the gages measure: both are left out.
  if ((explain & Bit(static_cast<int>(VotedSensor::kStrain))) != 0)
    explain &= static_cast<std::uint8_t>(~Bit(kTurn));
  for (const std::uint8_t choice : {explain, static_cast<std::uint8_t>(explain & Lately(t_ns)),
                                    static_cast<std::uint8_t>(explain & jumped)}) {
    if (std::popcount(choice) == 1) return std::countr_zero(choice);
  }
  int best = -1;
  double least = 0.0, second = 0.0;
  for (int i = 0; i < kVotedSensors; ++i) {
    if ((explain & Bit(i)) == 0) continue;
    const double chi2 = without[static_cast<std::size_t>(i)].chi2;
    if (best < 0 || chi2 < least) {
      second = best < 0 ? chi2 : least;
      if (best < 0) second = std::numeric_limits<double>::infinity();
      best = i;
      least = chi2;
    } else {
      second = std::min(second, chi2);
    }
  }
  return second - least > kClearly ? best : -1;
}

/// Whether a wrist that is not where it says explains all sensors, and no worse than leaving one of
/// them out does.
bool SensorVote::WristExplains(const Measurements& z, const ShaftChange& change,
                               double chi2_without) {
  Measurements loose = z;
  loose.wrist_position_noise_m = kLoose_m;
  const Ballot ballot = Ask(without_one_, loose, change);
  return ballot.agrees && ballot.chi2 < chi2_without + kClearly;
}

std::optional<VotedShaft> SensorVote::TakeOut(TimeNs t_ns, int sensor, const Ballot& ballot,
                                              Measurements& z, Supervision& found) {
  Drop(static_cast<VotedSensor>(sensor), z);
  found.voted_out |= Bit(sensor);
  out_ns_[static_cast<std::size_t>(sensor)] = t_ns;
  Mark(ballot.doubtful, found);
  return ballot.shaft;
}

std::optional<VotedShaft> SensorVote::Vote(TimeNs t_ns, std::uint8_t jumped,
                                           const ShaftChange& change, Measurements& z,
                                           Supervision& found) {
  const bool keeps = unnamed_.in_a_row >= kUnnamed &&
                     Seconds(t_ns - unnamed_.t_ns) < kUnnamedTime * options_.resume_after_s;
  std::optional<VotedShaft> shaft;
  if (keeps) {
    found.chi2 = unnamed_.chi2;
    found.chi2_limit = unnamed_.chi2_limit;
  } else {
    Stop stop = Stop::kNone;
    shaft = VoteAnew(t_ns, jumped, change, z, found, stop);
    const int in_a_row = stop == Stop::kNone ? 0 : unnamed_.in_a_row + 1;
    unnamed_ = {t_ns, std::min(in_a_row, kUnnamed), stop, found.chi2, found.chi2_limit};
  }
  if (unnamed_.stop != Stop::kNone && found.reaction < Reaction::kHold) {
    found.stop = unnamed_.stop;
    found.reaction = Reaction::kHold;
  }
  return shaft;
}

std::optional<VotedShaft> SensorVote::VoteAnew(TimeNs t_ns, std::uint8_t jumped,
                                               const ShaftChange& change, Measurements& z,
                                               Supervision& found, Stop& unnamed) {
  const std::uint8_t candidates = SensorsOf(z);
  if (candidates == 0) return {};
  Ballot rest;
  if (const auto out = WhoStaysOut(t_ns, z, change, rest)) {
    found.chi2 = rest.chi2;
    found.chi2_limit = rest.limit;
    return TakeOut(t_ns, *out, rest, z, found);
  }
  const Ballot all = AskTwice(all_, z, change);
  found.chi2 = all.chi2;
  found.chi2_limit = all.limit;
  if (all.agrees) {
    Mark(all.doubtful, found);
    if (all.shaft) tolerated_.Learn(t_ns, z, all.shaft->tip.p);
    for (int i = 0; i < kVotedSensors; ++i) {
      if ((Lately(t_ns) & Bit(i)) == 0) continue;
      Drop(static_cast<VotedSensor>(i), z);
      found.voted_out |= Bit(i);
    }
    return all.shaft;
  }
  std::array<Ballot, kVotedSensors> without;
  int out = LikeliestOut(t_ns, jumped, candidates);
  if (out >= 0) without[static_cast<std::size_t>(out)] = AskWithout(out, z, change);
  if (out < 0 || !without[static_cast<std::size_t>(out)].agrees) {
    const int asked = out;
    for (int i = 0; i < kVotedSensors; ++i) {
      if ((candidates & Bit(i)) != 0 && i != asked)
        without[static_cast<std::size_t>(i)] = AskWithout(i, z, change);
    }
    out = Choose(t_ns, jumped, without, candidates);
  }
  const double chi2_without = out >= 0 ? without[static_cast<std::size_t>(out)].chi2
                                       : std::numeric_limits<double>::infinity();
  if (WristExplains(z, change, chi2_without)) {
    unnamed = Stop::kWristNotFollowing;
    return {};
  }
  if (out >= 0) return TakeOut(t_ns, out, without[static_cast<std::size_t>(out)], z, found);
  if (out == -1) {
    unnamed = Stop::kTipDisagrees;
  } else {
    unnamed = Ask(loose_, z, change).agrees ? Stop::kPortMoved : Stop::kModelDisagrees;
  }
  return {};
}

}  // namespace flextip
