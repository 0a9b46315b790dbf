#include "exchange/tables/stream_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "exchange/tables/column_choice.h"
#include "exchange/tables/times.h"
#include "exchange/tables/units.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

constexpr std::size_t kTimesLookedAt = 500;
constexpr double kLargestPlace_m = 10.0;  // above it numbers are millimetres
constexpr double kLargestAngle_rad = 2.02 * std::numbers::pi;

std::string KindOfRole(const std::string& role) {
  if (role == "t") return "time";
  if (role.starts_with("t_") || role[0] == 'q') return "";
  if (role[0] == 'r') return role.size() == 2 ? "angle" : "";
  if (role[0] == 'a') return "angle";
  if (role[0] == 'f') return "force";
  return role[0] == 'm' ? "moment" : "length";
}

bool IsOrientation(const std::string& role) {
  return role[0] == 'q' || role[0] == 'r' || role[0] == 'a';
}

std::optional<char> SeparatorOf(const std::string& name) {
  if (name == "comma") return ',';
  if (name == "semicolon") return ';';
  if (name == "tab") return '\t';
  if (name == "blank") return ' ';
  return {};
}

std::string SeparatorName(char separator) {
  return separator == ','    ? "comma"
         : separator == ';'  ? "semicolon"
         : separator == '\t' ? "tab"
                             : "blank";
}

// The header's unit of each kind of value. Throws where the columns of a kind have several.
std::map<std::string, std::string> HeaderUnits(const std::string& name, const DelimitedTable& table,
                                               const ColumnChoice& choice, const StreamPlan& plan) {
  std::map<std::string, std::string> units;
  for (const auto& [role, text] : choice.units) {
    const std::string kind = KindOfRole(role);
    if (kind.empty() || plan.units.contains(kind) || text == "-" || text == "1") continue;
    const auto unit = ParseUnit(text, kind);
    if (!unit) {
      throw NotTold(
          fmt::format("{}: found the unit {} of column {}, expected one of {}", table.file(),
                      Quoted(text), Quoted(table.Columns()[choice.roles.at(role)]), kind),
          {fmt::format("{}.units.{}", name, kind)});
    }
    const auto [at, is_new] = units.emplace(kind, unit->name);
    if (is_new || at->second == unit->name) continue;
    throw InputError::At(table.file(), 1,
                         fmt::format("{}: found columns in {} and in {}, expected one unit of {}",
                                     name, at->second, unit->name, kind));
  }
  return units;
}

void FindTimeUnit(const std::string& name, DelimitedTable& table, const ColumnChoice& choice,
                  StreamPlan& plan, ImportLog& log) {
  if (plan.units.contains("time") || !choice.roles.contains("t")) return;
  std::vector<std::string> times;
  while (times.size() < kTimesLookedAt && table.Next()) {
    times.push_back(table.Plain(choice.roles.at("t")));
  }
  table.Rewind();
  const TimeUnitGuess guess = GuessTimeUnit(times);
  const std::string key = name + ".units.time";
  if (guess.unit.empty()) {
    throw NotTold(fmt::format("{}: the times (first {}) do not tell their unit, expected s, ms, us "
                              "or ns",
                              table.file(), times.empty() ? "none" : Quoted(times.front())),
                  {key});
  }
  plan.units["time"] = guess.unit;
  if (guess.unit != "clock") log.Assume(key, fmt::format("{}, by {}", guess.unit, guess.why));
}

class RowReader {
 public:
  RowReader(std::string name, DelimitedTable& table, const ColumnChoice& choice,
            const StreamPlan& plan)
      : name_(std::move(name)), table_(table), choice_(choice), plan_(plan) {
    for (const auto& [role, column] : choice.roles) {
      if (role[0] != 't') rows_.values[role];
    }
  }

  StreamRows Read() {
    while (table_.Next()) TakeRow();
    if (rows_.t_ns.empty()) throw table_.Error("no samples, expected at least one row of values");
    return std::move(rows_);
  }

 private:
  InputError FieldError(std::size_t column, const std::string& expected) const {
    return table_.Error(fmt::format("column {}: found {}, expected {}",
                                    Quoted(table_.Columns()[column]), Quoted(table_.Text(column)),
                                    expected));
  }

  TimeNs Time(const std::string& role, const std::string& unit) const {
    const std::size_t column = choice_.roles.at(role);
    const auto t_ns = ParseTime(table_.Plain(column), unit);
    if (!t_ns) {
      throw FieldError(
          column, unit == "clock" ? "a time like 2024-05-01T12:00:00.123" : "a time in " + unit);
    }
    return *t_ns;
  }

