// Tables that cannot be used are refused with file, line, value and what was expected.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "exchange/streams/sensor_settings.h"
#include "tests/exchange/tables.h"
#include "tests/recording/sample_recording.h"

namespace flextip::exchange {
namespace {

using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteText;
using test_support::PlanWithSettings;
using test_support::Refusal;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class Refusals : public testing::Test {
 protected:
  ImportPlan Plan(const std::string& text, const std::string& stream = "wrist0") {
    WriteText(folder_ / "a.csv", text);
    ImportPlan plan = PlanWithSettings();
    plan.streams[stream].file = folder_ / "a.csv";
    TellSensor(plan, "test", "wrist0", "position_noise_m", "1e-4");
    TellSensor(plan, "test", "wrist0", "orientation_noise_rad", "1e-3");
    TellSensor(plan, "test", "load0", "force_noise_N", "0.01");
    return plan;
  }
  std::string Of(const std::string& text, const std::string& stream = "wrist0") {
    return Refusal(Plan(text, stream));
  }

 protected:
  TemporaryFolder folder_;
};

const std::string kHead = "t [s],x [m],y [m],z [m]\n";

TEST_F(Refusals, WrongValues) {
  EXPECT_THAT(Of(kHead + "0,1,2,3\n0.1,1,oops,3\n0.2,1,2,3\n"),
              HasSubstr("a.csv:3: column \"y [m]\": found \"oops\", expected a finite number"));
  EXPECT_THAT(Of(kHead + "0,1,2,3\n0.1,1,inf,3\n"), HasSubstr("a.csv:3: column \"y [m]\""));
  EXPECT_THAT(Of(kHead + "0,1,2,3\nsoon,1,2,3\n"),
              HasSubstr("column \"t [s]\": found \"soon\", expected a time in s"));
  EXPECT_THAT(Of(kHead + "0,1,2,3\n0.1,1,2\n0.2,1,2,3\n"),
              HasSubstr("a.csv:3: found 3 fields, expected 4"));
}

TEST_F(Refusals, TimeThatDoesNotRun) {
  EXPECT_THAT(Of(kHead + "0,1,2,3\n0.2,1,2,3\n0.1,1,2,3\n"),
              HasSubstr("a.csv:4: time runs backwards: found \"0.1\", expected more than that of "
                        "line 3"));
}

TEST_F(Refusals, RowsWithTheSameTimeAreLeftOutAndCounted) {
  const Imported imported =
      Import(Plan(kHead + "0,1,2,3\n0.1,1,2,4\n0.1,1,2,4\n0.1,1,2,5\n0.2,1,2,3\n"));
  ASSERT_EQ(imported.recording.wrist0->samples.size(), 3U);
  EXPECT_EQ(imported.recording.wrist0->samples[1].value.p_RW.z(), 4.0);
  EXPECT_EQ(imported.skipped.at("wrist0"), 2);
  EXPECT_THAT(imported.log.warnings,
              testing::Contains(HasSubstr("left out 2 of 5 rows with the time of the row before, "
                                          "the first is 4")));
}

TEST_F(Refusals, RowsWithMissingValuesAreLeftOutAndCounted) {
  const Imported imported = Import(
      Plan(kHead +
           "0,1,2,3\n0.1,nan,2,4\n0.2,1,,4\n0.3,1,2,MISSING\n0.4,1,2,-3.697314e28\n0.5,1,2,3\n"));
  EXPECT_EQ(imported.recording.wrist0->samples.size(), 2U);
  EXPECT_EQ(imported.skipped.at("wrist0"), 4);
  EXPECT_THAT(imported.log.warnings,
              testing::Contains(HasSubstr("left out 4 of 6 rows with missing values, the first is "
                                          "3")));
  EXPECT_THAT(Of(kHead + "0,nan,2,3\n0.1,1,,3\n"), HasSubstr("no samples"));
}

TEST_F(Refusals, AWristWithoutItsOrientationStays) {
  const std::string text =
      "t [s],x [m],y [m],z [m],qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n0.1,1,2,3,,,,\n0.2,1,2,3,0,0,0,0\n";
  const Imported imported = Import(Plan(text));
  ASSERT_EQ(imported.recording.wrist0->samples.size(), 3U);
  EXPECT_TRUE(imported.recording.wrist0->samples[0].value.q_RW);
  EXPECT_FALSE(imported.recording.wrist0->samples[1].value.q_RW);
  EXPECT_FALSE(imported.recording.wrist0->samples[2].value.q_RW);
}

TEST_F(Refusals, RotationsThatAreNone) {
  const std::string quaternion = "t [s],x [m],y [m],z [m],qw,qx,qy,qz\n";
  EXPECT_THAT(Of(quaternion + "0,1,2,3,1,0,0,0\n0.1,1,2,3,1,0,0,0.5\n"),
              HasSubstr("a.csv:3: the quaternion has length 1.1"));
  const std::string matrix = "t [s],x [m],y [m],z [m],r11,r12,r13,r21,r22,r23,r31,r32,r33\n";
  EXPECT_THAT(Of(matrix + "0,1,2,3,1,0,0,0,1,0,0,0,-1\n"),
              HasSubstr("a.csv:2: R'R is off the identity by 0 and det R is -1"));
}

TEST_F(Refusals, WhatNothingTells) {
  const auto keys = [](const ImportPlan& plan) {
    try {
      Import(plan);
    } catch (const NotTold& error) {
      std::vector<std::string> all;
      for (const auto& missing : error.missing()) {
        all.insert(all.end(), missing.keys.begin(), missing.keys.end());
      }
      return all;
    }
    return std::vector<std::string>();
  };
  EXPECT_THAT(keys(Plan("0,1,2,3,1,0,0,0\n0.1,1,2,3,1,0,0,0\n")), ElementsAre("wrist0.quaternion"));
  EXPECT_THAT(keys(Plan("t,x,y,z,rx,ry,rz\n0,1,2,3,0,0,0\n0.1,1,2,3,0,0,0\n")),
              ElementsAre("wrist0.orientation"));
  EXPECT_THAT(keys(Plan("t,x,y,z\n0,1,2,3\n1,1,2,3\n2,1,2,4\n")), ElementsAre("wrist0.units.time"));
  EXPECT_THAT(keys(Plan("t,x [furlong],y,z\n0,1,2,3\n0.1,1,2,3\n")),
              ElementsAre("wrist0.units.length"));
  EXPECT_THAT(keys(Plan("a,x,y,z\n0,1,2,3\n0.1,1,2,3\n")), ElementsAre("wrist0.columns.t"));
  EXPECT_THAT(keys(Plan("t,x,y,h\n0,1,2,3\n0.1,1,2,3\n")),
              ElementsAre("wrist0.columns.x", "wrist0.columns.y", "wrist0.columns.z"));
  EXPECT_THAT(keys(Plan(kHead + "0,1,2,3\n0.1,1,2,3\n", "em0")),
              ElementsAre("em0.columns.qw", "em0.columns.qx", "em0.columns.qy", "em0.columns.qz"));
  EXPECT_THAT(keys(Plan("t,a_x,a_y,a_z,b_x,b_y,b_z\n0,1,2,3,1,2,3\n0.1,1,2,3,1,2,3\n")),
              ElementsAre("wrist0.columns.x"));
  EXPECT_THAT(keys(Plan("t [s],x,y,z\n0,1,2,5\n0.1,1,2,5\n")), ElementsAre("wrist0.units.length"));
  ImportPlan bare = Plan(kHead + "0,1,2,3\n0.1,1,2,3\n");
  bare.length_m.reset();
  bare.p_RP.reset();
  EXPECT_THAT(keys(bare), ElementsAre("instrument.length_m", "port.position_m"));
  ImportPlan short_table = Plan(kHead + "0,1,2,3\n0.1,1,2,3\n");
  short_table.sensors.clear();
  EXPECT_THAT(keys(short_table), ElementsAre("sensors.wrist0.position_noise_m"));
  ImportPlan several = Plan("0,1,2,3,1,0,0,0\n0.1,1,2,3,1,0,0,0\n", "em0");
  several.sensors.clear();
  several.length_m.reset();
  EXPECT_THAT(keys(several), ElementsAre("instrument.length_m", "sensors.em0.distance_from_tip_m",
                                         "em0.quaternion"));
  ImportPlan nameless = PlanWithSettings();
  WriteText(folder_ / "data.csv", kHead + "0,1,2,3\n0.1,1,2,3\n");
  nameless.tables = {folder_ / "data.csv"};
  EXPECT_THAT(keys(nameless), ElementsAre("streams"));
}

TEST_F(Refusals, WrongTellings) {
  ImportPlan plan = Plan(kHead + "0,1,2,3\n0.1,1,2,3\n");
  plan.streams["wrist0"].columns["x"] = "Tx";
  EXPECT_THAT(Refusal(plan),
              AllOf(HasSubstr("wrist0.x: found no column \"Tx\""), HasSubstr("t [s], x [m]")));
  plan.streams["wrist0"].columns = {{"height", "x"}};
  EXPECT_THAT(Refusal(plan), HasSubstr("found the column's role \"height\", expected one of"));
  plan.streams["wrist0"].columns.clear();
  plan.streams["wrist0"].orientation = "euler-zz";
  EXPECT_THAT(Refusal(plan), HasSubstr("found the orientation \"euler-zz\""));
  const auto tell = [&](const char* stream, const char* key, const char* value) {
    try {
      TellSensor(plan, "--set", stream, key, value);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_THAT(tell("em0", "position_noise", "1"), HasSubstr("em0 has no setting"));
  EXPECT_THAT(tell("em0", "position_noise_m", "-1"), HasSubstr("expected a number not below 0"));
  EXPECT_THAT(tell("em0", "noise_distribution", "flat"), HasSubstr("gaussian or uniform"));
  EXPECT_THAT(tell("em7", "position_noise_m", "1"), HasSubstr("found the stream \"em7\""));
  EXPECT_EQ(tell("strain0", "stations_from_wrist_m", "0.1, 0.5"), "taken");
}

TEST_F(Refusals, ColumnsOfOneKindInTwoUnits) {
  EXPECT_THAT(Of("t [s],x [m],y [mm],z [m]\n0,1,2,3\n0.1,1,2,3\n"),
              HasSubstr("expected one unit of length"));
}

TEST_F(Refusals, ClocksApartAreSaid) {
  WriteText(folder_ / "f.csv", "t [s],fx [N],fy [N],fz [N]\n900,1,2,3\n900.1,1,2,4\n900.2,1,2,3\n");
  ImportPlan plan = Plan(kHead + "0,1,2,3\n0.1,1,2,3\n");
  plan.streams["load0"].file = folder_ / "f.csv";
  EXPECT_THAT(Import(plan).log.warnings,
              testing::Contains(HasSubstr("wrist0 and load0 have no time in common")));
}

}  // namespace
}  // namespace flextip::exchange
