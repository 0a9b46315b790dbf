// The roles that each stream needs of a table's columns.
#pragma once

#include <string>
#include <vector>

#include "exchange/tables/column_roles.h"

namespace flextip::exchange {

using RoleNames = std::vector<std::string>;

inline const RoleNames kPlaceRoles{"x", "y", "z"};
inline const RoleNames kQuaternionRoles{"qw", "qx", "qy", "qz"};
inline const RoleNames kMatrixRoles{"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"};
inline const RoleNames kVectorRoles{"rx", "ry", "rz"};
inline const RoleNames kAngleRoles{"ax", "ay", "az"};
inline const RoleNames kAnyTurnRoles{"anyx", "anyy", "anyz"};  ///< a rotation of no stated kind
inline const RoleNames kForceRoles{"fx", "fy", "fz"};
inline const RoleNames kMomentRoles{"m1_y", "m1_z", "m2_y", "m2_z"};

/// What a stream is made of.
struct StreamNeeds {
  RoleNames values;  ///< without which there is no stream
  bool orientation = false, needs_orientation = false;
};

StreamNeeds NeedsOf(const std::string& stream);  ///< cam0: times alone
bool HasAll(const Roles& roles, const RoleNames& names);
bool HasOrientation(const Roles& roles);
void KeepOnly(Roles& roles, const RoleNames& names);

}  // namespace flextip::exchange
