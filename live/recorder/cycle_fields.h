// The fields of a cycle's row, in their order, gone through in three ways: their names, writing,
// reading. Private to the recorder.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "live/recorder/cycle_record.h"
#include "recording/text/csv.h"

namespace flextip::live::fields {

// While `skips`, a field is left empty.

struct Names {
  std::vector<std::string> names;
  bool skips = false;

  template <class T>
  bool Begin(const std::optional<Arrived<T>>&, const std::optional<Arrived<T>>&) const {
    return true;
  }
  void Integer(const std::string& name, std::int64_t&) { names.push_back(name); }
  void Number(const std::string& name, double&) { names.push_back(name); }
  bool IsThere(bool) const { return true; }
};

struct Writing {
  CsvWriter& csv;
  bool skips = false;

  template <class T>
  bool Begin(const std::optional<Arrived<T>>& now, const std::optional<Arrived<T>>& before) const {
    return now && (!before || before->t_ns != now->t_ns || before->arrived_ns != now->arrived_ns);
  }
  void Integer(const std::string&, std::int64_t& value) {
    if (skips) {
      csv.AddEmpty();
    } else {
      csv.Add(TimeNs(value));
    }
  }
  void Number(const std::string&, double& value) {
    csv.AddOrEmpty(skips ? std::numeric_limits<double>::quiet_NaN() : value);
  }
  bool IsThere(bool there) const { return there; }
};

struct Reading {
  const CsvReader& csv;
  std::size_t column = 0;
  bool skips = false;