  TimeNs Time() const {
    TimeNs t_ns = choice_.roles.contains("t") ? Time("t", plan_.units.at("time"))
                                              : Time("t_s", "s") + Time("t_ns", "ns");
    return t_ns + plan_.offset_ns.value_or(0);
  }

  // Of a wrist the orientation may be absent in a row.
  bool LacksOrientation() const {
    if (name_ != "wrist0") return false;
    bool any = false;
    for (const auto& [role, column] : choice_.roles) {
      if (!IsOrientation(role)) continue;
      if (!table_.Text(column).empty()) return false;
      any = true;
    }
    return any;
  }

  bool TakeValues(std::vector<double>& values) const {
    const bool unturned = LacksOrientation();
    double turn = 0.0;
    bool turns = false;
    for (const auto& [role, column] : choice_.roles) {
      if (role[0] == 't') continue;
      const auto value = table_.Number(column);
      if (!value || std::isinf(*value)) throw FieldError(column, "a finite number");
      if (std::isnan(*value) && !(unturned && IsOrientation(role))) {
        if (plan_.skip_missing) return false;
        throw NotTold(FieldError(column,
                                 "a number; rows without one are left out only where "
                                 "that is asked for")
                          .what(),
                      {name_ + ".skip_missing"});
      }
      if (role[0] == 'q') turn += std::abs(*value), turns = true;
      values.push_back(*value);
    }
    // A tracker that lost its tool may write a quaternion of zeros.
    return !(plan_.skip_missing && turns && turn == 0.0);
  }

  void TakeRow() {
    std::vector<double> values;
    if (!TakeValues(values)) {
      ++rows_.missing;
      return;
    }
    const TimeNs t_ns = Time();
    if (!rows_.t_ns.empty() && t_ns <= rows_.t_ns.back()) {
      if (t_ns == rows_.t_ns.back() && Same(values)) {
        ++rows_.duplicates;
        return;
      }
      throw table_.Error(fmt::format("time {}: found {}, expected more than that of line {}",
                                     t_ns < rows_.t_ns.back() ? "runs backwards" : "stands still",
                                     TimeText(), rows_.lines.back()));
    }
    rows_.t_ns.push_back(t_ns);
    rows_.lines.push_back(table_.line());
    std::size_t i = 0;
    for (auto& [role, column] : rows_.values) column.push_back(values[i++]);
  }

  std::string TimeText() const {
    const auto& roles = choice_.roles;
    return Quoted(table_.Text(roles.contains("t") ? roles.at("t") : roles.at("t_ns")));
  }

  bool Same(const std::vector<double>& values) const {
    std::size_t i = 0;
    for (const auto& [role, column] : rows_.values) {
      const double value = values[i++];
      if (column.back() != value && !(std::isnan(column.back()) && std::isnan(value))) return false;
    }
    return true;
  }

  std::string name_;
  DelimitedTable& table_;
  const ColumnChoice& choice_;
  const StreamPlan& plan_;
  StreamRows rows_;
};

double Largest(const StreamRows& rows, const std::string& kind) {
  double largest = 0.0;
  for (const auto& [role, values] : rows.values) {
    if (KindOfRole(role) != kind) continue;
    for (const double value : values) largest = std::fmax(largest, std::abs(value));
  }
  return largest;
}

void ToSi(const std::string& name, StreamRows& rows, StreamPlan& plan, ImportLog& log) {
  for (auto& [role, values] : rows.values) {
    const std::string kind = KindOfRole(role);
    if (kind.empty()) continue;
    if (!plan.units.contains(kind)) {
      const double largest = Largest(rows, kind);
      std::string unit = kind == "force" ? "N" : kind == "moment" ? "Nm" : "m";
      if (kind == "length" && largest > kLargestPlace_m) unit = "mm";
      if (kind == "angle") unit = largest > kLargestAngle_rad ? "deg" : "rad";
      plan.units[kind] = unit;
      log.Assume(fmt::format("{}.units.{}", name, kind),
                 fmt::format("{}: no unit is stated, the largest value is {:.6g}", unit, largest));
    }
  }
  for (auto& [role, values] : rows.values) {
    const std::string kind = KindOfRole(role);
    if (kind.empty()) continue;
    const Unit unit = *ParseUnit(plan.units.at(kind), kind);
    for (double& value : values) value = unit.ToSi(value);
  }
}

