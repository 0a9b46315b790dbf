#include "exchange/tables/orientation_columns.h"

#include <fmt/format.h>

#include <algorithm>

#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

bool IsEuler(const std::string& orientation) {
  if (orientation.size() != 9 || !orientation.starts_with("euler-")) return false;
  std::string axes = orientation.substr(6);
  std::sort(axes.begin(), axes.end());
  return axes == "xyz";
}

bool IsQuaternionRole(const std::string& role) { return role.size() == 2 && role[0] == 'q'; }

// The order of the four columns of a quaternion: as told, else by what counts them.
void OrderQuaternion(const std::string& stream, const DelimitedTable& table, StreamPlan& plan,
                     Roles& roles, ImportLog& log) {
  std::vector<std::size_t> columns;
  for (const auto& [role, column] : roles) {
    if (IsQuaternionRole(role)) columns.push_back(column);
  }
  if (columns.size() != 4) return;
  if (plan.quaternion.empty() && HasAll(roles, kQuaternionRoles)) return;
  if (plan.quaternion.empty() && table.has_header() && roles.contains("q0")) {
    plan.quaternion = "wxyz";
    log.Assume(stream + ".quaternion", "wxyz: the column of number 0 is taken for the scalar");
  }
  if (plan.quaternion.empty()) {
    throw NotTold(fmt::format("{}: the order of the quaternion's columns is not known, expected "
                              "wxyz or xyzw",
                              table.file()),
                  {stream + ".quaternion"});
  }
  std::sort(columns.begin(), columns.end());
  std::erase_if(roles, [](const auto& role) { return IsQuaternionRole(role.first); });
  for (std::size_t i = 0; i < 4; ++i) roles[std::string("q") + plan.quaternion[i]] = columns[i];
}

// Columns that may be angles or a vector become those that are told.
void NameAnyTurn(const DelimitedTable& table, const std::string& stream, const std::string& kind,
                 Roles& roles) {
  if (kind != "rotation-vector" && !IsEuler(kind)) {
    throw NotTold(fmt::format("{}: the columns of the rotation do not say what they are, expected "
                              "rotation-vector or euler-zyx (any order of three axes)",
                              table.file()),
                  {stream + ".orientation"});
  }
  const char letter = kind == "rotation-vector" ? 'r' : 'a';
  for (const auto& role : kAnyTurnRoles) {
    roles[std::string{letter, role.back()}] = roles.at(role);
  }
}

}  // namespace

void CheckOrientationKind(const std::string& stream, const StreamPlan& plan) {
  const std::string& kind = plan.orientation;
  if (kind.empty() || kind == "quaternion" || kind == "matrix" || kind == "rotation-vector" ||
      IsEuler(kind)) {
    return;
  }
  throw InputError(
      fmt::format("{}: found the orientation {}, expected quaternion, matrix, "
                  "rotation-vector or euler-zyx (any order of three axes)",
                  stream, Quoted(kind)));
}

void ChooseOrientation(const std::string& stream, const DelimitedTable& table, StreamPlan& plan,
                       Roles& roles, ImportLog& log) {
  OrderQuaternion(stream, table, plan, roles, log);
  const std::string told = plan.orientation;
  const auto has = [&](const std::string& kind, const RoleNames& names) {
    return (told.empty() || told == kind) && HasAll(roles, names);
  };
  const auto keep = [&](const std::string& kind, RoleNames names) {
    plan.orientation = kind;
    names.insert(names.end(), kPlaceRoles.begin(), kPlaceRoles.end());
    KeepOnly(roles, names);
  };
  if (has("quaternion", kQuaternionRoles)) return keep("quaternion", kQuaternionRoles);
  if (has("matrix", kMatrixRoles)) return keep("matrix", kMatrixRoles);
  if (has("rotation-vector", kVectorRoles)) return keep("rotation-vector", kVectorRoles);
  if ((told.empty() || IsEuler(told)) && HasAll(roles, kAngleRoles)) {
    if (told.empty()) {
      log.Assume(stream + ".orientation",
                 "euler-zyx: R = Rz(yaw) Ry(pitch) Rx(roll), as in ROS and URDF");
    }
    return keep(told.empty() ? "euler-zyx" : told, kAngleRoles);
  }
  if (HasAll(roles, kAnyTurnRoles)) {
    NameAnyTurn(table, stream, told, roles);
    return keep(told, told == "rotation-vector" ? kVectorRoles : kAngleRoles);
  }
  if (!told.empty()) {
    throw InputError::At(table.file(), 1,
                         fmt::format("{}: found no columns of a {}", stream, told));
  }
  KeepOnly(roles, kPlaceRoles);
}

}  // namespace flextip::exchange
