#include "control/supervision/path_watch.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra/segment.h"

namespace flextip {
namespace {

constexpr TimeNs kStep_ns = 34'000'000;        // between those that are kept
constexpr TimeNs kAhead_ns = 250'000'000;      // of the way before the wish
constexpr TimeNs kSpan_ns = 120'000'000;       // some cycles, and less than a robot's lag
constexpr TimeNs kComesBack_ns = 500'000'000;  // two lags of a robot
constexpr TimeNs kTryAfter_ns = 1'000'000'000;
constexpr TimeNs kOtherwise_ns = 400'000'000;  // for a tip that moves otherwise
constexpr TimeNs kStepSpan_ns = 16'000'000;    // between steps that are kept
constexpr double kTimes = 2.0;                 // what it may be astray
constexpr double kNoise = 4.0;                 // deviations of a motion that is seen
// Of a motion that the wrist makes: tissue that is just touched takes less.
constexpr double kOtherPart = 0.77;
constexpr double kCertain = 2.0;            // deviations of the tip
constexpr double kAstray = 3.0;             // the same, for a hold: until then the wrist waits
constexpr double kRoom = 0.8;               // of what it may be astray, for where a step leads
constexpr double kModel = 0.3;              // of a motion may be otherwise than the model says
constexpr double kOtherMotion_m_s = 0.003;  // tissue, breath
constexpr TimeNs kGone_ns = 300'000'000;    // without a tip, and the filter begins again
constexpr double kSurprise = 25.0;          // of chi-squared

}  // namespace

void PathWatch::Note(TimeNs t_ns, const Eigen::Vector3d& p_wish) {
  // A wish that waits is no way: the tip may stand behind it as long as it waits.
  const Wish& newest = wishes_[(next_ + kSize - 1) % kSize];
  const bool is_due = count_ == 0 || (t_ns - newest.t_ns >= kStep_ns && p_wish != newest.p);
  if (!is_due) return;
  wishes_[next_] = {t_ns, p_wish};
  next_ = (next_ + 1) % kSize;
  count_ = std::min(count_ + 1, kSize);
}

/// Where the way goes on to: a tip that is ahead is not beside it.
Eigen::Vector3d PathWatch::Ahead(TimeNs t_ns, const Eigen::Vector3d& p_wish) const {
  if (count_ == 0) return p_wish;
  const Wish& newest = wishes_[(next_ + kSize - 1) % kSize];
  const double part = static_cast<double>(kAhead_ns) /
                      static_cast<double>(std::max<TimeNs>(t_ns - newest.t_ns, kStep_ns));
  return p_wish + part * (p_wish - newest.p);
}

/// The place of the way nearest to `p_RE`.
Eigen::Vector3d PathWatch::NearestOnWay(const Eigen::Vector3d& p_RE) const {
  Eigen::Vector3d nearest = NearestOnSegment(p_wish_, p_ahead_, p_RE), later = p_wish_;
  for (std::size_t i = 1; i <= count_; ++i) {
    const Wish& wish = wishes_[(next_ + kSize - i) % kSize];
    const Eigen::Vector3d place = NearestOnSegment(wish.p, later, p_RE);
    if ((p_RE - place).norm() < (p_RE - nearest).norm()) nearest = place;
    later = wish.p;
  }
  return nearest;
}

/// The tip by its motion and by what is seen. A surprise is believed at once: it is no noise.
void PathWatch::Follow(TimeNs t_ns, const PlaceKnown& seen, const Eigen::Vector3d& dp_RE) {
  const Step& last = steps_[(next_step_ + kSize - 1) % kSize];
  newest_ = {t_ns, seen,
             newest_.led + (dp_RE.allFinite() ? dp_RE : Eigen::Vector3d::Zero().eval())};
  if (steps_kept_ == 0 || t_ns - last.t_ns >= kStepSpan_ns) {
    steps_[next_step_] = newest_;
    next_step_ = (next_step_ + 1) % kSize;
    steps_kept_ = std::min(steps_kept_ + 1, kSize);
  }
  const bool known = tip_ns_ != 0 && t_ns - tip_ns_ < kGone_ns && dp_RE.allFinite();
  const double dt_s = 1e-9 * static_cast<double>(t_ns - tip_ns_);
  tip_ns_ = t_ns;
  if (!known) {
    tip_ = seen;
    return;
  }
  const double doubt_m = kModel * dp_RE.norm() + kOtherMotion_m_s * dt_s;
  tip_.p += dp_RE;
  tip_.covariance_m2.diagonal().array() += doubt_m * doubt_m;
  const Eigen::Vector3d innovation = seen.p - tip_.p;
  const Eigen::Matrix3d weight = (tip_.covariance_m2 + seen.covariance_m2).inverse();
  if (!(innovation.dot(weight * innovation) < kSurprise)) {
    tip_ = seen;
    return;
  }
  const Eigen::Matrix3d gain = tip_.covariance_m2 * weight;
  tip_.p += gain * innovation;
  const Eigen::Matrix3d left = tip_.covariance_m2 - gain * tip_.covariance_m2;
  tip_.covariance_m2 = 0.5 * (left + left.transpose());
}

bool PathWatch::IsAstray(TimeNs t_ns, const PlaceKnown& tip, const Eigen::Vector3d& dp_RE,
                         const Eigen::Vector3d& p_wish) {
  may_be_astray_ = false;
  if (max_deviation_m_ <= 0.0 || !tip.p.allFinite() || !tip.covariance_m2.allFinite() ||
      !p_wish.allFinite())
    return false;
  Follow(t_ns, tip, dp_RE);
  p_wish_ = p_wish;
  p_ahead_ = Ahead(t_ns, p_wish);
  const Eigen::Vector3d beside = tip_.p - NearestOnWay(tip_.p);
  Note(t_ns, p_wish);
  deviation_m_ = beside.norm();
  const double sd_m = std::sqrt(std::max(0.0, beside.dot(tip_.covariance_m2 * beside))) /
                      std::max(deviation_m_, 1e-9);
  if (span_ns_ == 0) nearest_m_.fill(deviation_m_);
  if (t_ns - span_ns_ > kSpan_ns) {
    nearest_m_ = {deviation_m_, nearest_m_[0], nearest_m_[1]};
    span_ns_ = t_ns;
  }
  nearest_m_[0] = std::min(nearest_m_[0], deviation_m_);
  const bool comes_back = from_ns_ != 0 && t_ns - from_ns_ < kComesBack_ns;
  const bool no_nearer =
      deviation_m_ > (comes_back ? from_m_ + kCertain * sd_m : nearest_m_[2] - kCertain * sd_m);
  may_be_astray_ = no_nearer && deviation_m_ > max_deviation_m_;
  if (deviation_m_ - kAstray * std::hypot(sd_m, tolerance_m_) <= max_deviation_m_) {
    astray_ns_ = 0;
    tried_ = false;
    return false;
  }
  if (no_nearer && astray_ns_ == 0) astray_ns_ = t_ns;
  return no_nearer;
}

bool PathWatch::MovesOtherwise(TimeNs t_ns) const {
  if (max_deviation_m_ <= 0.0) return false;
  for (std::size_t i = 1; i <= steps_kept_; ++i) {
    const Step& then = steps_[(next_step_ + kSize - i) % kSize];
    if (t_ns - then.t_ns > kOtherwise_ns) return false;
    const Eigen::Vector3d led = newest_.led - then.led;
    const Eigen::Vector3d beside = newest_.seen.p - then.seen.p - led;
    const double beside_m = beside.norm();
    if (beside_m <= kTimes * max_deviation_m_) continue;
    const Eigen::Matrix3d C = newest_.seen.covariance_m2 + then.seen.covariance_m2;
    const double sd_m = std::sqrt(std::max(0.0, beside.dot(C * beside))) / beside_m;
    if (beside_m > kNoise * sd_m + kOtherPart * led.norm()) return true;
  }
  return false;
}

Eigen::Vector3d PathWatch::Kept(const Eigen::Vector3d& before, const Eigen::Vector3d& step) const {
  const auto beside = [&](double part) {
    const Eigen::Vector3d p_RE = tip_.p + before + part * step;
    return Eigen::Vector3d(p_RE - NearestOnWay(p_RE));
  };
  const double room_m = std::max(kRoom * max_deviation_m_, beside(0.0).norm());
  for (double part = 1.0; part > 0.0; part -= 0.25)
    if (!(beside(part).norm() > room_m)) return part * step;
  const Eigen::Vector3d to = beside(1.0);
  return step - (1.0 - room_m / to.norm()) * to;
}

void PathWatch::TryOnce(TimeNs t_ns) {
  if (tried_ || astray_ns_ == 0 || t_ns - astray_ns_ < kTryAfter_ns) return;
  tried_ = true;
  ComeBack(t_ns);
}

void PathWatch::VisitState(StateText& state) {
  for (std::size_t* place : {&next_, &count_, &next_step_, &steps_kept_}) state(*place);
  if (next_ >= kSize || count_ > kSize || next_step_ >= kSize || steps_kept_ > kSize)
    throw InputError("saved state: no place in a ring");
  for (std::size_t i = 1; i <= count_; ++i) state(wishes_[(next_ + kSize - i) % kSize]);
  for (std::size_t i = 1; i <= steps_kept_; ++i) state(steps_[(next_step_ + kSize - i) % kSize]);
  state(newest_);
  state(tip_);
  state(p_wish_);
  state(p_ahead_);
  for (TimeNs* time : {&tip_ns_, &from_ns_, &astray_ns_, &span_ns_}) state(*time);
  state(tried_);
  state(may_be_astray_);
  state(deviation_m_);
  state(from_m_);
  state(nearest_m_);
}

}  // namespace flextip
