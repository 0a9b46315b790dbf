#include "exchange/tables/column_roles.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "exchange/list_text.h"
#include "exchange/streams/names.h"
#include "exchange/values/units.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

using Words = std::vector<std::string>;
using WordSet = std::set<std::string>;

const WordSet kTimes{"t", "time", "times", "timestamp", "timestamps", "stamp", "clock", "datetime"};
const WordSet kAxes{"x", "y", "z", "w"};
const WordSet kPositions{"p",     "pos", "position", "positions", "translation",
                         "trans", "xyz", "point",    "location",  "tvec"};
const WordSet kQuaternions{"q", "quat", "quaternion", "orientation", "ori"};
const WordSet kVectors{"rotvec", "rv", "rvec", "axisangle"};
const WordSet kRotations{"r", "rot", "rotation", "euler", "angle", "angles"};
const WordSet kForces{"f", "force"};
const WordSet kOthers{"torque",     "tau", "moment",  "v",     "vel",          "velocity", "twist",
                      "linear",     "acc", "angular", "accel", "acceleration", "gyro",     "mag",
                      "covariance", "cov", "scale",   "d",     "direction",    "error",    "err",
                      "std",        "sd",  "sigma",   "var",   "rms"};

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

struct Found {
  std::string role, group;
};

std::string Join(const Words& words, const WordSet& without = {}) {
  std::string text;
  for (const auto& word : words) {
    if (without.contains(word)) continue;
    AppendItem(text, word, "_");
  }
  return text;
}

std::optional<Found> AsTime(const Words& words, const std::string& last, const Words& rest) {
  if (kTimes.contains(last)) return Found{"t", Join(words)};
  if (rest.empty() || !kTimes.contains(rest.back())) return {};
  if (last == "sec" || last == "secs") return Found{"t_s", Join(rest)};
  if (last == "nsec" || last == "nsecs" || last == "nanosec" || last == "nanosecs") {
    return Found{"t_ns", Join(rest)};
  }
  return {};
}

std::optional<Found> AsMoment(const std::string& last, const Words& rest) {
  std::string role;
  if (last.size() == 3 && last[0] == 'm') role = last.substr(0, 2) + "_" + last[2];
  if ((last == "y" || last == "z") && !rest.empty()) role = rest.back() + "_" + last;
  for (const char* known : {"m1_y", "m1_z", "m2_y", "m2_z"}) {
    if (role == known) return Found{role, ""};
  }
  return {};
}

// r11, R_11, R_1_1, rot[0][2], T14: "r" and two digits, as they stand.
std::optional<Found> AsMatrix(const Words& words) {
  static const WordSet kNames{"r", "rot", "rotation", "matrix", "m", "t"};
  std::string digits;
  std::size_t i = words.size();
  while (i > 0 && digits.size() < 2 &&
         std::all_of(words[i - 1].begin(), words[i - 1].end(), IsDigit))
    digits.insert(0, words[--i]);
  std::string name;
  if (digits.empty() && i > 0) {
    const std::string& word = words[i - 1];
    const auto begin = word.find_first_of("0123456789");
    if (begin == std::string::npos) return {};
    name = word.substr(0, begin);
    digits = word.substr(begin);
    --i;
  } else if (i > 0) {
    name = words[--i];
  }
  if (digits.size() != 2 || !IsDigit(digits[0]) || !IsDigit(digits[1]) || !kNames.contains(name)) {
    return {};
  }
  if (digits.find_first_of("56789") != std::string::npos) return {};
  return Found{"r" + digits, Join(Words(words.begin(), words.begin() + static_cast<long>(i)))};
}

// q0, quat_3, orientation[1].
std::optional<Found> AsCountedQuaternion(const std::string& last, const Words& rest) {
  if (last.size() == 2 && last[0] == 'q' && last[1] >= '0' && last[1] <= '4') {
    return Found{last, Join(rest, kQuaternions)};
  }
  if (last.size() == 1 && last[0] >= '0' && last[0] <= '4' && !rest.empty() &&
      kQuaternions.contains(rest.back())) {
    return Found{"q" + last, Join(Words(rest.begin(), rest.end() - 1))};
  }
  return {};
}

// tx, PosX, qw, fz: kind and axis in one word.
std::optional<Found> AsOneWord(const std::string& last, const Words& rest) {
  if (last.size() < 2 || !kAxes.contains(std::string(1, last.back()))) return {};
  const std::string kind = last.substr(0, last.size() - 1), axis(1, last.back());
  const bool is_w = axis == "w";
  if (!is_w && (kind == "t" || kind == "p" || kind == "pos")) return Found{axis, Join(rest)};
  if (kind == "q" || kind == "quat") return Found{"q" + axis, Join(rest)};
  if (!is_w && (kind == "f" || kind == "force")) return Found{"f" + axis, Join(rest, kForces)};
  if (!is_w && (kind == "r" || kind == "rot")) return Found{"any" + axis, Join(rest)};
  if (!is_w && (kind == "rv" || kind == "rotvec")) return Found{"r" + axis, Join(rest)};
  return {};
}

std::optional<Found> AsAngle(const std::string& last, const Words& rest) {
  static const std::map<std::string, std::string> by_name{
      {"roll", "ax"}, {"pitch", "ay"}, {"yaw", "az"}};
  const auto found = by_name.find(last);
  if (found == by_name.end()) return {};
  WordSet kinds = kRotations;
  kinds.insert(kQuaternions.begin(), kQuaternions.end());
  kinds.insert("rpy");
  return Found{found->second, Join(rest, kinds)};
}

