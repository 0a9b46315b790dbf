#include "calibration/clock/motion.h"

#include <algorithm>

#include "core/linear_algebra.h"
#include "core/median.h"

namespace flextip {
namespace {

template <class T>
Motion Begin(const std::string& stream, const std::string& quantity, const Series<T>& samples,
             TimeNs epoch_ns, int rows) {
  Motion motion{.stream = stream, .quantity = quantity};
  motion.values.resize(rows, static_cast<Eigen::Index>(samples.size()));
  for (const auto& sample : samples) {
    motion.t_s.push_back(1e-9 * static_cast<double>(sample.t_ns - epoch_ns));
  }
  return motion;
}

/// Wrist and straight shaft: a point anywhere on the shaft is linear in both.
Motion WristMotion(const Recording& recording, TimeNs epoch_ns) {
  const auto& samples = recording.wrist0->samples;
  Motion motion = Begin("wrist0", "tip of the straight shaft", samples, epoch_ns, 6);
  motion.port = WristPort{recording.p_RP, recording.instrument.length_m};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Eigen::Vector3d& p_RW = samples[i].value.p_RW;
    const Eigen::Vector3d along = recording.p_RP - p_RW;
    const double length = along.norm();
    const Eigen::Vector3d tip =
        length > 0.0 ? Eigen::Vector3d(p_RW + recording.instrument.length_m / length * along)
                     : p_RW;
    motion.values.col(static_cast<Eigen::Index>(i)) << tip, p_RW;
  }
  return motion;
}

/// Position and axes: any point fixed to the sensor is linear in both.
Motion EmMotion(const EmStream& em, TimeNs epoch_ns) {
  Motion motion = Begin("em0", "sensor position", em.samples, epoch_ns, 12);
  for (std::size_t i = 0; i < em.samples.size(); ++i) {
    const Eigen::Matrix3d R_RS = em.samples[i].value.q_RS.toRotationMatrix();
    motion.values.col(static_cast<Eigen::Index>(i)) << em.samples[i].value.p_RS, R_RS.reshaped();
  }
  return motion;
}

Motion VisionMotion(const VisionStream& vision, TimeNs epoch_ns) {
  Series<TipObservation> seen;
  for (const auto& tip : vision.tips) {
    if (tip.value.status == TipStatus::kOk) seen.push_back(tip);
  }
  Motion motion = Begin("vision0", "tip as seen", seen, epoch_ns, 3);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    motion.values.col(static_cast<Eigen::Index>(i)) = seen[i].value.p_RE;
    const Llt noise(seen[i].value.covariance_m2);
    if (!noise.Succeeded()) continue;
    motion.whitening.emplace_back(noise.SolveL(Eigen::Matrix3d::Identity()));
  }
  if (motion.whitening.size() != seen.size()) motion.whitening.clear();
  return motion;
}

template <int N>
Motion Plain(const std::string& stream, const std::string& quantity,
             const Series<Eigen::Matrix<double, N, 1>>& samples, TimeNs epoch_ns) {
  Motion motion = Begin(stream, quantity, samples, epoch_ns, N);
  motion.own_rows = N;
  motion.is_force = true;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    motion.values.col(static_cast<Eigen::Index>(i)) = samples[i].value;
  }
  return motion;
}

}  // namespace

double Motion::PeriodSeconds() const {
  std::vector<double> steps;
  for (std::size_t i = 1; i < t_s.size(); ++i) steps.push_back(t_s[i] - t_s[i - 1]);
  return steps.empty() ? 0.0 : Median(steps);
}

const Motion* Motions::Find(const std::string& stream) const {
  const auto it = std::find_if(streams.begin(), streams.end(),
                               [&](const Motion& m) { return m.stream == stream; });
  return it == streams.end() ? nullptr : &*it;
}

std::string Motions::Names() const {
  std::string names;
  for (const Motion& m : streams) names += (names.empty() ? "" : ", ") + m.stream;
  return names;
}

Motions MotionsOf(const Recording& r) {
  Motions motions;
  const auto begin_at = [&](const auto& samples) {
    if (motions.epoch_ns == 0 && !samples.empty()) motions.epoch_ns = samples.front().t_ns;
  };
  if (r.wrist0) begin_at(r.wrist0->samples);
  if (r.em0) begin_at(r.em0->samples);
  if (r.vision0) begin_at(r.vision0->tips);
  const TimeNs epoch_ns = motions.epoch_ns;
  auto& list = motions.streams;
  if (r.wrist0) list.push_back(WristMotion(r, epoch_ns));
  if (r.em0) list.push_back(EmMotion(*r.em0, epoch_ns));
  if (r.vision0) list.push_back(VisionMotion(*r.vision0, epoch_ns));
  if (r.load0) list.push_back(Plain<3>("load0", "force on the tip", r.load0->f_tip_N, epoch_ns));
  if (r.strain0) {
    list.push_back(Plain<4>("strain0", "bending moments", r.strain0->moments_Nm, epoch_ns));
  }
  return motions;
}

}  // namespace flextip
