#include "exchange/tables/column_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "exchange/list_text.h"
#include "exchange/streams/names.h"
#include "exchange/tables/orientation_columns.h"
#include "exchange/tables/stream_needs.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

void CheckRoles(const std::string& name, const StreamPlan& plan) {
  static const std::set<std::string> known = [] {
    std::set<std::string> all{"t", "t_s", "t_ns"};
    for (const auto* names : {&kPlaceRoles, &kQuaternionRoles, &kMatrixRoles, &kVectorRoles,
                              &kAngleRoles, &kForceRoles, &kMomentRoles}) {
      all.insert(names->begin(), names->end());
    }
    return all;
  }();
  for (const auto& [role, column] : plan.columns) {
    if (!known.contains(role)) {
      throw InputError(fmt::format("{}: found the column's role {}, expected one of {}", name,
                                   Quoted(role), fmt::join(known, ", ")));
    }
  }
}

std::string Lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

std::string WithoutUnit(const std::string& column) {
  const auto bracket = column.find_last_of("[(");
  return std::string(Trim(std::string_view(column).substr(0, bracket)));
}

// By the whole name, the name without its unit, either in small letters, or its number from 1.
std::size_t FindColumn(const std::string& name, const DelimitedTable& table,
                       const std::string& role, const std::string& wanted) {
  const auto& columns = table.Columns();
  const auto find = [&](const auto& form) {
    return static_cast<std::size_t>(
        std::find_if(columns.begin(), columns.end(),
                     [&](const std::string& column) { return form(column) == form(wanted); }) -
        columns.begin());
  };
  const std::size_t none = columns.size();
  std::size_t found = find([](const std::string& text) { return text; });
  if (found == none) {
    found = static_cast<std::size_t>(
        std::find_if(columns.begin(), columns.end(),
                     [&](const std::string& column) { return WithoutUnit(column) == wanted; }) -
        columns.begin());
  }
  if (found == none) found = find(Lower);
  const auto number = ParseInteger(wanted);
  if (found == none && number && *number >= 1 && *number <= static_cast<std::int64_t>(none)) {
    found = static_cast<std::size_t>(*number - 1);
  }
  if (found < none) return found;
  throw InputError::At(table.file(), 1,
                       fmt::format("{}.{}: found no column {}, expected one of {}", name, role,
                                   Quoted(wanted), fmt::join(columns, ", ")));
}

// Without a header columns are what their number suggests: time, then values.
NamedColumns ByNumber(const std::string& stream, std::size_t columns) {
  NamedColumns named;
  named.units.resize(columns);
  named.times.emplace_back("t", 0);
  ColumnGroup group;
  const auto add = [&](const RoleNames& names) {
    for (const auto& role : names) group.roles.emplace(role, group.roles.size() + 1);
  };
  const StreamNeeds needs = NeedsOf(stream);
  if (!needs.orientation && columns == needs.values.size() + 1) add(needs.values);
  if (needs.orientation && (columns == 4 || columns == 7 || columns == 8 || columns == 13)) {
    add(kPlaceRoles);
    if (columns == 7) add(kAnyTurnRoles);
    if (columns == 8) add({"q0", "q1", "q2", "q3"});
    if (columns == 13) add(kMatrixRoles);
  }
  if (!group.roles.empty()) named.groups.push_back(std::move(group));
  return named;
}

bool CanBe(const ColumnGroup& group, const StreamNeeds& needs) {
  if (needs.values.empty()) return HasOrientation(group.roles);
  return HasAll(group.roles, needs.values);
}

const ColumnGroup* ChooseGroup(const std::string& name, const DelimitedTable& table,
                               const NamedColumns& named, const StreamNeeds& needs) {
  std::vector<const ColumnGroup*> candidates, hinted, unnamed;
  for (const ColumnGroup& group : named.groups) {
    if (!CanBe(group, needs)) continue;
    candidates.push_back(&group);
    if (StreamNamed(group.name) == name) hinted.push_back(&group);
    if (StreamNamed(group.name).empty()) unnamed.push_back(&group);
  }
  if (candidates.size() == 1) return candidates.front();
  if (hinted.size() == 1) return hinted.front();
  if (hinted.empty() && unnamed.size() == 1) return unnamed.front();
  for (const auto* group : unnamed) {
    if (hinted.empty() && group->name.empty()) return group;  // plain x, y, z
  }
  if (candidates.empty()) return nullptr;
  std::string groups;
  for (const auto* group : candidates) AppendItem(groups, Quoted(group->name));
  throw NotTold(fmt::format("{}: found several things that could be {} ({}), expected its columns "
                            "told",
                            table.file(), name, groups),
                {name + ".columns.x"});
}

// A force's or command's columns may be named x, y, z alone.
Roles RolesOfGroup(const std::string& name, const DelimitedTable& table, const NamedColumns& named,
                   const StreamNeeds& needs) {
  if (const auto* group = ChooseGroup(name, table, named, needs)) {
    Roles roles = group->roles;
    if (!needs.orientation || HasOrientation(roles)) return roles;
    const ColumnGroup* turn = nullptr;  // the orientation may be named apart
    for (const ColumnGroup& other : named.groups) {
      if (HasAll(other.roles, kPlaceRoles) || !HasOrientation(other.roles)) continue;
      if (turn != nullptr) return roles;
      turn = &other;
    }
    if (turn != nullptr) roles.insert(turn->roles.begin(), turn->roles.end());
    return roles;
  }
  if (name != "load0") return {};
  Roles roles;
  if (const auto* group = ChooseGroup(name, table, named, {kPlaceRoles})) {
    for (const auto& axis : kPlaceRoles) roles["f" + axis] = group->roles.at(axis);
  }
  return roles;
}

