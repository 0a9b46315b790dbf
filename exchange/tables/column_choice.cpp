#include "exchange/tables/column_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "exchange/tables/stream_table.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

using Names = std::vector<std::string>;

const Names kPlace{"x", "y", "z"};
const Names kQuaternion{"qw", "qx", "qy", "qz"};
const Names kMatrix{"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"};
const Names kVector{"rx", "ry", "rz"};
const Names kAngles{"ax", "ay", "az"};
const Names kAny{"anyx", "anyy", "anyz"};
const Names kForce{"fx", "fy", "fz"};
const Names kMoments{"m1_y", "m1_z", "m2_y", "m2_z"};

bool HasAll(const Roles& roles, const Names& names) {
  return std::all_of(names.begin(), names.end(), [&](const auto& n) { return roles.contains(n); });
}

bool HasOrientation(const Roles& roles) {
  for (const Names* names : {&kQuaternion, &kMatrix, &kVector, &kAngles, &kAny}) {
    if (HasAll(roles, *names)) return true;
  }
  return HasAll(roles, {"q0", "q1", "q2", "q3"}) || HasAll(roles, {"q1", "q2", "q3", "q4"});
}

/// What a stream is made of.
struct Needs {
  Names values;  ///< without which there is no stream
  bool orientation = false, needs_orientation = false;
};

Needs NeedsOf(const std::string& stream) {
  if (stream == "strain0") return {kMoments};
  if (stream == "load0") return {kForce};
  if (stream == "cam0") return {};
  if (stream == "command0") return {kPlace};
  if (stream == "em1") return {{}, true, true};
  return {kPlace, true, stream == "em0"};
}

bool IsEuler(const std::string& orientation) {
  if (orientation.size() != 9 || !orientation.starts_with("euler-")) return false;
  std::string axes = orientation.substr(6);
  std::sort(axes.begin(), axes.end());
  return axes == "xyz";
}

