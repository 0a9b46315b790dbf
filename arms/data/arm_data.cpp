#include "arms/data/arm_data.h"

#include <algorithm>
#include <cmath>

#include "arms/data/smooth.h"
#include "arms/model/dynamics.h"
#include "core/error.h"

namespace flextip::arms {
namespace {

constexpr double kStopsBelow_hz = 5.0;  // rows rarer than this are stops
constexpr double kSameTime_s = 1e-3;
constexpr double kStart_s = 0.5;
constexpr Eigen::Index kFewestRows = 20;  // fewer show nothing, which is no verdict

double Seconds(TimeNs t_ns, TimeNs start_ns) { return 1e-9 * double(t_ns - start_ns); }

Track TrackOf(const Series<Eigen::VectorXd>& series, TimeNs start_ns) {
  Track track;
  const auto rows = Eigen::Index(series.size());
  track.t_s.resize(rows);
  track.values.resize(rows, series.front().value.size());
  for (Eigen::Index k = 0; k < rows; ++k) {
    track.t_s[k] = Seconds(series[k].t_ns, start_ns);
    track.values.row(k) = series[k].value.transpose();
  }
  return track;
}

double MedianStep(const Eigen::VectorXd& t_s) {
  std::vector<double> steps;
  for (Eigen::Index k = 1; k < t_s.size(); ++k) steps.push_back(t_s[k] - t_s[k - 1]);
  if (steps.empty()) return 1.0;
  std::nth_element(steps.begin(), steps.begin() + std::ptrdiff_t(steps.size() / 2), steps.end());
  return steps[steps.size() / 2];
}

/// Keeps the rows that fall on the time line, with their place on it. At stops a row belongs to the
/// stop that it names.
Measured PutOn(const Eigen::VectorXd& line, Track track, bool stops) {
  Measured measured;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < track.Rows(); ++k) {
    const double t = track.t_s[k];
    const auto after = std::upper_bound(line.begin(), line.end(), t);
    auto row = Eigen::Index(after - line.begin()) - 1;
    if (stops) {
      if (row + 1 < line.size() && (row < 0 || line[row + 1] - t < t - line[row])) ++row;
      if (row < 0 || std::abs(line[row] - t) > 0.3) continue;
      kept.push_back(k);
      measured.where.push_back({row, 0.0});
      continue;
    }
    if (row < 0) {
      if (line[0] - t > kSameTime_s) continue;
      row = 0;
    }
    if (row + 1 >= line.size()) {
      if (t - line[line.size() - 1] > kSameTime_s) continue;
      kept.push_back(k);
      measured.where.push_back({line.size() - 1, 0.0});
      continue;
    }
    kept.push_back(k);
    const double fraction = std::clamp((t - line[row]) / (line[row + 1] - line[row]), 0.0, 1.0);
    measured.where.push_back({row, fraction});
  }
  measured.track.t_s = track.t_s(kept);
  measured.track.values = track.values(kept, Eigen::all);
  return measured;
}

/// Without the first moments of a recording, in which what a servo does hangs on what was before.
Track WithoutStart(const Track& track) {
  const double start = track.t_s[0], end = track.t_s[track.Rows() - 1];
  const double from = start + std::min(kStart_s, 0.1 * (end - start));
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < track.Rows(); ++k)
    if (track.t_s[k] >= from) kept.push_back(k);
  return {track.t_s(kept), track.values(kept, Eigen::all)};
}

Track PoseTrack(const Series<PoseSample>& samples, TimeNs start_ns, bool& has_orientation) {
  Track track;
  track.t_s.resize(Eigen::Index(samples.size()));
  track.values.setConstant(Eigen::Index(samples.size()), 7, std::nan(""));
  has_orientation = false;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const auto row = Eigen::Index(k);
    track.t_s[row] = Seconds(samples[k].t_ns, start_ns);
    track.values.row(row).head<3>() = samples[k].value.p_RK.transpose();
    if (!samples[k].value.q_RK) continue;
    has_orientation = true;
    const Eigen::Quaterniond& q = *samples[k].value.q_RK;
    track.values.row(row).tail<4>() << q.w(), q.x(), q.y(), q.z();
  }
  return track;
}

Eigen::VectorXd VectorOf(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), Eigen::Index(values.size()));
}

TimeNs StartOf(const Recording& recording) {
  return recording.joints0 ? recording.joints0->q.front().t_ns
                           : recording.joints_command0->q.front().t_ns;
}

