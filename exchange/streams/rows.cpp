#include "exchange/streams/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/error.h"
#include "exchange/values/units.h"
#include "recording/text/bounds.h"

namespace flextip::exchange {
namespace {

// No surgical robot reaches metres in one of these units and not in the other: below the first
// number lengths are metres, between the second and the third millimetres.
constexpr double kLargestMetres = 3.0, kLeastMillimetres = 10.0, kLargestMillimetres = 5000.0;
constexpr double kLargestRadians = 3.2, kLeastDegrees = 6.4;
constexpr std::size_t kFewestForRepeats = 10;

double LargestOfKind(const StreamRows& rows, const std::string& kind) {
  double largest = 0.0;
  for (const auto& [role, values] : rows.values) {
    if (UnitKindOf(role) != kind) continue;
    for (const double value : values) largest = std::fmax(largest, std::abs(value));
  }
  return largest;
}

// Empty where the size of the values tells nothing.
std::string UnitBySize(const std::string& kind, double largest) {
  if (kind == "force") return "N";
  if (kind == "moment") return "Nm";
  if (kind == "angle") {
    if (largest <= kLargestRadians) return "rad";
    return largest >= kLeastDegrees ? "deg" : "";
  }
  if (largest <= kLargestMetres) return "m";
  return largest >= kLeastMillimetres && largest <= kLargestMillimetres ? "mm" : "";
}

void FindUnit(const std::string& stream, const std::string& kind, const StreamRows& rows,
              StreamPlan& plan, ImportLog& log) {
  const double largest = LargestOfKind(rows, kind);
  const std::string key = fmt::format("{}.units.{}", stream, kind);
  const std::string unit = UnitBySize(kind, largest);
  if (unit.empty()) {
    throw NotTold(fmt::format("{}: no unit of {} is stated, and the largest value {:.6g} fits none",
                              rows.source, kind, largest),
                  {key});
  }
  plan.units[kind] = unit;
  log.Assume(key, fmt::format("{}: no unit is stated, the largest value is {:.6g}", unit, largest));
}

void CheckBounds(const std::string& role, const std::string& kind,
                 const std::vector<double>& values, const StreamRows& rows) {
  const Bounds bounds = BoundsOf(kind == "length"  ? "_m"
                                 : kind == "angle" ? "_rad"
                                 : kind == "force" ? "_N"
                                                   : "_Nm");
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string expected = ExpectedWithin(bounds, values[i]);
    if (expected.empty() || std::isnan(values[i])) continue;
    throw InputError::At(rows.source, i < rows.places.size() ? rows.places[i] : 0,
                         fmt::format("{}: found {:.6g} {}, expected {}: is it in another unit?",
                                     role, values[i], bounds.unit, expected));
  }
}

}  // namespace

bool IsOrientationRole(const std::string& role) {
  return role[0] == 'q' || role[0] == 'r' || role[0] == 'a';
}

std::string UnitKindOf(const std::string& role) {
  switch (role[0]) {
    case 't':
      return role == "t" ? "time" : "";
    case 'x':
    case 'y':
    case 'z':
      return "length";
    case 'r':
      return role.size() == 2 ? "angle" : "";
    case 'a':
      return "angle";
    case 'f':
      return "force";
    case 'm':
      return "moment";
    default:
      return "";
  }
}

RowTaker::RowTaker(const std::string& stream, std::vector<std::string> roles)
    : roles_(std::move(roles)), orientation_may_lack_(stream == "wrist0") {
  for (const auto& role : roles_) rows_.values[role];
}

// Whether the row can be used. An orientation that may lack becomes NaN as a whole.
bool RowTaker::Complete(std::vector<double>& values) const {
  bool lacks_turn = false, turns = false;
  double quaternion = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool turn = IsOrientationRole(roles_[i]);
    if (std::isnan(values[i])) {
      if (!turn) return false;
      lacks_turn = true;
    } else if (roles_[i][0] == 'q') {
      turns = true;
      quaternion += std::abs(values[i]);
    }
  }
  lacks_turn = lacks_turn || (turns && quaternion == 0.0);
  if (!lacks_turn) return true;
  if (!orientation_may_lack_) return false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (IsOrientationRole(roles_[i])) values[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return true;
}

RowTaker::Outcome RowTaker::Take(TimeNs t_ns, long place, std::vector<double> values) {
  if (!Complete(values)) {
    if (rows_.missing++ == 0) rows_.first_missing = place;
    return Outcome::kMissing;
  }
  if (!rows_.t_ns.empty() && t_ns <= rows_.t_ns.back()) {
    if (t_ns < rows_.t_ns.back()) return Outcome::kBackwards;
    if (rows_.repeated++ == 0) rows_.first_repeated = place;
    return Outcome::kRepeated;
  }
  rows_.t_ns.push_back(t_ns);
  rows_.places.push_back(place);
  for (std::size_t i = 0; i < values.size(); ++i) rows_.values[roles_[i]].push_back(values[i]);
  return Outcome::kTaken;
}

void ToSi(const std::string& stream, StreamRows& rows, StreamPlan& plan, ImportLog& log) {
  for (auto& [role, values] : rows.values) {
    const std::string kind = UnitKindOf(role);
    if (kind.empty()) continue;
    if (!plan.units.contains(kind)) FindUnit(stream, kind, rows, plan, log);
  }
  for (auto& [role, values] : rows.values) {
    const std::string kind = UnitKindOf(role);
    if (kind.empty()) continue;
    const Unit unit = *ParseUnit(plan.units.at(kind), kind);
    for (double& value : values) value = unit.ToSi(value);
    CheckBounds(role, kind, values, rows);
  }
}

void SayRows(const std::string& stream, const StreamRows& rows, ImportLog& log) {
  const std::size_t count = rows.t_ns.size();
  const auto all = static_cast<long>(count) + rows.missing + rows.repeated;
  if (rows.missing > 0) {
    log.Warn(fmt::format("{}: {}: left out {} of {} rows with missing values, the first is {}",
                         stream, rows.source, rows.missing, all, rows.first_missing));
  }
  if (rows.repeated > 0) {
    log.Warn(
        fmt::format("{}: {}: left out {} of {} rows with the time of the row before, the "
                    "first is {}",
                    stream, rows.source, rows.repeated, all, rows.first_repeated));
  }
  std::size_t unchanged = 0;
  for (std::size_t i = 1; i < count; ++i) {
    unchanged += std::all_of(rows.values.begin(), rows.values.end(), [&](const auto& column) {
      return column.second[i] == column.second[i - 1];
    });
  }
  if (rows.values.empty() || count < kFewestForRepeats || 2 * unchanged < count) return;
  log.Warn(
      fmt::format("{}: {} of {} rows repeat the values of the row before: the sensor is "
                  "slower than its table, or stood still",
                  stream, unchanged, count));
}

}  // namespace flextip::exchange
