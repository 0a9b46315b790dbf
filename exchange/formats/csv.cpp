// Tables of other programs as streams.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "exchange/formats/formats.h"
#include "exchange/sensor_settings.h"
#include "exchange/tables/column_choice.h"
#include "exchange/tables/orientation.h"
#include "exchange/tables/stream_table.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

namespace fs = std::filesystem;

/// Rows with their plan, as vectors and rotations.
class StreamTable {
 public:
  StreamTable(const StreamPlan& plan, StreamRows rows) : plan_(plan), rows_(std::move(rows)) {}

  std::size_t size() const { return rows_.t_ns.size(); }
  TimeNs Time(std::size_t i) const { return rows_.t_ns[i]; }
  bool Has(const std::string& role) const { return rows_.values.contains(role); }
  double Value(const std::string& role, std::size_t i) const { return rows_.values.at(role)[i]; }

  Eigen::Vector3d Vector(const std::string& before, std::size_t i) const {
    return {Value(before + "x", i), Value(before + "y", i), Value(before + "z", i)};
  }

  /// Empty where the stream or the row has none. Throws where it is no rotation.
  std::optional<Eigen::Quaterniond> Orientation(std::size_t i) const {
    const auto& roles = OrientationRoles(plan_.orientation);
    if (plan_.orientation.empty() || !Has(roles.front())) return {};
    std::vector<double> values;
    for (const auto& role : roles) values.push_back(Value(role, i));
    if (std::isnan(values.front())) return {};
    const OrientationRead read = OrientationOf(plan_.orientation, values);
    if (!read.problem.empty()) {
      throw InputError::At(plan_.file.string(), rows_.lines[i], read.problem);
    }
    return read.q;
  }

 private:
  const StreamPlan& plan_;
  StreamRows rows_;
};

void TakeWrist(const StreamTable& table, Recording& recording) {
  auto& samples = recording.wrist0.emplace().samples;
  for (std::size_t i = 0; i < table.size(); ++i) {
    samples.push_back({table.Time(i), {table.Vector("", i), table.Orientation(i)}});
  }
}

void TakeEm(const StreamTable& table, std::optional<EmStream>& stream) {
  auto& samples = stream.emplace().samples;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Eigen::Vector3d p = table.Has("x") ? table.Vector("", i) : Eigen::Vector3d(0, 0, 0);
    samples.push_back({table.Time(i), {p, *table.Orientation(i)}});
  }
}

Series<Eigen::Vector3d> TakeVectors(const StreamTable& table, const std::string& before) {
  Series<Eigen::Vector3d> series;
  for (std::size_t i = 0; i < table.size(); ++i) {
    series.push_back({table.Time(i), table.Vector(before, i)});
  }
  return series;
}

void TakeStrain(const StreamTable& table, Recording& recording) {
  auto& moments = recording.strain0.emplace().moments_Nm;
  for (std::size_t i = 0; i < table.size(); ++i) {
    moments.push_back({table.Time(i),
                       {table.Value("m1_y", i), table.Value("m1_z", i), table.Value("m2_y", i),
                        table.Value("m2_z", i)}});
  }
}

void Take(const std::string& name, const StreamTable& table, Recording& recording) {
  if (name == "wrist0") TakeWrist(table, recording);
  if (name == "command0") recording.command0.emplace().p_RW = TakeVectors(table, "");
  if (name == "em0") TakeEm(table, recording.em0);
  if (name == "em1") TakeEm(table, recording.em1);
  if (name == "strain0") TakeStrain(table, recording);
  if (name == "load0") recording.load0.emplace().f_tip_N = TakeVectors(table, "f");
}

// The streams of files that were given without one.
void FindStreams(ImportPlan& plan, ImportLog& log) {
  for (const fs::path& file : plan.files) {
    const std::string stem = file.stem().string();
    StreamPlan unknown;
    unknown.file = file;
    const auto names = StreamsIn(OpenTable(unknown), StreamNamed(stem));
    if (names.empty()) {
      throw NotTold(fmt::format("{}: neither name nor columns say which sensor it is, expected {}",
                                file.string(), TableStreamsText()),
                    {"streams"});
    }
    for (const auto& name : names) {
      StreamPlan& stream = plan.streams[name];
      if (!stream.file.empty()) {
        throw NotTold(fmt::format("{}: looks like {}, which is {} already", file.string(), name,
                                  stream.file.string()),
                      {"streams"});
      }
      stream.file = file;
      log.Assume(name + ".file",
                 fmt::format("{}, by the names of file and columns", file.filename().string()));
    }
  }
  plan.files.clear();
}

}  // namespace

void ReadCsv(ImportPlan& plan, Streams& streams, ImportLog& log) {
  FindStreams(plan, log);
  for (auto& [name, stream] : plan.streams) {
    if (stream.file.empty()) {
      throw NotTold(fmt::format("{}: no file is told for it", name), {"streams"});
    }
    StreamRows rows = ReadStreamRows(name, stream, log);
    streams.skipped[name] = rows.duplicates + rows.missing;
    Take(name, StreamTable(stream, std::move(rows)), streams.recording);
    if (name == "em1" && !stream.columns.contains("x")) {
      log.Assume("em1.position", "0, 0, 0: its table has none; only its orientation is used");
    }
    stream.file = fs::absolute(stream.file).lexically_normal();
  }
}

}  // namespace flextip::exchange