  template <class T>
  bool Begin(const std::optional<Arrived<T>>&, const std::optional<Arrived<T>>&) const {
    return !csv.Empty(column);
  }
  void Integer(const std::string&, std::int64_t& value) {
    if (!skips) value = csv.Integer(column);
    ++column;
  }
  void Number(const std::string&, double& value) {
    if (!skips) {
      value = csv.Empty(column) ? std::numeric_limits<double>::quiet_NaN() : csv.Number(column);
    }
    ++column;
  }
  /// A value that may be absent is where its first field is empty.
  bool IsThere(bool) const { return !skips && !csv.Empty(column); }
};

template <class Io, class Enum>
void VisitEnum(Io& io, const std::string& name, Enum& value) {
  auto number = static_cast<std::int64_t>(value);
  io.Integer(name, number);
  value = static_cast<Enum>(number);
}

template <class Io>
void VisitFlag(Io& io, const std::string& name, bool& flag) {
  std::int64_t number = flag ? 1 : 0;
  io.Integer(name, number);
  flag = number != 0;
}

template <class Io, class V>
void VisitVector(Io& io, const std::string& name, V& v) {
  for (int i = 0; i < v.size(); ++i) io.Number(name + "_" + std::to_string(i), v(i));
}

/// Goes through a value that may be absent, with `visit(value)`.
template <class Io, class T, class Visit>
void VisitOptional(Io& io, std::optional<T>& value, const T& empty, Visit visit) {
  const bool was_skipping = io.skips;
  const bool there = io.IsThere(value.has_value());
  T local = value.value_or(empty);
  io.skips = was_skipping || !there;
  visit(local);
  io.skips = was_skipping;
  value.reset();
  if (there && !was_skipping) value = local;
}

template <class Io>
void VisitValue(Io& io, const std::string& name, Eigen::Quaterniond& q) {
  Eigen::Vector4d wxyz(q.w(), q.x(), q.y(), q.z());
  VisitVector(io, name, wxyz);
  q = Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
}
template <class Io>
void VisitValue(Io& io, const std::string& name, WristSample& wrist) {
  VisitVector(io, name + " p_RW", wrist.p_RW);
  VisitOptional(io, wrist.q_RW, Eigen::Quaterniond(1, 0, 0, 0),
                [&](Eigen::Quaterniond& q) { VisitValue(io, name + " q_RW", q); });
}
template <class Io>
void VisitValue(Io& io, const std::string& name, SeenTip& seen) {
  VisitEnum(io, name + " status", seen.tip.status);
  VisitVector(io, name + " p_RE", seen.tip.p_RE);
  for (int i = 0; i < 9; ++i)
    io.Number(name + " cov_" + std::to_string(i), seen.tip.covariance_m2(i / 3, i % 3));
  VisitOptional(io, seen.tip.d_RE, Eigen::Vector3d(1, 0, 0),
                [&](Eigen::Vector3d& d) { VisitVector(io, name + " d_RE", d); });
  io.Number(name + " direction_noise", seen.direction_noise_rad);
}
template <class Io>
void VisitValue(Io& io, const std::string& name, EmSample& em) {
  VisitVector(io, name + " p_RS", em.p_RS);
  VisitValue(io, name + " q_RS", em.q_RS);
}
template <class Io>
void VisitValue(Io& io, const std::string& name, GoalSample& goal) {
  VisitVector(io, name + " p_RE", goal.p_RE);
}
template <class Io>
void VisitValue(Io& io, const std::string& name, Eigen::Vector4d& moments) {
  VisitVector(io, name + " m", moments);
}
template <class Io>
void VisitValue(Io& io, const std::string& name, Eigen::Vector3d& force) {
  VisitVector(io, name + " f", force);
}
template <class Io>
void VisitValue(Io& io, const std::string& name, CrtkOperatingState& state) {
  VisitEnum(io, name, state.state);
  VisitFlag(io, name + " homed", state.is_homed);
  VisitFlag(io, name + " busy", state.is_busy);
}

/// A stream's sample, which stays that of the cycle before where it is not new.
template <class Io, class T>
void VisitStream(Io& io, const std::string& name, std::optional<Arrived<T>>& now,
                 const std::optional<Arrived<T>>& before) {
  const bool is_new = io.Begin(now, before);
  Arrived<T> sample = now.value_or(Arrived<T>{});
  io.skips = !is_new;
  io.Integer(name + " t [ns]", sample.t_ns);
  io.Integer(name + " arrived [ns]", sample.arrived_ns);
  VisitValue(io, name, sample.value);
  io.skips = false;
  now = before;
  if (is_new) now = sample;
}

template <class Io>
void VisitSupervision(Io& io, Supervision& found) {
  VisitEnum(io, "found stop", found.stop);
  VisitEnum(io, "found reaction", found.reaction);
  VisitEnum(io, "found out", found.voted_out);
  io.Number("found chi2", found.chi2);
  io.Number("found chi2_limit", found.chi2_limit);
  io.Number("found angle [rad]", found.worst_angle_rad);
}

inline constexpr const char* kLaterStream = "asked";
inline constexpr const char* kLaterFindings = "found";
inline constexpr const char* kLaterCause = "cause";

template <class Io>
void VisitSized(Io& io, const std::string& name, SizedCause& sized) {
  VisitEnum(io, name, sized.cause);
  io.Number(name + " value", sized.value);
  io.Number(name + " sd", sized.sd);
}

/// What the running diagnosis found; empty where nothing is.
template <class Io>
void VisitCause(Io& io, FoundCause& found) {
  std::optional<FoundCause> cause;
  if (found.IsThere()) cause = found;
  VisitOptional(io, cause, FoundCause{}, [&](FoundCause& c) {
    const std::string name = kLaterCause;
    VisitSized(io, name, c.likeliest);
    VisitSized(io, name + " or", c.other);
    VisitFlag(io, name + " or others", c.has_more);
    io.Number(name + " evidence", c.log_evidence);
    io.Integer(name + " found [ns]", c.found_ns);
    io.Integer(name + " since [ns]", c.since_ns);
  });
  found = cause.value_or(FoundCause{});
}

template <class Io>
void VisitRecord(Io& io, CycleRecord& record, const CycleRecord& before) {
  StreamInputs& streams = record.inputs.streams;
  const StreamInputs& last = before.inputs.streams;
  io.Integer("timestamp [ns]", record.inputs.t_ns);
  io.Integer("due [ns]", record.due_ns);
  io.Integer("woke [ns]", record.woke_ns);
  io.Integer("sent [ns]", record.sent_ns);
  VisitStream(io, "wrist0", streams.wrist, last.wrist);
  VisitStream(io, "vision0", streams.tip, last.tip);
  VisitStream(io, "em0", streams.em0, last.em0);
  VisitStream(io, "em1", streams.em1, last.em1);
  VisitStream(io, "strain0", streams.strain, last.strain);
  VisitStream(io, "load0", streams.load, last.load);
  VisitStream(io, "state", streams.state, last.state);
  VisitEnum(io, "lost", streams.lost);
  VisitFlag(io, "stop", record.inputs.stop);
  CycleOutputs& outputs = record.outputs;
  VisitEnum(io, "hold", outputs.hold);
  VisitEnum(io, "held_by", outputs.held_by);
  VisitEnum(io, "status", outputs.status);
  VisitFlag(io, "has_command", outputs.has_command);
  VisitVector(io, "command [m]", outputs.p_RW_command);
  VisitVector(io, "p_RE [m]", outputs.p_RE);
  VisitOptional(io, outputs.p_RE_goal, Eigen::Vector3d(0, 0, 0),
                [&](Eigen::Vector3d& p) { VisitVector(io, "goal [m]", p); });
  VisitFlag(io, "step_limited", outputs.step_limited);
  VisitFlag(io, "speed_limited", outputs.speed_limited);
  VisitFlag(io, "acceleration_limited", outputs.acceleration_limited);
  VisitFlag(io, "workspace_limited", outputs.workspace_limited);
  VisitFlag(io, "fixture_limited", outputs.fixture_limited);
  VisitOptional(io, outputs.state_command, CrtkCommand::kPause,
                [&](CrtkCommand& command) { VisitEnum(io, "state_command", command); });
  VisitFlag(io, "done", outputs.done);
  outputs.t_ns = record.inputs.t_ns;
  // Older recordings lack what follows.
  VisitStream(io, kLaterStream, streams.goal, last.goal);
  VisitOptional(io, outputs.supervision, Supervision(),
                [&](Supervision& found) { VisitSupervision(io, found); });
  VisitCause(io, outputs.cause);
}

}  // namespace flextip::live::fields