void SayClock(const std::string& name, const DelimitedTable& table, const ColumnChoice& choice,
              const StreamPlan& plan, ImportLog& log) {
  if (!choice.roles.contains("t") || plan.units.at("time") != "clock") return;
  const auto clock = ParseClock(table.Plain(choice.roles.at("t")));
  if (!clock) return;
  if (!clock->has_date) {
    log.Assume(name + ".clock", "times of day without a date: counted from midnight");
  } else if (!clock->has_zone) {
    log.Assume(name + ".clock", "UTC: the clock texts state no zone");
  }
}

void SayRepeats(const std::string& name, const StreamRows& rows, ImportLog& log) {
  std::size_t repeats = 0;
  for (std::size_t i = 1; i < rows.t_ns.size(); ++i) {
    repeats += std::all_of(rows.values.begin(), rows.values.end(), [&](const auto& column) {
      return column.second[i] == column.second[i - 1];
    });
  }
  if (rows.values.empty() || 2 * repeats < rows.t_ns.size() || rows.t_ns.size() < 10) return;
  log.Warn(
      fmt::format("{}: {} of {} rows repeat the values of the row before: the sensor is slower "
                  "than its table, or stood still",
                  name, repeats, rows.t_ns.size()));
}

void SayUnused(const std::string& name, const DelimitedTable& table, const ColumnChoice& choice,
               ImportLog& log) {
  std::set<std::size_t> used;
  for (const auto& [role, column] : choice.roles) used.insert(column);
  std::string unused;
  for (std::size_t i = 0; i < table.Columns().size(); ++i) {
    if (!used.contains(i)) unused += (unused.empty() ? "" : ", ") + table.Columns()[i];
  }
  if (!unused.empty()) log.Warn(fmt::format("{}: {}: not used: {}", name, table.file(), unused));
}

}  // namespace

std::string StreamNamed(const std::string& name) {
  static const std::vector<std::pair<std::string, std::set<std::string>>> kHints{
      {"command0",
       {"command", "commanded", "command0", "cmd", "setpoint", "desired", "target", "goal"}},
      {"em1", {"em1", "port", "trocar"}},
      {"em0", {"em0", "em", "aurora", "ndi", "tracker", "emt", "sensor", "rs", "trakstar"}},
      {"strain0", {"strain0", "strain", "gage", "gages", "gauge", "gauges", "fbg"}},
      {"load0", {"load0", "load", "force", "forces", "ft", "wrench", "loadcell"}},
      {"wrist0",
       {"wrist0", "wrist", "robot", "tcp", "flange", "ee", "effector", "endeffector", "tool0", "rw",
        "arm"}}};
  auto words = WordsOf(name);
  const auto match = [&]() -> std::string {
    for (const auto& [stream, hints] : kHints) {
      for (const auto& word : words) {
        if (hints.contains(word)) return stream;
      }
    }
    return "";
  };
  if (std::string stream = match(); !stream.empty()) return stream;
  for (auto& word : words) word.erase(word.find_last_not_of("0123456789") + 1);  // robot2
  return match();
}

DelimitedTable OpenTable(const StreamPlan& plan) {
  Dialect dialect{SeparatorOf(plan.separator), {}, plan.header};
  if (!plan.decimal.empty()) dialect.decimal = plan.decimal == "comma" ? ',' : '.';
  return DelimitedTable(plan.file, dialect);
}

StreamRows ReadStreamRows(const std::string& name, StreamPlan& plan, ImportLog& log) {
  DelimitedTable table = OpenTable(plan);
  plan.separator = SeparatorName(table.separator());
  plan.decimal = table.decimal() == ',' ? "comma" : "point";
  plan.header = table.has_header();
  const ColumnChoice choice = ChooseColumns(name, table, plan, log);
  for (const auto& [kind, unit] : HeaderUnits(name, table, choice, plan)) plan.units[kind] = unit;
  FindTimeUnit(name, table, choice, plan, log);
  if (table.Next()) SayClock(name, table, choice, plan, log);
  table.Rewind();
  StreamRows rows = RowReader(name, table, choice, plan).Read();
  ToSi(name, rows, plan, log);
  if (rows.duplicates > 0) {
    log.Warn(fmt::format("{}: {}: left out {} rows that repeat the one before, time and values",
                         name, table.file(), rows.duplicates));
  }
  if (rows.missing > 0) {
    log.Warn(fmt::format("{}: {}: left out {} rows with missing values", name, table.file(),
                         rows.missing));
  }
  for (const auto& remark : table.Remarks()) log.Warn(remark);
  SayRepeats(name, rows, log);
  SayUnused(name, table, choice, log);
  return rows;
}

}  // namespace flextip::exchange
