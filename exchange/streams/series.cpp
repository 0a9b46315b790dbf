#include "exchange/streams/series.h"

#include <cmath>
#include <optional>

#include "exchange/values/orientation.h"

namespace flextip::exchange {
namespace {

/// Rows as vectors and rotations.
class Samples {
 public:
  Samples(const StreamRows& rows, const StreamPlan& plan)
      : rows_(rows), kind_(plan.orientation), q_AW_(FrameAlong(plan.axis)) {}

  std::size_t size() const { return rows_.t_ns.size(); }
  TimeNs Time(std::size_t i) const { return rows_.t_ns[i]; }
  bool Has(const std::string& role) const { return rows_.values.contains(role); }
  bool Turns() const { return !kind_.empty() && Has(OrientationRoles(kind_).front()); }
  double Value(const std::string& role, std::size_t i) const { return rows_.values.at(role)[i]; }

  Eigen::Vector3d Vector(const std::string& before, std::size_t i) const {
    return {Value(before + "x", i), Value(before + "y", i), Value(before + "z", i)};
  }

  /// Empty where the stream or the row has none.
  std::optional<Eigen::Quaterniond> Orientation(std::size_t i) const {
    if (!Turns()) return {};
    std::vector<double> values;
    for (const auto& role : OrientationRoles(kind_)) values.push_back(Value(role, i));
    if (std::isnan(values.front())) return {};
    const OrientationRead read = OrientationOf(kind_, values);
    if (!read.problem.empty()) {
      throw InputError::At(rows_.source, rows_.places[i], read.problem);
    }
    if (!q_AW_) return read.q;
    return (read.q * *q_AW_).normalized();
  }

 private:
  const StreamRows& rows_;
  std::string kind_;
  std::optional<Eigen::Quaterniond> q_AW_;
};

void AddWrist(const Samples& rows, Recording& recording) {
  auto& samples = recording.wrist0.emplace().samples;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    samples.push_back({rows.Time(i), {rows.Vector("", i), rows.Orientation(i)}});
  }
}

void AddEm(const Samples& rows, std::optional<EmStream>& stream) {
  auto& samples = stream.emplace().samples;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Vector3d p_RS = rows.Has("x") ? rows.Vector("", i) : Eigen::Vector3d(0, 0, 0);
    samples.push_back({rows.Time(i), {p_RS, *rows.Orientation(i)}});
  }
}

Series<Eigen::Vector3d> Vectors(const Samples& rows, const std::string& before) {
  Series<Eigen::Vector3d> series;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    series.push_back({rows.Time(i), rows.Vector(before, i)});
  }
  return series;
}

void AddStrain(const Samples& rows, Recording& recording) {
  auto& moments = recording.strain0.emplace().moments_Nm;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    moments.push_back({rows.Time(i),
                       {rows.Value("m1_y", i), rows.Value("m1_z", i), rows.Value("m2_y", i),
                        rows.Value("m2_z", i)}});
  }
}

}  // namespace

void AddStream(const std::string& stream, const StreamRows& rows, StreamPlan& plan,
               Recording& recording, ImportLog& log) {
  const Samples samples(rows, plan);
  if (samples.Turns() && plan.axis.empty()) {
    plan.axis = "x";
    log.Assume(stream + ".axis", "x: the sensor's x axis points along the shaft toward the tip");
  }
  if (stream == "wrist0") AddWrist(samples, recording);
  if (stream == "command0") recording.command0.emplace().p_RW = Vectors(samples, "");
  if (stream == "em0") AddEm(samples, recording.em0);
  if (stream == "em1") AddEm(samples, recording.em1);
  if (stream == "strain0") AddStrain(samples, recording);
  if (stream == "load0") recording.load0.emplace().f_tip_N = Vectors(samples, "f");
  if (stream == "em1" && !samples.Has("x")) {
    log.Assume("em1.position", "0, 0, 0: the file has none, and only its orientation is used");
  }
}

}  // namespace flextip::exchange
