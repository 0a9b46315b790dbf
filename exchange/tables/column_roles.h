// What the columns of a table are, by their names.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace flextip::exchange {

/// Roles: t, or t_s and t_ns (whole seconds and nanoseconds); x, y, z; qw, qx, qy, qz; q0 .. q4 (an
/// order to be told); r11 .. r33 (a matrix); rx, ry, rz (a rotation vector); ax, ay, az (angles
/// about the axes); anyx, anyy, anyz (a rotation, of no stated kind); fx, fy, fz; m1_y, m1_z, m2_y,
/// m2_z.
using Roles = std::map<std::string, std::size_t>;  ///< role -> column

/// Columns of one thing: "em_pos_x", "em_q_w" are of the group "em".
struct ColumnGroup {
  std::string name;
  Roles roles;
};

struct NamedColumns {
  std::vector<ColumnGroup> groups;
  std::vector<std::pair<std::string, std::size_t>> times;  ///< role (t, t_s, t_ns) and column
  std::vector<std::string> units;                          ///< of each column, as written
};

NamedColumns NameRoles(const std::vector<std::string>& columns);

}  // namespace flextip::exchange