// A stamp of the measurement goes before that of the recorder.
void AddTime(const std::string& name, const DelimitedTable& table, const NamedColumns& named,
             ColumnChoice& choice) {
  Roles& roles = choice.roles;
  if (roles.contains("t") || (roles.contains("t_s") && roles.contains("t_ns"))) return;
  std::map<std::string, std::vector<std::size_t>> times;
  for (const auto& [role, column] : named.times) times[role].push_back(column);
  if (times.contains("t_s") && times.contains("t_ns")) {
    roles["t_s"] = times["t_s"].front();
    roles["t_ns"] = times["t_ns"].front();
    return;
  }
  for (const char* role : {"t", "t_s", "t_ns"}) {
    if (!times.contains(role)) continue;
    std::size_t chosen = times[role].front();
    for (const std::size_t column : times[role]) {
      const auto words = WordsOf(table.Columns()[column]);
      if (std::find(words.begin(), words.end(), "header") == words.end()) continue;
      chosen = column;
      break;
    }
    roles["t"] = chosen;
    if (std::string(role) != "t") choice.units["t"] = std::string(role) == "t_s" ? "s" : "ns";
    return;
  }
  throw NotTold(fmt::format("{}: found no column of times among {}", table.file(),
                            fmt::join(table.Columns(), ", ")),
                {name + ".columns.t"});
}

void CheckComplete(const std::string& name, const DelimitedTable& table, const StreamNeeds& needs,
                   const Roles& roles) {
  std::string missing;
  std::vector<std::string> keys;
  const auto need = [&](const RoleNames& names) {
    for (const auto& role : names) {
      if (roles.contains(role)) continue;
      AppendItem(missing, role);
      keys.push_back(fmt::format("{}.columns.{}", name, role));
    }
  };
  need(needs.values);
  if (needs.needs_orientation && missing.empty() && !HasOrientation(roles)) need(kQuaternionRoles);
  if (missing.empty()) return;
  throw NotTold(fmt::format("{}: {} needs the columns {}, found {}", table.file(), name, missing,
                            fmt::join(table.Columns(), ", ")),
                keys);
}

// Columns by their names, so that the mapping holds for another file; by number where they have
// none of their own.
void Remember(const std::string& name, const DelimitedTable& table, const Roles& roles,
              StreamPlan& plan, ImportLog& log) {
  const auto& columns = table.Columns();
  std::string guessed;
  for (const auto& [role, column] : roles) {
    const bool unique = std::count(columns.begin(), columns.end(), columns[column]) == 1;
    const std::string text = unique ? columns[column] : std::to_string(column + 1);
    if (!plan.columns.contains(role)) {
      guessed += fmt::format("{}{} = {}", guessed.empty() ? "" : ", ", role, text);
    }
    plan.columns[role] = text;
  }
  if (guessed.empty()) return;
  log.Assume(name + ".columns",
             guessed + (table.has_header() ? " (by their names)" : " (by their number)"));
}

}  // namespace

ColumnChoice ChooseColumns(const std::string& name, const DelimitedTable& table, StreamPlan& plan,
                           ImportLog& log) {
  CheckRoles(name, plan);
  CheckOrientationKind(name, plan);
  const StreamNeeds needs = NeedsOf(name);
  const NamedColumns named =
      table.has_header() ? NameRoles(table.Columns()) : ByNumber(name, table.Columns().size());
  ColumnChoice choice;
  Roles told;
  for (const auto& [role, column] : plan.columns) {
    told[role] = FindColumn(name, table, role, column);
  }
  Roles values = told;
  for (const char* time : {"t", "t_s", "t_ns"}) values.erase(time);
  const bool whole = HasAll(values, needs.values) && !values.empty() &&
                     (!needs.needs_orientation || HasOrientation(values));
  if (!whole && !IsCamera(name)) {
    Roles found = RolesOfGroup(name, table, named, needs);
    for (const auto& [role, column] : found) values.emplace(role, column);
  }
  if (needs.orientation) {
    ChooseOrientation(name, table, plan, values, log);
  } else {
    KeepOnly(values, needs.values);
  }
  CheckComplete(name, table, needs, values);
  choice.roles = std::move(values);
  for (const char* time : {"t", "t_s", "t_ns"}) {
    if (told.contains(time)) choice.roles[time] = told.at(time);
  }
  AddTime(name, table, named, choice);
  const auto units = table.has_header() ? named.units : std::vector<std::string>();
  for (const auto& [role, column] : choice.roles) {
    if (column < units.size() && !units[column].empty()) choice.units[role] = units[column];
  }
  Remember(name, table, choice.roles, plan, log);
  return choice;
}

std::vector<std::string> StreamsIn(const DelimitedTable& table, const std::string& by_file) {
  std::set<std::string> found;
  std::size_t poses = 0;
  const NamedColumns named = NameRoles(table.Columns());
  for (const ColumnGroup& group : named.groups) {
    const std::string by_name = StreamNamed(group.name);
    if (HasAll(group.roles, kMomentRoles)) found.insert("strain0");
    if (HasAll(group.roles, kForceRoles)) found.insert("load0");
    if (!HasAll(group.roles, kPlaceRoles)) continue;
    ++poses;
    if (!by_name.empty() && by_name != "strain0" && by_name != "load0") found.insert(by_name);
    if (by_name.empty() && !by_file.empty()) found.insert(by_file);
  }
  // The file's name counts where its columns do not tell streams apart.
  const bool several = table.has_header() && (found.size() > 1 || poses > 1);
  const bool commands = found.size() == 1 && *found.begin() == "command0";
  if (!several && !commands && !by_file.empty()) return {by_file};
  return {found.begin(), found.end()};
}

}  // namespace flextip::exchange
