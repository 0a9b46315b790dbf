#include "calibration/shaft/known_loads.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rotation.h"
#include "recording/resample.h"

namespace flextip {
namespace {

constexpr double kStill_m = 1e-4, kStillNoises = 6.0;

/// One hold while its samples come in.
class HoldSum {
 public:
  HoldSum(const Recording& recording, TimeNs t_ns, const Eigen::Vector3d& f, const WristSample& w)
      : recording_(recording), f_(f), first_(w), first_ns_(t_ns) {}

  bool Fits(const Eigen::Vector3d& f, const WristSample& w) const {
    const double still = std::max(kStill_m, kStillNoises * recording_.wrist0->position_noise_m);
    return f == f_ && (w.p_RW - first_.p_RW).norm() < still &&
           w.q_RW.has_value() == first_.q_RW.has_value();
  }
  void Add(TimeNs t_ns, const WristSample& w);
  LoadHold Mean() const;

 private:
  void AddSensors(TimeNs t_ns);
  void AddMeanTip(LoadHold& hold) const;

  const Recording& recording_;
  Eigen::Vector3d f_;
  WristSample first_;
  TimeNs first_ns_, last_ns_ = 0;
  int n_ = 0;
  Eigen::Vector3d p_RW_ = Eigen::Vector3d::Zero();
  Eigen::Vector4d q_RW_ = Eigen::Vector4d::Zero();
  std::vector<Eigen::Vector4d> readings_;
  std::vector<TipObservation> tips_;
  std::vector<EmSample> em_;
};

Eigen::Vector4d SameSide(const Eigen::Quaterniond& q, const Eigen::Quaterniond& as) {
  return q.dot(as) < 0 ? Eigen::Vector4d(-q.coeffs()) : Eigen::Vector4d(q.coeffs());
}

void HoldSum::Add(TimeNs t_ns, const WristSample& w) {
  last_ns_ = t_ns;
  ++n_;
  p_RW_ += w.p_RW;
  if (w.q_RW) q_RW_ += SameSide(*w.q_RW, *first_.q_RW);
  AddSensors(t_ns);
}

void HoldSum::AddSensors(TimeNs t_ns) {
  if (recording_.strain0) {
    if (const auto reading = StrainAt(*recording_.strain0, t_ns)) readings_.push_back(*reading);
  }
  if (recording_.vision0) {
    const auto tip = TipAt(*recording_.vision0, t_ns);
    if (tip && tip->value.status == TipStatus::kOk && tip->t_ns == t_ns) {
      tips_.push_back(tip->value);
    }
  }
  if (recording_.em0) {
    if (const auto sample = EmAt(*recording_.em0, t_ns)) em_.push_back(*sample);
  }
}

void HoldSum::AddMeanTip(LoadHold& hold) const {
  if (tips_.empty()) return;
  const double n = static_cast<double>(tips_.size());
  Eigen::Vector3d p = Eigen::Vector3d::Zero(), d = Eigen::Vector3d::Zero();
  double directions = 0;
  for (const TipObservation& tip : tips_) {
    p += tip.p_RE / n;
    hold.p_RE_covariance_m2 += tip.covariance_m2 / (n * n);
    if (!tip.d_RE) continue;
    d += *tip.d_RE;
    ++directions;
  }
  hold.p_RE = p;
  if (directions == 0) return;
  hold.d_RE = d.normalized();
  hold.direction_noise_rad = recording_.vision0->direction_noise_rad / std::sqrt(directions);
}

LoadHold HoldSum::Mean() const {
  LoadHold hold;
  hold.first_ns = first_ns_;
  hold.last_ns = last_ns_;
  hold.samples = n_;
  hold.f_tip_N = f_;
  hold.force_noise_N = recording_.load0->force_noise_N;
  hold.p_RW = p_RW_ / n_;
  hold.wrist_noise_m = recording_.wrist0->position_noise_m / std::sqrt(n_);
  if (first_.q_RW) {
    hold.R_RW = Eigen::Quaterniond(q_RW_).normalized().toRotationMatrix();
    hold.wrist_turn_noise_rad = recording_.wrist0->orientation_noise_rad / std::sqrt(n_);
  }
  if (static_cast<int>(readings_.size()) == n_) {
    Eigen::Vector4d mean = Eigen::Vector4d::Zero();
    for (const auto& r : readings_) mean += r / n_;
    for (const auto& r : readings_) hold.reading_squares += (r - mean).cwiseAbs2();
    hold.readings = mean;
  }
  AddMeanTip(hold);
  if (!em_.empty()) {
    const double n = static_cast<double>(em_.size());
    Pose T;
    T.p.setZero();
    Eigen::Vector4d q = Eigen::Vector4d::Zero();
    for (const EmSample& s : em_) {
      T.p += s.p_RS / n;
      q += SameSide(s.q_RS, em_[0].q_RS);
    }
    T.R = Eigen::Quaterniond(q).normalized().toRotationMatrix();
    hold.T_RS = T;
    hold.em_noise_m = recording_.em0->position_noise_m / std::sqrt(n);
    hold.em_turn_noise_rad = recording_.em0->orientation_noise_rad / std::sqrt(n);
  }
  return hold;
}

std::vector<TimeNs> ClockTimes(const Recording& recording, LoadClock clock) {
  if (clock == LoadClock::kStrain) return TimesOf(recording.strain0->moments_Nm);
  if (clock == LoadClock::kVision) return TimesOf(recording.vision0->tips);
  return TimesOf(recording.em0->samples);
}

}  // namespace

std::vector<LoadHold> LoadHolds(const Recording& recording, LoadClock clock, std::size_t most) {
  std::vector<LoadHold> holds;
  std::optional<HoldSum> open;
  for (const TimeNs t_ns : ClockTimes(recording, clock)) {
    const auto f = LoadAt(*recording.load0, t_ns);
    const auto w = WristAt(*recording.wrist0, t_ns);
    if (!f || !w) continue;
    if (open && !open->Fits(*f, *w)) {
      holds.push_back(open->Mean());
      open.reset();
    }
    if (!open) open.emplace(recording, t_ns, *f, *w);
    open->Add(t_ns, *w);
  }
  if (open) holds.push_back(open->Mean());
  const std::size_t every = (holds.size() + most - 1) / std::max<std::size_t>(most, 1);
  if (every <= 1) return holds;
  std::vector<LoadHold> thinned;
  for (std::size_t i = 0; i < holds.size(); i += every) thinned.push_back(holds[i]);
  return thinned;
}

std::string SpanOf(const LoadHold& hold, TimeNs start_ns) {
  const auto seconds = [&](TimeNs t_ns) { return 1e-9 * static_cast<double>(t_ns - start_ns); };
  if (hold.samples == 1) return fmt::format("at {:.2f} s", seconds(hold.first_ns));
  return fmt::format("{:.2f} to {:.2f} s", seconds(hold.first_ns), seconds(hold.last_ns));
}

}  // namespace flextip
