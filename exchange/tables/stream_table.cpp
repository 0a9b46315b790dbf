#include "exchange/tables/stream_table.h"

#include <fmt/format.h>

#include <cmath>

#include "exchange/tables/column_choice.h"
#include "exchange/values/times.h"
#include "exchange/values/units.h"
#include "recording/text/bounds.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

constexpr std::size_t kTimesLookedAt = 500;

struct SeparatorName {
  char sign;
  const char* name;
};
constexpr SeparatorName kSeparators[] = {
    {',', "comma"}, {';', "semicolon"}, {'\t', "tab"}, {' ', "blank"}};

// The header's unit of each kind of value. Throws where the columns of a kind have several.
std::map<std::string, std::string> HeaderUnits(const std::string& stream,
                                               const DelimitedTable& table,
                                               const ColumnChoice& choice, const StreamPlan& plan) {
  std::map<std::string, std::string> units;
  for (const auto& [role, text] : choice.units) {
    const std::string kind = UnitKindOf(role);
    if (kind.empty() || plan.units.contains(kind) || text == "-" || text == "1") continue;
    const auto unit = ParseUnit(text, kind);
    if (!unit) {
      throw NotTold(
          fmt::format("{}: found the unit {} of column {}, expected one of {}", table.file(),
                      Quoted(text), Quoted(table.Columns()[choice.roles.at(role)]), kind),
          {fmt::format("{}.units.{}", stream, kind)});
    }
    const auto [at, is_new] = units.emplace(kind, unit->name);
    if (is_new || at->second == unit->name) continue;
    throw InputError::At(table.file(), 1,
                         fmt::format("{}: found columns in {} and in {}, expected one unit of {}",
                                     stream, at->second, unit->name, kind));
  }
  return units;
}

void FindTimeUnit(const std::string& stream, DelimitedTable& table, const ColumnChoice& choice,
                  StreamPlan& plan, ImportLog& log) {
  if (plan.units.contains("time") || !choice.roles.contains("t")) return;
  std::vector<std::string> times;
  while (times.size() < kTimesLookedAt && table.Next()) {
    times.push_back(table.Plain(choice.roles.at("t")));
  }
  table.Rewind();
  const TimeUnitGuess guess = GuessTimeUnit(times);
  const std::string key = stream + ".units.time";
  if (guess.unit.empty()) {
    throw NotTold(fmt::format("{}: the times (first {}) do not tell their unit, expected s, ms, us "
                              "or ns",
                              table.file(), times.empty() ? "none" : Quoted(times.front())),
                  {key});
  }
  plan.units["time"] = guess.unit;
  if (guess.unit != "clock") log.Assume(key, fmt::format("{}, by {}", guess.unit, guess.why));
}

/// Reads a table's rows in the plan's units of time.
class RowReader {
 public:
  RowReader(const std::string& stream, DelimitedTable& table, const ColumnChoice& choice,
            const StreamPlan& plan)
      : table_(table), choice_(choice), plan_(plan), taker_(stream, ValueRoles(choice)) {}

  StreamRows Read() {
    while (table_.Next()) TakeRow();
    StreamRows rows = taker_.Finish();
    if (rows.t_ns.empty()) throw table_.Error("no samples, expected at least one row of values");
    rows.source = table_.file();
    return rows;
  }

 private:
  static std::vector<std::string> ValueRoles(const ColumnChoice& choice) {
    std::vector<std::string> roles;
    for (const auto& [role, column] : choice.roles) {
      if (role[0] != 't') roles.push_back(role);
    }
    return roles;
  }

  InputError FieldError(std::size_t column, const std::string& expected) const {
    return table_.Error(fmt::format("column {}: found {}, expected {}",
                                    Quoted(table_.Columns()[column]), Quoted(table_.Text(column)),
                                    expected));
  }

  TimeNs TimeIn(const std::string& role, const std::string& unit) const {
    const std::size_t column = choice_.roles.at(role);
    const auto t_ns = ParseTime(table_.Plain(column), unit);
    if (t_ns && std::abs(static_cast<double>(*t_ns)) <= BoundsOf("_ns").most) return *t_ns;
    throw FieldError(column,
                     unit == "clock" ? "a time like 2024-05-01T12:00:00.123" : "a time in " + unit);
  }

  TimeNs Time() const {
    const TimeNs t_ns = choice_.roles.contains("t") ? TimeIn("t", plan_.units.at("time"))
                                                    : TimeIn("t_s", "s") + TimeIn("t_ns", "ns");
    const auto sum = WithOffset(t_ns, plan_.offset_ns.value_or(0));
    if (sum) return *sum;
    throw table_.Error("the time is beyond what a recording holds, with what is added to it");
  }

  std::vector<double> Values() const {
    std::vector<double> values;
    for (const auto& [role, column] : choice_.roles) {
      if (role[0] == 't') continue;
      const auto value = table_.Number(column);
      if (!value || std::isinf(*value)) throw FieldError(column, "a finite number");
      values.push_back(*value);
    }
    return values;
  }

  void TakeRow() {
    const auto outcome = taker_.Take(Time(), table_.line(), Values());
    if (outcome != RowTaker::Outcome::kBackwards) return;
    const auto& roles = choice_.roles;
    const auto text = table_.Text(roles.contains("t") ? roles.at("t") : roles.at("t_ns"));
    throw table_.Error(
        fmt::format("time runs backwards: found {}, expected more than that of line "
                    "{}",
                    Quoted(text), taker_.rows().places.back()));
  }

  DelimitedTable& table_;
  const ColumnChoice& choice_;
  const StreamPlan& plan_;
  RowTaker taker_;
};

void SayClock(const std::string& stream, DelimitedTable& table, const ColumnChoice& choice,
              const StreamPlan& plan, ImportLog& log) {
  if (!choice.roles.contains("t") || plan.units.at("time") != "clock" || !table.Next()) return;
  const auto clock = ParseClock(table.Plain(choice.roles.at("t")));
  table.Rewind();
  if (!clock) return;
  if (!clock->has_date) {
    log.Assume(stream + ".clock", "times of day without a date: counted from midnight");
  } else if (!clock->has_zone) {
    log.Assume(stream + ".clock", "UTC: the clock texts state no zone");
  }
}

}  // namespace

DelimitedTable OpenTable(const StreamPlan& plan) {
  Dialect dialect{{}, {}, plan.header};
  for (const auto& separator : kSeparators) {
    if (plan.separator == separator.name) dialect.separator = separator.sign;
  }
  if (!plan.decimal.empty()) dialect.decimal = plan.decimal == "comma" ? ',' : '.';
  return DelimitedTable(plan.file, dialect);
}

StreamRows ReadStreamRows(const std::string& stream, StreamPlan& plan, ImportLog& log) {
  DelimitedTable table = OpenTable(plan);
  for (const auto& separator : kSeparators) {
    if (table.separator() == separator.sign) plan.separator = separator.name;
  }
  plan.decimal = table.decimal() == ',' ? "comma" : "point";
  plan.header = table.has_header();
  const ColumnChoice choice = ChooseColumns(stream, table, plan, log);
  for (const auto& [kind, unit] : HeaderUnits(stream, table, choice, plan)) plan.units[kind] = unit;
  FindTimeUnit(stream, table, choice, plan, log);
  SayClock(stream, table, choice, plan, log);
  StreamRows rows = RowReader(stream, table, choice, plan).Read();
  ToSi(stream, rows, plan, log);
  for (const auto& remark : table.Remarks()) log.Warn(remark);
  SayRows(stream, rows, log);
  return rows;
}

}  // namespace flextip::exchange
