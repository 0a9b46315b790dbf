// What columns are, by their names.
#include "exchange/tables/column_roles.h"

#include <gmock/gmock.h>

namespace flextip::exchange {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;
using testing::UnorderedElementsAre;

/// The roles of the only group.
Roles OnlyGroup(const std::vector<std::string>& columns) {
  const auto named = NameRoles(columns);
  EXPECT_THAT(named.groups, SizeIs(1));
  return named.groups.empty() ? Roles() : named.groups.front().roles;
}

TEST(ColumnRoles, KnowPlacesAndQuaternions) {
  const std::vector<std::vector<std::string>> tables{
      {"x", "y", "z", "qw", "qx", "qy", "qz"},
      {"px", "py", "pz", "q_w", "q_x", "q_y", "q_z"},
      {"pos_x", "pos_y", "pos_z", "quat_w", "quat_x", "quat_y", "quat_z"},
      {"PosX [mm]", "PosY [mm]", "PosZ [mm]", "QW", "QX", "QY", "QZ"},
      {"Tx", "Ty", "Tz", "Q0", "Qx", "Qy", "Qz"},
      {"position.x", "position.y", "position.z", "orientation.w", "orientation.x", "orientation.y",
       "orientation.z"},
      {"field.pose.position.x", "field.pose.position.y", "field.pose.position.z",
       "field.pose.orientation.w", "field.pose.orientation.x", "field.pose.orientation.y",
       "field.pose.orientation.z"},
      {"p_RS_x [m]", "p_RS_y [m]", "p_RS_z [m]", "q_RS_w []", "q_RS_x []", "q_RS_y []",
       "q_RS_z []"},
      {"tx", "ty", "tz", "w", "x", "y", "z"}};
  const Roles expected{{"x", 0}, {"y", 1}, {"z", 2}, {"qw", 3}, {"qx", 4}, {"qy", 5}, {"qz", 6}};
  for (const auto& columns : tables) EXPECT_EQ(OnlyGroup(columns), expected) << columns.front();
}

TEST(ColumnRoles, KnowOtherRotations) {
  EXPECT_THAT(OnlyGroup({"roll [deg]", "pitch [deg]", "yaw [deg]"}),
              ElementsAre(Pair("ax", 0), Pair("ay", 1), Pair("az", 2)));
  EXPECT_THAT(OnlyGroup({"rotvec_x", "rotvec_y", "rotvec_z"}),
              ElementsAre(Pair("rx", 0), Pair("ry", 1), Pair("rz", 2)));
  EXPECT_THAT(OnlyGroup({"rx", "ry", "rz"}),
              ElementsAre(Pair("anyx", 0), Pair("anyy", 1), Pair("anyz", 2)));
  EXPECT_THAT(OnlyGroup({"r00", "r01", "r02"}),
              ElementsAre(Pair("r11", 0), Pair("r12", 1), Pair("r13", 2)));
  EXPECT_THAT(OnlyGroup({"R_1_1", "R_1_2", "R_3_3"}),
              ElementsAre(Pair("r11", 0), Pair("r12", 1), Pair("r33", 2)));
  EXPECT_THAT(OnlyGroup({"T11", "T14", "T24", "T34", "T44"}),
              ElementsAre(Pair("r11", 0), Pair("x", 1), Pair("y", 2), Pair("z", 3)));
}

TEST(ColumnRoles, KnowForcesMomentsAndTimes) {
  EXPECT_THAT(OnlyGroup({"fx", "fy", "Fz [N]", "torque_x", "mx"}),
              ElementsAre(Pair("fx", 0), Pair("fy", 1), Pair("fz", 2)));
  EXPECT_THAT(OnlyGroup({"wrench.force.x", "wrench.force.y", "wrench.force.z", "wrench.torque.x"}),
              ElementsAre(Pair("fx", 0), Pair("fy", 1), Pair("fz", 2)));
  EXPECT_THAT(OnlyGroup({"m1_y [Nm]", "m1_z", "strain m2_y", "M2z"}),
              ElementsAre(Pair("m1_y", 0), Pair("m1_z", 1), Pair("m2_y", 2), Pair("m2_z", 3)));
  EXPECT_THAT(NameRoles({"t", "Time [ms]", "timestamp_ns", "%time", "header.stamp.sec",
                         "header.stamp.nanosec", "seq"})
                  .times,
              ElementsAre(Pair("t", 0), Pair("t", 1), Pair("t", 2), Pair("t", 3), Pair("t_s", 4),
                          Pair("t_ns", 5)));
}

TEST(ColumnRoles, TakeUnitsFromNames) {
  EXPECT_THAT(NameRoles({"x [mm]", "x (mm)", "x_mm", "t_s", "fx_mN", "x"}).units,
              ElementsAre("mm", "mm", "mm", "s", "mN", ""));
}

TEST(ColumnRoles, KeepThingsApart) {
  const auto named = NameRoles({"wrist_x", "wrist_y", "wrist_z", "cmd_x", "cmd_y", "cmd_z"});
  ASSERT_THAT(named.groups, SizeIs(2));
  EXPECT_EQ(named.groups[0].name, "wrist");
  EXPECT_EQ(named.groups[1].name, "cmd");
}

TEST(ColumnRoles, LeaveOutWhatIsNoPose) {
  EXPECT_THAT(
      NameRoles({"vel_x", "twist.linear.y", "acc_z", "covariance0", "frame", "temperature"}).groups,
      IsEmpty());
}

}  // namespace
}  // namespace flextip::exchange