/// Efforts at rows of joints: as measured, else what gravity asks where masses are stated.
Eigen::MatrixXd EffortsAt(const ArmData& data, const Track& joints, std::vector<bool>& known) {
  const int n = data.Size();
  Eigen::MatrixXd efforts = Eigen::MatrixXd::Zero(joints.Rows(), n);
  known.assign(n, false);
  if (data.torque.Any()) {
    const Eigen::Index measured = data.torque.track.values.cols();
    for (Eigen::Index i = 0; i < measured; ++i) known[i] = true;
    const auto on = PutOn(data.torque.track.t_s, joints, false);
    std::size_t at = 0;
    for (Eigen::Index k = 0; k < joints.Rows(); ++k) {
      while (at + 1 < on.where.size() && on.track.t_s[Eigen::Index(at)] < joints.t_s[k]) ++at;
      if (!on.where.empty())
        efforts.row(k).head(measured) = At(data.torque.track.values, on.where[at]);
    }
    return efforts;
  }
  if (data.arm.links.empty()) return efforts;
  known.assign(n, true);
  Eigen::VectorXd numbers(kLinkNumbers * n);
  for (int i = 0; i < n; ++i)
    numbers.segment(kLinkNumbers * i, kLinkNumbers) = NumbersOf(data.arm.links[i]);
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < joints.Rows(); ++k) {
    const Motion motion{joints.values.row(k).transpose(), still, still};
    efforts.row(k) =
        (EffortRegressor(data.nominal, motion, data.gravity_m_s2) * numbers).transpose();
  }
  return efforts;
}

}  // namespace

Eigen::RowVectorXd At(const Eigen::MatrixXd& values, const Where& where) {
  if (where.fraction == 0.0) return values.row(where.row);
  return (1.0 - where.fraction) * values.row(where.row) +
         where.fraction * values.row(where.row + 1);
}

double At(const Eigen::VectorXd& values, const Where& where) {
  const double value = values[where.row];
  return where.fraction > 0.0 ? value + where.fraction * (values[where.row + 1] - value) : value;
}

ArmData::ArmData(const Recording& recording, std::string recording_name)
    : name(std::move(recording_name)),
      arm(*recording.arm),
      nominal(arm),
      gravity_m_s2(recording.gravity_m_s2),
      tolerances(recording.tolerances) {
  const TimeNs start_ns = StartOf(recording);
  std::vector<PayloadPlace> centres;  // where no place is named, at the links' own
  for (int i = 0; arm.payload_places.empty() && i < int(arm.links.size()); ++i)
    centres.push_back({fmt::format("link_{}", i + 1), i + 1, arm.links[i].com_m});
  if (arm.payload_places.empty()) arm.payload_places = std::move(centres);
  has_encoders = recording.joints0.has_value();
  has_command = recording.joints_command0.has_value();
  if (has_command) command = TrackOf(recording.joints_command0->q, start_ns);
  joints = has_encoders ? TrackOf(recording.joints0->q, start_ns) : command;
  if (joints.Rows() < kFewestRows) {
    throw InputError::At(name, 0,
                         fmt::format("{} rows of joints, at least {} are needed to judge",
                                     joints.Rows(), kFewestRows));
  }
  at_stops = 1.0 / MedianStep(joints.t_s) < kStopsBelow_hz;
  if (has_encoders && has_command && !at_stops) {
    followed = PutOn(command.t_s, WithoutStart(joints), false);
    followed.noise = VectorOf(recording.joints0->noise);
  }
  if (recording.joints_seen0) {
    seen = PutOn(joints.t_s, TrackOf(recording.joints_seen0->q, start_ns), at_stops);
    seen.noise = VectorOf(recording.joints_seen0->noise);
  }
  if (recording.pose0) {
    pose =
        PutOn(joints.t_s, PoseTrack(recording.pose0->samples, start_ns, has_orientation), at_stops);
    pose.noise.resize(6);
    pose.noise.head<3>().setConstant(recording.pose0->position_noise_m);
    pose.noise.tail<3>().setConstant(recording.pose0->orientation_noise_rad);
    registration_m = recording.pose0->registration_noise_m;
    registration_rad = recording.pose0->registration_noise_rad;
  }
  if (recording.torque0) {
    torque = PutOn(joints.t_s, TrackOf(recording.torque0->tau, start_ns), at_stops);
    torque.noise = VectorOf(recording.torque0->noise);
  }
  smooth = joints.values;
  if (!at_stops) SmoothRates(joints, smooth, rate, acceleration);
  if (rate.size() == 0) {
    rate.setZero(joints.Rows(), Size());
    acceleration.setZero(joints.Rows(), Size());
  }
  effort_at_joints = EffortsAt(*this, joints, effort_known);
  if (has_command) effort_at_command = EffortsAt(*this, command, effort_known);
}

void ArmData::RequireJudged() const {
  if (CanBeJudged()) return;
  throw InputError::At(name, 0,
                       "nothing was measured beside the joints, or at other times: expected "
                       "joints_command0, joints_seen0, pose0 or torque0 at the joints' times");
}

}  // namespace flextip::arms