// The axis alone; a word before it says of what.
std::optional<Found> AsAxis(const std::string& axis, const Words& rest) {
  if (!kAxes.contains(axis)) return {};
  for (auto word = rest.rbegin(); word != rest.rend(); ++word) {
    if (kOthers.contains(*word)) return {};
    Words group(rest.begin(), rest.end());
    group.erase(group.begin() + (rest.rend() - word - 1));
    const bool is_w = axis == "w";
    if (kQuaternions.contains(*word)) return Found{"q" + axis, Join(group)};
    if (is_w) continue;
    if (kPositions.contains(*word)) return Found{axis, Join(group)};
    if (kForces.contains(*word)) return Found{"f" + axis, Join(group)};
    if (kVectors.contains(*word)) return Found{"r" + axis, Join(group)};
    if (*word == "vector" && !group.empty() && kRotations.contains(group.back())) {
      group.pop_back();
      return Found{"r" + axis, Join(group)};
    }
    if (kRotations.contains(*word)) return Found{"any" + axis, Join(group)};
  }
  return Found{"plain" + axis, Join(rest)};
}

std::optional<Found> RoleOfOrdered(const Words& words) {
  if (words.empty()) return {};
  const std::string& last = words.back();
  const Words rest(words.begin(), words.end() - 1);
  if (auto found = AsTime(words, last, rest)) return found;
  if (auto found = AsMoment(last, rest)) return found;
  if (auto found = AsCountedQuaternion(last, rest)) return found;
  if (auto found = AsMatrix(words)) return found;
  if (auto found = AsAngle(last, rest)) return found;
  if (auto found = AsOneWord(last, rest)) return found;
  return AsAxis(last, rest);
}

// x_cmd and pos_x_actual are read as cmd_x and actual_pos_x.
std::optional<Found> RoleOf(Words words) {
  auto found = RoleOfOrdered(words);
  if (found || words.size() < 2) return found;
  std::rotate(words.begin(), words.end() - 1, words.end());
  return RoleOfOrdered(words);
}

bool Has(const Roles& roles, const std::vector<std::string>& names) {
  return std::all_of(names.begin(), names.end(), [&](const auto& n) { return roles.contains(n); });
}

void Rename(Roles& roles, const std::string& from, const std::string& to) {
  auto node = roles.extract(from);
  if (node.empty()) return;
  node.key() = to;
  roles.insert(std::move(node));
}

// x, y, z without a word for their kind are a place; with a w a quaternion.
void NamePlain(Roles& roles) {
  const bool turns = roles.contains("plainw") && !roles.contains("qw");
  for (const char* axis : {"x", "y", "z", "w"}) {
    Rename(roles, std::string("plain") + axis, turns ? std::string("q") + axis : axis);
  }
  roles.erase("w");
}

// Digits from 0 become digits from 1; the fourth column of a pose is the place.
void NameMatrix(Roles& roles) {
  const auto counted_from_0 = [&] {
    return std::any_of(roles.begin(), roles.end(), [](const auto& role) {
      const std::string& n = role.first;
      return n.size() == 3 && n[0] == 'r' && IsDigit(n[1]) && (n[1] == '0' || n[2] == '0');
    });
  };
  Roles named;
  const int first = counted_from_0() ? 0 : 1;
  for (const auto& [name, column] : roles) {
    if (name.size() != 3 || name[0] != 'r' || !IsDigit(name[1])) {
      named.emplace(name, column);
      continue;
    }
    const int row = name[1] - '0' - first, col = name[2] - '0' - first;
    if (row > 2 || col > 3) continue;  // 0 0 0 1
    if (col == 3) {
      named.emplace(std::string(1, "xyz"[row]), column);
    } else {
      named.emplace(fmt::format("r{}{}", row + 1, col + 1), column);
    }
  }
  roles = std::move(named);
}

}  // namespace

NamedColumns NameRoles(const std::vector<std::string>& columns) {
  NamedColumns named;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    std::string name = columns[i], unit;
    const auto bracket = name.find_last_of("[(");
    if (bracket != std::string::npos && bracket > 0 &&
        Trim(name).find_last_of("])") != std::string::npos) {
      const auto end = name.find_last_of("])");
      const std::string inside(Trim(name.substr(bracket + 1, end - bracket - 1)));
      const bool digits = !inside.empty() && std::all_of(inside.begin(), inside.end(), IsDigit);
      if (!digits && end > bracket) {
        unit = inside;
        name.resize(bracket);
      }
    }
    auto found = RoleOf(WordsOf(name));
    const auto mark = name.find_last_of("_ .");
    const std::string suffix = mark == std::string::npos ? "" : name.substr(mark + 1);
    if (unit.empty() && ParseUnit(suffix)) {
      const auto by_shorter = RoleOf(WordsOf(name.substr(0, mark)));
      const bool says_less = !found || found->role.starts_with("plain");
      if (by_shorter && (says_less || found->role == by_shorter->role)) {
        found = by_shorter;
        unit = suffix;
      }
    }
    named.units.push_back(unit);
    if (!found) continue;
    if (found->role == "t" || found->role == "t_s" || found->role == "t_ns") {
      named.times.emplace_back(found->role, i);
      continue;
    }
    auto group = std::find_if(named.groups.begin(), named.groups.end(),
                              [&](const ColumnGroup& g) { return g.name == found->group; });
    if (group == named.groups.end()) {
      group = named.groups.insert(group, ColumnGroup{found->group, {}});
    }
    group->roles.emplace(found->role, i);  // the first of two with one name
  }
  for (ColumnGroup& group : named.groups) {
    NamePlain(group.roles);
    NameMatrix(group.roles);
    // Counted with the axes named: Q0, Qx, Qy, Qz.
    if (Has(group.roles, {"q0", "qx", "qy", "qz"}) && !group.roles.contains("qw")) {
      Rename(group.roles, "q0", "qw");
    }
  }
  return named;
}

}  // namespace flextip::exchange