void CheckTold(const std::string& name, const StreamPlan& plan) {
  const std::string& o = plan.orientation;
  if (!o.empty() && o != "quaternion" && o != "matrix" && o != "rotation-vector" && !IsEuler(o)) {
    throw InputError(
        fmt::format("{}: found the orientation {}, expected quaternion, matrix, "
                    "rotation-vector or euler-zyx (any order of three axes)",
                    name, Quoted(o)));
  }
  static const std::set<std::string> known = [] {
    std::set<std::string> all{"t", "t_s", "t_ns"};
    for (const Names* names :
         {&kPlace, &kQuaternion, &kMatrix, &kVector, &kAngles, &kForce, &kMoments}) {
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
  const auto add = [&](const Names& names) {
    for (const auto& role : names) group.roles.emplace(role, group.roles.size() + 1);
  };
  const Needs needs = NeedsOf(stream);
  if (!needs.orientation && columns == needs.values.size() + 1) add(needs.values);
  if (needs.orientation && (columns == 4 || columns == 7 || columns == 8 || columns == 13)) {
    add(kPlace);
    if (columns == 7) add(kAny);
    if (columns == 8) add({"q0", "q1", "q2", "q3"});
    if (columns == 13) add(kMatrix);
  }
  if (!group.roles.empty()) named.groups.push_back(std::move(group));
  return named;
}

// The order of the four columns of a quaternion: as told, else by what counts them.
void OrderQuaternion(const std::string& name, const DelimitedTable& table, const StreamPlan& plan,
                     Roles& roles, ImportLog& log) {
  std::vector<std::size_t> columns;
  for (const auto& [role, column] : roles) {
    if (role.size() == 2 && role[0] == 'q') columns.push_back(column);
  }
  if (columns.size() != 4) return;
  if (plan.quaternion.empty() && HasAll(roles, kQuaternion)) return;
  std::string order = plan.quaternion;
  if (order.empty() && table.has_header() && roles.contains("q0")) {
    order = "wxyz";
    log.Assume(name + ".quaternion", "wxyz: the column of number 0 is taken for the scalar");
  }
  if (order.empty()) {
    throw NotTold(fmt::format("{}: the order of the quaternion's columns is not known, expected "
                              "wxyz or xyzw",
                              table.file()),
                  {name + ".quaternion"});
  }
  std::sort(columns.begin(), columns.end());
  std::erase_if(roles, [](const auto& r) { return r.first.size() == 2 && r.first[0] == 'q'; });
  for (std::size_t i = 0; i < 4; ++i) roles[std::string("q") + order[i]] = columns[i];
}

void Keep(Roles& roles, const Names& names) {
  std::erase_if(roles, [&](const auto& role) {
    return std::find(names.begin(), names.end(), role.first) == names.end();
  });
}

// Leaves the columns of one kind of orientation, and says which.
void ChooseOrientation(const std::string& name, const DelimitedTable& table, StreamPlan& plan,
                       Roles& roles, ImportLog& log) {
  OrderQuaternion(name, table, plan, roles, log);
  Names kept{"x", "y", "z"};
  const auto keep = [&](const Names& names, const std::string& kind) {
    kept.insert(kept.end(), names.begin(), names.end());
    plan.orientation = kind;
    Keep(roles, kept);
  };
  const std::string told = plan.orientation;
  const auto is = [&](const char* kind) { return told.empty() || told == kind; };
  if (is("quaternion") && HasAll(roles, kQuaternion)) return keep(kQuaternion, "quaternion");
  if (is("matrix") && HasAll(roles, kMatrix)) return keep(kMatrix, "matrix");
  if (is("rotation-vector") && HasAll(roles, kVector)) return keep(kVector, "rotation-vector");
  if ((told.empty() || IsEuler(told)) && HasAll(roles, kAngles)) {
    if (told.empty()) {
      log.Assume(name + ".orientation",
                 "euler-zyx: R = Rz(yaw) Ry(pitch) Rx(roll), as in ROS and URDF");
    }
    return keep(kAngles, told.empty() ? "euler-zyx" : told);
  }
  if (HasAll(roles, kAny)) {
    if (told != "rotation-vector" && !IsEuler(told)) {
      throw NotTold(
          fmt::format("{}: the columns of the rotation do not say what they are, expected "
                      "rotation-vector or euler-zyx (any order of three axes)",
                      table.file()),
          {name + ".orientation"});
    }
    for (const char* axis : {"x", "y", "z"}) {
      roles[(told == "rotation-vector" ? "r" : "a") + std::string(axis)] =
          roles.at(std::string("any") + axis);
    }
    return keep(told == "rotation-vector" ? kVector : kAngles, told);
  }
  if (!told.empty()) {
    throw InputError::At(table.file(), 1, fmt::format("{}: found no columns of a {}", name, told));
  }
  Keep(roles, kept);
}

bool CanBe(const ColumnGroup& group, const Needs& needs) {
  if (needs.values.empty()) return HasOrientation(group.roles);
  return HasAll(group.roles, needs.values);
}

const ColumnGroup* ChooseGroup(const std::string& name, const DelimitedTable& table,
                               const NamedColumns& named, const Needs& needs) {
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
  if (candidates.empty()) return nullptr;
  std::string groups;
  for (const auto* group : candidates) groups += (groups.empty() ? "" : ", ") + Quoted(group->name);
  throw NotTold(fmt::format("{}: found several things that could be {} ({}), expected its columns "
                            "told",
                            table.file(), name, groups),
                {name + ".columns.x"});
}

// A force's or command's columns may be named x, y, z alone.
Roles RolesOfGroup(const std::string& name, const DelimitedTable& table, const NamedColumns& named,
                   const Needs& needs) {
  if (const auto* group = ChooseGroup(name, table, named, needs)) {
    Roles roles = group->roles;
    if (!needs.orientation || HasOrientation(roles)) return roles;
    const ColumnGroup* turn = nullptr;  // the orientation may be named apart
    for (const ColumnGroup& other : named.groups) {
      if (HasAll(other.roles, kPlace) || !HasOrientation(other.roles)) continue;
      if (turn != nullptr) return roles;
      turn = &other;
    }
    if (turn != nullptr) roles.insert(turn->roles.begin(), turn->roles.end());
    return roles;
  }
  if (name != "load0") return {};
  Roles roles;
  if (const auto* group = ChooseGroup(name, table, named, {kPlace})) {
    for (const auto& axis : kPlace) roles["f" + axis] = group->roles.at(axis);
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

void CheckComplete(const std::string& name, const DelimitedTable& table, const Needs& needs,
                   const Roles& roles) {
  std::string missing;
  std::vector<std::string> keys;
  const auto need = [&](const Names& names) {
    for (const auto& role : names) {
      if (roles.contains(role)) continue;
      missing += (missing.empty() ? "" : ", ") + role;
      keys.push_back(fmt::format("{}.columns.{}", name, role));
    }
  };
  need(needs.values);
  if (needs.needs_orientation && missing.empty() && !HasOrientation(roles)) need(kQuaternion);
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
  CheckTold(name, plan);
  const Needs needs = NeedsOf(name);
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
  if (!whole && name != "cam0") {
    Roles found = RolesOfGroup(name, table, named, needs);
    for (const auto& [role, column] : found) values.emplace(role, column);
  }
  if (needs.orientation) {
    ChooseOrientation(name, table, plan, values, log);
  } else {
    Keep(values, needs.values);
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
    if (HasAll(group.roles, kMoments)) found.insert("strain0");
    if (HasAll(group.roles, kForce)) found.insert("load0");
    if (!HasAll(group.roles, kPlace)) continue;
    ++poses;
    if (!by_name.empty() && by_name != "strain0" && by_name != "load0") found.insert(by_name);
    if (by_name.empty() && !by_file.empty()) found.insert(by_file);
  }
  // The file's name counts where its columns do not tell streams apart.
  const bool several = table.has_header() && (found.size() > 1 || poses > 1);
  if (!several && !by_file.empty()) return {by_file};
  return {found.begin(), found.end()};
}

}  // namespace flextip::exchange
