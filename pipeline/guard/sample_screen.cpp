#include "pipeline/guard/sample_screen.h"

#include <algorithm>
#include <cmath>

namespace flextip {
namespace {

// Of three components at once, each normal, less than one in 1e7 is this many deviations long.
constexpr double kDeviations = 6.0;
constexpr double kFuture_s = 0.05;         // clocks of one room
constexpr double kTissueSpeed_m_s = 0.02;  // breath and heart move what the tip touches
constexpr double kTissue_s = 0.1;          // and that long in one direction
constexpr double kBentMore = 1.2;          // of the straight shaft's motion
constexpr double kGaps = 4.0;              // a stream that misses three samples in a row is gone
constexpr double kLearn = 0.1;
constexpr double kAge_s = 0.005;   // of a sample may change so much beside what was seen
constexpr int kAges = 5;           // until the usual one is known
constexpr int kRepeats = 2;        // after the first
constexpr double kMoved_m = 1e-4;  // least motion that a sensor must show

double Seconds(TimeNs span_ns) { return 1e-9 * static_cast<double>(span_ns); }

void Out(VotedSensor sensor, Supervision& found) {
  found.voted_out |= static_cast<std::uint8_t>(1U << static_cast<int>(sensor));
}

double Sd(const Eigen::Matrix3d& covariance_m2) {
  return std::sqrt(std::max(0.0, covariance_m2.trace() / 3.0));
}

}  // namespace

bool SampleScreen::IsStale(const Past& past, TimeNs now_ns) const {
  const double limit_s = std::max(options_.stale_s, kGaps * Seconds(past.gap_ns));
  return past.arrived_ns == 0 || Seconds(now_ns - past.arrived_ns) > limit_s;
}

bool SampleScreen::TipIsOverdue(TimeNs t_ns) const {
  const double usual_s = Seconds(tip_past_.gap_ns) + 1.0 / options_.rate_hz;
  return tip_past_.arrived_ns == 0 || Seconds(t_ns - tip_past_.arrived_ns) > usual_s + kAge_s;
}

bool SampleScreen::TipIsDue(TimeNs last_ns, TimeNs t_ns) const {
  return Seconds(t_ns - last_ns) > Seconds(tip_past_.gap_ns) - 0.5 / options_.rate_hz;
}

/// Whether a sample on its arrival is older or younger than those before, by more than the cycle in
/// which it had to wait. Clocks that leap, or stand still for a while, show so.
bool SampleScreen::IsOfAnotherAge(Past& past, double age_s) const {
  const double change_s = std::abs(age_s - past.age_s);
  const double limit_s = 1.0 / options_.rate_hz + kAge_s + kDeviations * past.age_changes_s;
  if (past.ages >= kAges && change_s > limit_s) return true;
  ++past.ages;
  const double part = std::max(kLearn, 1.0 / past.ages);
  past.age_s += part * (age_s - past.age_s);
  past.age_changes_s += part * (change_s - past.age_changes_s);
  return false;
}

void SampleScreen::Forget() {
  tip_.known = em_.known = false;
  for (Past* past : {&wrist_, &tip_past_, &em0_past_, &em1_past_, &strain_past_, &load_past_})
    past->ages = 0;
}

/// What is wrong with a stream in this cycle; kNone where it can be used.
Stop SampleScreen::Look(Past& past, TimeNs now_ns, TimeNs t_ns, const Figures& figures, bool finite,
                        const std::optional<Eigen::Vector3d>& p_RW, double p_RW_sd_m) {
  if (!finite) return Stop::kNotFinite;
  if (past.arrived_ns != 0 && t_ns < past.t_ns) return Stop::kBadTime;
  if (Seconds(t_ns - now_ns) > kFuture_s) return Stop::kBadTime;
  if (past.arrived_ns == 0 || t_ns > past.t_ns) {
    has_news_ = true;
    if (IsOfAnotherAge(past, Seconds(now_ns - t_ns))) return Stop::kBadTime;
    const TimeNs gap_ns = t_ns - past.t_ns;
    if (past.arrived_ns != 0) {
      past.gap_ns += past.gap_ns == 0
                         ? gap_ns
                         : std::llround(kLearn * static_cast<double>(gap_ns - past.gap_ns));
    }
    const bool same = past.arrived_ns != 0 && figures == past.figures;
    past.repeats = same ? past.repeats + 1 : 0;
    if (!same) past.p_RW = p_RW.value_or(past.p_RW);
    past.figures = figures;
    past.t_ns = t_ns;
    past.arrived_ns = now_ns;
  }
  if (IsStale(past, now_ns)) return Stop::kSourceLost;
  const double moved_m = p_RW ? (*p_RW - past.p_RW).norm() : 0.0;
  const bool should_differ = moved_m > std::max(kMoved_m, kDeviations * p_RW_sd_m);
  if (past.repeats >= kRepeats && should_differ) return Stop::kStaleTip;
  repeats_ = repeats_ || (past.repeats > 0 && should_differ);
  return Stop::kNone;
}

void SampleScreen::Screen(TimeNs t_ns, const std::optional<Eigen::Vector3d>& p_RW_sent,
                          SensorReadings& readings, Supervision& found) {
  has_news_ = repeats_ = false;
  std::optional<Eigen::Vector3d> p_RW;
  double p_RW_sd_m = 0.0;
  if (readings.wrist) {
    const WristMeasurement& wrist = readings.wrist->value;
    Figures figures = Figures::Zero();
    figures.head<3>() = wrist.p_RW;
    const bool finite = wrist.p_RW.allFinite() && (!wrist.R_RW || wrist.R_RW->allFinite()) &&
                        wrist.position_noise_m >= 0.0 && std::isfinite(wrist.position_noise_m);
    Stop stop = Look(wrist_, t_ns, readings.wrist->t_ns, figures, finite, p_RW_sent,
                     wrist.position_noise_m);
    if (stop == Stop::kStaleTip || stop == Stop::kSourceLost) stop = Stop::kStaleWrist;
    if (stop == Stop::kNone) {
      p_RW = wrist.p_RW;
      p_RW_sd_m = wrist.position_noise_m;
    } else {
      found.stop = stop;
      found.reaction = Reaction::kHold;
      if (!finite) readings.wrist.reset();
    }
  }
  const auto screen = [&](auto& sample, Past& past, VotedSensor sensor, const Figures& figures,
                          bool finite) {
    if (Look(past, t_ns, sample->t_ns, figures, finite, p_RW, p_RW_sd_m) == Stop::kNone) return;
    sample.reset();
    Out(sensor, found);
  };
  const auto screen_em = [&](std::optional<Sample<EmMeasurement>>& em, Past& past,
                             VotedSensor sensor) {
    if (!em) return;
    Figures figures;
    figures << em->value.T_RS.p, em->value.T_RS.R.col(0);
    screen(em, past, sensor, figures, figures.allFinite() && em->value.T_RS.R.allFinite());
  };
  screen_em(readings.em0, em0_past_, VotedSensor::kEm);
  screen_em(readings.em1, em1_past_, VotedSensor::kPortDirection);
  if (readings.strain) {
    Figures figures = Figures::Zero();
    figures.head<4>() = readings.strain->value.moments_Nm;
    screen(readings.strain, strain_past_, VotedSensor::kStrain, figures, figures.allFinite());
  }
  if (readings.load) {
    Figures figures = Figures::Zero();
    figures.head<3>() = readings.load->value.f_tip_N;
    screen(readings.load, load_past_, VotedSensor::kLoad, figures, figures.allFinite());
  }
  if (repeats_) found.doubt = Stop::kSourceLost;
}

void SampleScreen::ScreenTip(TimeNs t_ns, std::optional<Sample<TipMeasurement>>& tip,
                             const std::optional<Eigen::Vector3d>& p_RW, Supervision& found) {
  if (!tip || tip->value.tip.status == TipStatus::kLost) return;
  const TipObservation& seen = tip->value.tip;
  Figures figures = Figures::Zero();
  figures.head<3>() = seen.p_RE;
  if (seen.d_RE) figures.tail<3>() = *seen.d_RE;
  const bool finite = figures.allFinite() && seen.covariance_m2.allFinite();
  repeats_ = false;
  const Stop stop = Look(tip_past_, t_ns, tip->t_ns, figures, finite, p_RW, 0.0);
  if (repeats_) found.doubt = Stop::kStaleTip;
  if (stop == Stop::kNone) return;
  tip.reset();
  Out(VotedSensor::kTip, found);
}

/// The place of the straight shaft through the port.
Eigen::Vector3d SampleScreen::Straight(const Eigen::Vector3d& p_RW,
                                       double distance_from_tip_m) const {
  const Eigen::Vector3d to_port = p_RP_ - p_RW;
  const double before = to_port.norm();
  if (!(before > 0.0)) return p_RW;
  return p_RP_ + (length_m_ - distance_from_tip_m - before) / before * to_port;
}

bool SampleScreen::Jumps(const Place& last, const Place& now, double distance_from_tip_m,
                         double p_RW_sd_m) const {
  if (!last.known || now.t_ns <= last.t_ns) return false;
  const Eigen::Vector3d free =
      Straight(now.p_RW, distance_from_tip_m) - Straight(last.p_RW, distance_from_tip_m);
  const double before = std::max((p_RP_ - now.p_RW).norm(), 0.02 * length_m_);
  const double lever = std::max(1.0, (length_m_ - before) / before);
  const double noise_m = std::sqrt(last.sd_m * last.sd_m + now.sd_m * now.sd_m +
                                   2.0 * lever * lever * p_RW_sd_m * p_RW_sd_m);
  const double allowed_m = 0.5 * kBentMore * free.norm() + kDeviations * noise_m +
                           kTissueSpeed_m_s * std::min(kTissue_s, Seconds(now.t_ns - last.t_ns));
  return (now.p - last.p - 0.5 * free).norm() > allowed_m;
}

namespace {

/// The wrist at the time of a sample.
std::optional<Eigen::Vector3d> WristOf(TimeNs t_ns, const SensorReadings& readings,
                                       const LateSamples& late) {
  const auto past = late.PastAt(t_ns, readings);
  if (past && past->wrist) return past->wrist->value.p_RW;
  if (readings.wrist) return readings.wrist->value.p_RW;
  return {};
}

double WristSd(const SensorReadings& readings) {
  return readings.wrist ? readings.wrist->value.position_noise_m : 0.0;
}

}  // namespace

bool SampleScreen::TipJumps(const SensorReadings& readings, const LateSamples& late) {
  if (!readings.tip || readings.tip->value.tip.status == TipStatus::kLost) return false;
  const auto p_RW = WristOf(readings.tip->t_ns, readings, late);
  if (!p_RW) return false;
  const TipObservation& tip = readings.tip->value.tip;
  return Jumps(tip_, {true, tip.p_RE, *p_RW, readings.tip->t_ns, Sd(tip.covariance_m2)}, 0.0,
               WristSd(readings));
}

bool SampleScreen::EmJumps(const SensorReadings& readings, const LateSamples& late) {
  if (!readings.em0) return false;
  const auto p_RW = WristOf(readings.em0->t_ns, readings, late);
  if (!p_RW) return false;
  const EmMeasurement& em = readings.em0->value;
  return Jumps(em_, {true, em.T_RS.p, *p_RW, readings.em0->t_ns, em.position_noise_m},
               em.distance_from_tip_m, WristSd(readings));
}

bool SampleScreen::TipIsFarther(double distance_m, const SensorReadings& readings) const {
  if (!tip_.known || !readings.tip || readings.tip->value.tip.status == TipStatus::kLost)
    return false;
  // Not a number is far, too.
  return !((readings.tip->value.tip.p_RE - tip_.p).norm() <= distance_m);
}

void SampleScreen::BelieveTip(const SensorReadings& readings, const LateSamples& late) {
  if (!readings.tip || readings.tip->value.tip.status == TipStatus::kLost) return;
  const auto p_RW = WristOf(readings.tip->t_ns, readings, late);
  if (!p_RW) return;
  const TipObservation& tip = readings.tip->value.tip;
  tip_ = {true, tip.p_RE, *p_RW, readings.tip->t_ns, Sd(tip.covariance_m2)};
}

void SampleScreen::BelieveEm(const SensorReadings& readings, const LateSamples& late) {
  if (!readings.em0) return;
  const auto p_RW = WristOf(readings.em0->t_ns, readings, late);
  if (!p_RW) return;
  const EmMeasurement& em = readings.em0->value;
  em_ = {true, em.T_RS.p, *p_RW, readings.em0->t_ns, em.position_noise_m};
}

}  // namespace flextip
