#include "exchange/tables/stream_needs.h"

#include <algorithm>

#include "exchange/streams/names.h"

namespace flextip::exchange {

StreamNeeds NeedsOf(const std::string& stream) {
  if (stream == "strain0") return {kMomentRoles};
  if (stream == "load0") return {kForceRoles};
  if (stream == "command0") return {kPlaceRoles};
  if (stream == "em1") return {{}, true, true};
  if (IsCamera(stream)) return {};
  return {kPlaceRoles, true, stream == "em0"};
}

bool HasAll(const Roles& roles, const RoleNames& names) {
  return std::all_of(names.begin(), names.end(), [&](const auto& n) { return roles.contains(n); });
}

bool HasOrientation(const Roles& roles) {
  for (const auto* names :
       {&kQuaternionRoles, &kMatrixRoles, &kVectorRoles, &kAngleRoles, &kAnyTurnRoles}) {
    if (HasAll(roles, *names)) return true;
  }
  return HasAll(roles, {"q0", "q1", "q2", "q3"}) || HasAll(roles, {"q1", "q2", "q3", "q4"});
}

void KeepOnly(Roles& roles, const RoleNames& names) {
  std::erase_if(roles, [&](const auto& role) {
    return std::find(names.begin(), names.end(), role.first) == names.end();
  });
}

}  // namespace flextip::exchange
