// One known motion in the dialects of other programs: every import gives the same stream, to
// 1e-12 and 1 ns.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <ctime>
#include <functional>
#include <numbers>

#include "recording/recording_reader.h"
#include "tests/exchange/tables.h"
#include "tests/recording/sample_recording.h"

namespace flextip::exchange {
namespace {

using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteText;
using test_support::Digits;
using test_support::KnownMotion;
using test_support::PlanWithSettings;
using test_support::PoseRow;

struct PoseDialect {
  std::string name, head;
  std::function<std::string(const PoseRow&)> row;
  std::function<void(StreamPlan&)> tell = [](StreamPlan&) {};
};

std::string Joined(const std::vector<std::string>& fields, const std::string& separator,
                   const std::string& end = "\n") {
  return fmt::format("{}{}", fmt::join(fields, separator), end);
}

std::string Seconds(TimeNs t_ns) {
  return fmt::format("{}.{:09}", t_ns / 1'000'000'000, t_ns % 1'000'000'000);
}

std::string Clock(TimeNs t_ns) {
  const std::time_t seconds = t_ns / 1'000'000'000;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &utc);
  return fmt::format("{}.{:09}Z", text, t_ns % 1'000'000'000);
}

std::string WithComma(std::string text) {
  for (char& c : text)
    if (c == '.') c = ',';
  return text;
}

std::vector<std::string> Texts(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(Digits(value));
  return texts;
}

// The time, then values, as texts.
std::vector<std::string> Fields(const std::string& time, const std::vector<double>& values) {
  std::vector<std::string> fields = Texts(values);
  fields.insert(fields.begin(), time);
  return fields;
}

std::vector<double> Wxyz(const PoseRow& r, double scale = 1.0) {
  return {scale * r.p.x(), scale * r.p.y(), scale * r.p.z(), r.q.w(), r.q.x(), r.q.y(), r.q.z()};
}
std::vector<double> Xyzw(const PoseRow& r, double scale = 1.0) {
  return {scale * r.p.x(), scale * r.p.y(), scale * r.p.z(), r.q.x(), r.q.y(), r.q.z(), r.q.w()};
}

std::vector<PoseDialect> PoseDialects() {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  std::vector<PoseDialect> all;
  all.push_back({"plain", "t,x,y,z,qw,qx,qy,qz\n",
                 [](const PoseRow& r) { return Joined(Fields(Seconds(r.t_ns), Wxyz(r)), ","); }});
  all.push_back({"spreadsheet with decimal commas, BOM and CRLF",
                 "\xEF\xBB\xBFtime [s];x [mm];y [mm];z [mm];qw;qx;qy;qz\r\n", [](const PoseRow& r) {
                   return WithComma(Joined(Fields(Seconds(r.t_ns), Wxyz(r, 1e3)), ";", "\r\n"));
                 }});
  all.push_back({"tracker with tabs", "timestamp_ns\tQ0\tQx\tQy\tQz\tTx (mm)\tTy (mm)\tTz (mm)\n",
                 [](const PoseRow& r) {
                   return Joined(Fields(std::to_string(r.t_ns),
                                        {r.q.w(), r.q.x(), r.q.y(), r.q.z(), 1e3 * r.p.x(),
                                         1e3 * r.p.y(), 1e3 * r.p.z()}),
                                 "\t");
                 }});
  all.push_back({"TUM", "# ground truth\n# timestamp tx ty tz qx qy qz qw\n",
                 [](const PoseRow& r) { return Joined(Fields(Seconds(r.t_ns), Xyzw(r)), " "); }});
  all.push_back({"quoted, decimal commas",
                 "\"Time (s)\",\"x\",\"y\",\"z\",\"qx\",\"qy\",\"qz\",\"qw\"\n",
                 [](const PoseRow& r) {
                   auto fields = Fields(Seconds(r.t_ns), Xyzw(r));
                   for (auto& field : fields) field = fmt::format("\"{}\"", WithComma(field));
                   return Joined(fields, ",");
                 }});
  all.push_back({"no header", "",
                 [](const PoseRow& r) { return Joined(Fields(Seconds(r.t_ns), Xyzw(r)), ", "); },
                 [](StreamPlan& plan) { plan.quaternion = "xyzw"; }});
  all.push_back({"ROS topic",
                 "%time,field.header.seq,field.header.stamp,field.pose.position.x,"
                 "field.pose.position.y,field.pose.position.z,field.pose.orientation.x,"
                 "field.pose.orientation.y,field.pose.orientation.z,field.pose.orientation.w\n",
                 [](const PoseRow& r) {
                   return fmt::format("{},7,{}", r.t_ns + 1'234'567,
                                      Joined(Fields(std::to_string(r.t_ns), Xyzw(r)), ","));
                 }});
  all.push_back({"ROS 2 topic",
                 "header.stamp.sec,header.stamp.nanosec,pose.position.x,pose.position.y,"
                 "pose.position.z,pose.orientation.x,pose.orientation.y,pose.orientation.z,"
                 "pose.orientation.w\n",
                 [](const PoseRow& r) {
                   return fmt::format(
                       "{},{}", r.t_ns / 1'000'000'000,
                       Joined(Fields(std::to_string(r.t_ns % 1'000'000'000), Xyzw(r)), ","));
                 }});
  all.push_back({"clock texts", "stamp;pos_x;pos_y;pos_z;q0;q1;q2;q3\n",
                 [](const PoseRow& r) { return Joined(Fields(Clock(r.t_ns), Wxyz(r)), ";"); }});
  all.push_back({"matrix, milliseconds", "time_ms,r11,r12,r13,r21,r22,r23,r31,r32,r33,px,py,pz\n",
                 [](const PoseRow& r) {
                   const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> R = r.q.toRotationMatrix();
                   std::vector<double> values(R.data(), R.data() + 9);
                   values.insert(values.end(), {r.p.x(), r.p.y(), r.p.z()});
                   const std::string ms =
                       fmt::format("{}.{:06}", r.t_ns / 1'000'000, r.t_ns % 1'000'000);
                   return Joined(Fields(ms, values), ",");
                 }});
  all.push_back({"rotation vector in degrees",
                 "t [us],x_m,y_m,z_m,rotvec_x [deg],rotvec_y [deg],rotvec_z [deg]\n",
                 [](const PoseRow& r) {
                   const Eigen::AngleAxisd turn(r.q);
                   const Eigen::Vector3d w = kDegrees * turn.angle() * turn.axis();
                   const std::string us = fmt::format("{}.{:03}", r.t_ns / 1000, r.t_ns % 1000);
                   return Joined(Fields(us, {r.p.x(), r.p.y(), r.p.z(), w.x(), w.y(), w.z()}), ",");
                 }});
  all.push_back(
      {"roll, pitch, yaw with a row of units and lines above",
       "Robot log\nv 1.2\nTime,X,Y,Z,Roll,Pitch,Yaw\ns,mm,mm,mm,deg,deg,deg\n",
       [](const PoseRow& r) {
         const Eigen::Matrix3d R = r.q.toRotationMatrix();
         const double pitch = -std::asin(R(2, 0)), roll = std::atan2(R(2, 1), R(2, 2)),
                      yaw = std::atan2(R(1, 0), R(0, 0));
         return "# row\n" +
                Joined(Fields(Seconds(r.t_ns), {1e3 * r.p.x(), 1e3 * r.p.y(), 1e3 * r.p.z(),
                                                kDegrees * roll, kDegrees * pitch, kDegrees * yaw}),
                       ",");
       }});
  all.push_back(
      {"our own",
       "#timestamp [ns],p_RS_x [m],p_RS_y [m],p_RS_z [m],q_RS_w [],q_RS_x [],"
       "q_RS_y [],q_RS_z []\n",
       [](const PoseRow& r) { return Joined(Fields(std::to_string(r.t_ns), Wxyz(r)), ","); }});
  all.push_back({"4 x 4 matrix counted from 0, no units",
                 "timestamp,m00,m01,m02,m03,m10,m11,m12,m13,m20,m21,m22,m23,m30,m31,m32,m33,\n",
                 [](const PoseRow& r) {
                   const Eigen::Matrix3d R = r.q.toRotationMatrix();
                   std::vector<double> values;
                   for (int i = 0; i < 3; ++i) {
                     for (int j = 0; j < 3; ++j) values.push_back(R(i, j));
                     values.push_back(1e3 * r.p[i]);
                   }
                   values.insert(values.end(), {0, 0, 0, 1});
                   return Joined(Fields(std::to_string(r.t_ns), values), ",", ",\n");
                 }});
  return all;
}

TEST(Dialects, AllGiveTheSameStream) {
  const auto motion = KnownMotion();
  const auto dialects = PoseDialects();
  EXPECT_GE(dialects.size(), 12U);
  for (const auto& dialect : dialects) {
    SCOPED_TRACE(dialect.name);
    const TemporaryFolder folder;
    std::string text = dialect.head;
    for (const auto& row : motion) text += dialect.row(row);
    WriteText(folder / "table.csv", text);
    ImportPlan plan = PlanWithSettings();
    plan.streams["em0"].file = folder / "table.csv";
    dialect.tell(plan.streams["em0"]);
    Imported imported;
    ASSERT_NO_THROW(imported = Import(plan));
    const auto& samples = imported.recording.em0->samples;
    ASSERT_EQ(samples.size(), motion.size());
    for (std::size_t i = 0; i < motion.size(); ++i) {
      EXPECT_LE(std::abs(samples[i].t_ns - motion[i].t_ns), 1);
      EXPECT_LE((samples[i].value.p_RS - motion[i].p).cwiseAbs().maxCoeff(), 1e-12);
      const double sign = samples[i].value.q_RS.dot(motion[i].q) < 0 ? -1.0 : 1.0;
      EXPECT_LE((samples[i].value.q_RS.coeffs() - sign * motion[i].q.coeffs()).norm(), 1e-12);
    }
    // The recording on the disk has the same bits.
    WriteImported(folder / "recording", imported);
    const auto read = ReadRecording(folder / "recording");
    EXPECT_TRUE(read.warnings.empty());
    ASSERT_EQ(read.recording.em0->samples.size(), samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      EXPECT_EQ(read.recording.em0->samples[i].t_ns, samples[i].t_ns);
      EXPECT_EQ(read.recording.em0->samples[i].value.p_RS, samples[i].value.p_RS);
    }
  }
}

TEST(Dialects, AssumptionsAreSaid) {
  const TemporaryFolder folder;
  std::string text = "t,x,y,z,q0,q1,q2,q3\n";
  for (const auto& row : KnownMotion()) {
    text += Joined(Fields(Seconds(row.t_ns), Wxyz(row, 1e3)), ",");
  }
  WriteText(folder / "aurora.csv", text);
  ImportPlan plan = PlanWithSettings();
  plan.tables = {folder / "aurora.csv"};
  const Imported imported = Import(plan);
  ASSERT_TRUE(imported.recording.em0);
  for (const char* key :
       {"em0.file", "em0.columns", "em0.quaternion", "em0.units.length", "em0.units.time",
        "em0.axis", "em0.position_noise_m", "em0.orientation_noise_rad", "gravity_m_s2",
        "instrument.mass_per_length_kg_m"}) {
    EXPECT_TRUE(imported.log.assumed.contains(key)) << key;
  }
  EXPECT_THAT(imported.log.assumed.at("em0.units.length"), testing::StartsWith("mm"));
  EXPECT_NEAR(imported.recording.em0->position_noise_m, 1e-4, 3e-5);
  EXPECT_NEAR(imported.recording.em0->orientation_noise_rad, 1e-3, 4e-4);
  EXPECT_NEAR(imported.recording.em0->rate_hz, 50.0, 0.5);
}

TEST(Dialects, OneTableMayHoldSeveralStreams) {
  const TemporaryFolder folder;
  std::string text = "t,wrist_x,wrist_y,wrist_z,cmd_x,cmd_y,cmd_z,fx,fy,fz,m1_y,m1_z,m2_y,m2_z\n";
  const auto motion = KnownMotion();
  for (const auto& row : motion) {
    const auto& p = row.p;
    text +=
        Joined(Fields(Seconds(row.t_ns), {p.x(), p.y(), p.z(), 2 * p.x(), p.y(), p.z(), 3 * p.x(),
                                          p.y(), p.z(), 4 * p.x(), p.y(), p.z(), 0.5 * p.x()}),
               ",");
  }
  WriteText(folder / "log.csv", text);
  ImportPlan plan = PlanWithSettings();
  plan.tables = {folder / "log.csv"};
  plan.sensors["strain0"].numbers["stations_from_wrist_m"] = {0.12, 0.5};
  const Recording r = Import(plan).recording;
  ASSERT_TRUE(r.wrist0 && r.command0 && r.load0 && r.strain0);
  EXPECT_FALSE(r.em0);
  EXPECT_EQ(r.wrist0->samples[5].value.p_RW, motion[5].p);
  EXPECT_FALSE(r.wrist0->samples[5].value.q_RW);
  EXPECT_EQ(r.command0->p_RW[5].value.x(), 2 * motion[5].p.x());
  EXPECT_EQ(r.load0->f_tip_N[5].value.x(), 3 * motion[5].p.x());
  EXPECT_EQ(r.strain0->moments_Nm[5].value[3], 0.5 * motion[5].p.x());
}

TEST(Dialects, ToldColumnsUnitsAndOffsetsCount) {
  const TemporaryFolder folder;
  std::string text;
  const auto motion = KnownMotion();
  for (const auto& row : motion) {
    text +=
        Joined(Fields(Seconds(row.t_ns), {100 * row.p.z(), 100 * row.p.y(), 100 * row.p.x()}), ",");
  }
  WriteText(folder / "a.csv", text);
  ImportPlan plan = PlanWithSettings();
  StreamPlan& stream = plan.streams["wrist0"];
  stream.file = folder / "a.csv";
  stream.columns = {{"x", "4"}, {"y", "3"}, {"z", "2"}};
  stream.units["length"] = "cm";
  stream.offset_ns = -1'500'000'000;
  const Recording r = Import(plan).recording;
  EXPECT_EQ(r.wrist0->samples[3].t_ns, motion[3].t_ns - 1'500'000'000);
  EXPECT_LE((r.wrist0->samples[3].value.p_RW - motion[3].p).norm(), 1e-12);
}

TEST(Dialects, ColumnsMayBeNamedFromBehind) {
  const TemporaryFolder folder;
  std::string text = "t [s],x_actual [m],y_actual [m],z_actual [m],x_cmd,y_cmd,z_cmd,x_err\n";
  for (const auto& row : KnownMotion()) {
    const auto& p = row.p;
    text +=
        Joined(Fields(Seconds(row.t_ns), {p.x(), p.y(), p.z(), 2 * p.x(), p.y(), p.z(), 0.0}), ",");
  }
  WriteText(folder / "robot.csv", text);
  ImportPlan plan = PlanWithSettings();
  plan.tables = {folder / "robot.csv"};
  const Imported imported = Import(plan);
  ASSERT_TRUE(imported.recording.wrist0 && imported.recording.command0);
  const double x = imported.recording.wrist0->samples[7].value.p_RW.x();
  EXPECT_EQ(imported.recording.command0->p_RW[7].value.x(), 2 * x);
  EXPECT_THAT(imported.log.warnings, testing::Contains(testing::HasSubstr("not used: x_err")));
}

TEST(Dialects, AFrameMayHaveAnotherAxisAlongTheShaft) {
  const TemporaryFolder folder;
  const auto motion = KnownMotion();
  std::string text = "t [s],x [m],y [m],z [m],qw,qx,qy,qz\n";
  for (const auto& row : motion) text += Joined(Fields(Seconds(row.t_ns), Wxyz(row)), ",");
  WriteText(folder / "aurora.csv", text);
  for (const char* axis : {"x", "-x", "y", "-y", "z", "-z"}) {
    ImportPlan plan = PlanWithSettings();
    plan.streams["em0"].file = folder / "aurora.csv";
    plan.streams["em0"].axis = axis;
    const Imported imported = Import(plan);
    EXPECT_FALSE(imported.log.assumed.contains("em0.axis"));
    const Eigen::Vector3d along =
        (axis[0] == '-' ? -1.0 : 1.0) * Eigen::Vector3d::Unit(std::string(axis).back() - 'x');
    for (std::size_t i = 0; i < motion.size(); ++i) {
      const Eigen::Quaterniond& q = imported.recording.em0->samples[i].value.q_RS;
      EXPECT_LE((q * Eigen::Vector3d::UnitX() - motion[i].q * along).norm(), 1e-12) << axis;
      EXPECT_NEAR(q.norm(), 1.0, 1e-12);
    }
  }
}

}  // namespace
}  // namespace flextip::exchange
