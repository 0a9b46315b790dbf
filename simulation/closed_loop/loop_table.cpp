#include "simulation/closed_loop/loop_table.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/error.h"
#include "recording/text/csv.h"

namespace flextip::simulation {
namespace {

enum Column : std::uint8_t {
  kTime,
  kCommand,
  kUsed = kCommand + 3,
  kWanted = kUsed + 3,
  kDirection = kWanted + 3,
  kResume = kDirection + 3,
  kStatus,
  kStop,
  kReaction,
  kOut,
  kChi2,
  kChi2Limit,
  kAngle,
  kSensors
};

std::vector<std::string> Columns() {
  std::vector<std::string> columns{"timestamp [ns]"};
  const auto add = [&](const std::string& name, const char* unit) {
    for (const char* axis : {"x", "y", "z"})
      columns.push_back(fmt::format("{}_{} [{}]", name, axis, unit));
  };
  add("p_RW", "m");
  add("p_RE_used", "m");
  add("p_RE_wanted", "m");
  add("d_RE_wanted", "");
  columns.insert(columns.end(),
                 {"resume []", "status []", "found_stop []", "found_reaction []", "found_out []",
                  "found_chi2 []", "found_chi2_limit []", "found_angle [rad]", "sensors []"});
  return columns;
}

/// A number that is not finite has no word in a table: it is empty, and NaN when it is read.
void AddVector(CsvWriter& csv, const Eigen::Vector3d& v) {
  for (const double value : v) csv.AddOrEmpty(value);
}

void AddVector(CsvWriter& csv, const std::optional<Eigen::Vector3d>& v) {
  if (v) {
    AddVector(csv, *v);
  } else {
    csv.AddEmpty(3);
  }
}

double NumberAt(const CsvReader& csv, std::size_t column) {
  return csv.Empty(column) ? std::nan("") : csv.Number(column);
}

Eigen::Vector3d VectorAt(const CsvReader& csv, std::size_t column) {
  return {NumberAt(csv, column), NumberAt(csv, column + 1), NumberAt(csv, column + 2)};
}

std::optional<Eigen::Vector3d> OptionalAt(const CsvReader& csv, std::size_t column) {
  if (csv.Empty(column)) return {};
  return VectorAt(csv, column);
}

template <class Enum>
Enum NameAt(const CsvReader& csv, std::size_t column, int count) {
  const TimeNs found = csv.Integer(column);
  if (found >= 0 && found < count) return static_cast<Enum>(found);
  throw csv.Error(
      fmt::format("{}: found {}, expected 0 to {}", csv.Columns()[column], found, count - 1));
}

bool SameBits(double a, double b) {
  if (!std::isfinite(a) && !std::isfinite(b)) return true;
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool SameBits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return SameBits(a.x(), b.x()) && SameBits(a.y(), b.y()) && SameBits(a.z(), b.z());
}

}  // namespace

ControllerInputs InputsOf(const LoopCycle& cycle) {
  ControllerInputs inputs;
  inputs.t_ns = inputs.pictures_t_ns = cycle.t_ns;
  inputs.sensors = cycle.sensors;
  inputs.p_RE_desired = cycle.p_RE_desired;
  inputs.d_RE_desired = cycle.d_RE_desired;
  inputs.resume = cycle.resume;
  return inputs;
}

void TakeCommand(const ControllerCommand& command, LoopCycle& cycle) {
  cycle.status = command.status;
  cycle.p_RW_command = command.p_RW_command;
  cycle.p_RE_used = command.p_RE_used;
  cycle.supervision = command.supervision;
}

bool SameCommand(const LoopCycle& a, const LoopCycle& b) {
  const Supervision &f = a.supervision, &g = b.supervision;
  return a.status == b.status && SameBits(a.p_RW_command, b.p_RW_command) &&
         SameBits(a.p_RE_used, b.p_RE_used) && f.stop == g.stop && f.reaction == g.reaction &&
         f.voted_out == g.voted_out && SameBits(f.chi2, g.chi2) &&
         SameBits(f.chi2_limit, g.chi2_limit) && SameBits(f.worst_angle_rad, g.worst_angle_rad);
}

struct LoopTableWriter::Table {
  CsvWriter csv{Columns()};
};

LoopTableWriter::LoopTableWriter() : table_(std::make_unique<Table>()) {}
LoopTableWriter::~LoopTableWriter() = default;
LoopTableWriter::LoopTableWriter(LoopTableWriter&&) noexcept = default;

void LoopTableWriter::Add(const LoopCycle& cycle) {
  CsvWriter& csv = table_->csv;
  const Supervision& found = cycle.supervision;
  csv.Add(cycle.t_ns);
  AddVector(csv, cycle.p_RW_command);
  AddVector(csv, cycle.p_RE_used);
  AddVector(csv, cycle.p_RE_desired);
  AddVector(csv, cycle.d_RE_desired);
  csv.Add(TimeNs(cycle.resume ? 1 : 0)).Add(TimeNs(static_cast<int>(cycle.status)));
  csv.Add(TimeNs(static_cast<int>(found.stop))).Add(TimeNs(static_cast<int>(found.reaction)));
  csv.Add(TimeNs(found.voted_out)).AddOrEmpty(found.chi2).AddOrEmpty(found.chi2_limit);
  csv.AddOrEmpty(found.worst_angle_rad);
  StateText state;
  SensorReadings sensors = cycle.sensors;
  state(sensors);
  csv.Add(state.Text());
  csv.EndRow();
}

const std::string& LoopTableWriter::Text() const { return table_->csv.text(); }

struct LoopTableReader::Table {
  Table(const std::filesystem::path& file, ReadLog& log) : csv(file, Columns(), log) {}
  CsvReader csv;
};

LoopTableReader::LoopTableReader(const std::filesystem::path& file, ReadLog& log)
    : table_(std::make_unique<Table>(file, log)) {}
LoopTableReader::~LoopTableReader() = default;

std::optional<LoopCycle> LoopTableReader::Next() {
  CsvReader& csv = table_->csv;
  if (!csv.Next()) return {};
  LoopCycle cycle;
  cycle.t_ns = csv.Integer(kTime);
  cycle.p_RW_command = VectorAt(csv, kCommand);
  cycle.p_RE_used = VectorAt(csv, kUsed);
  cycle.p_RE_desired = OptionalAt(csv, kWanted);
  cycle.d_RE_desired = OptionalAt(csv, kDirection);
  cycle.resume = csv.Integer(kResume) != 0;
  cycle.status = NameAt<ControlStatus>(csv, kStatus, static_cast<int>(ControlStatus::kNoWrist) + 1);
  Supervision& found = cycle.supervision;
  found.stop = NameAt<Stop>(csv, kStop, kStops);
  found.reaction = NameAt<Reaction>(csv, kReaction, kReactions);
  found.voted_out = static_cast<std::uint8_t>(csv.Integer(kOut));
  found.chi2 = NumberAt(csv, kChi2);
  found.chi2_limit = NumberAt(csv, kChi2Limit);
  found.worst_angle_rad = NumberAt(csv, kAngle);
  try {
    StateText state{std::string(csv.Text(kSensors))};
    state(cycle.sensors);
    state.Finish();
  } catch (const InputError& error) {
    throw csv.Error(error.what());
  }
  return cycle;
}

}  // namespace flextip::simulation
