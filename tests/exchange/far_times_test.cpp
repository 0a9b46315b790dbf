// Times that go beyond what a recording holds only when something is added to them.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <limits>

#include "exchange/bags/decompress.h"
#include "exchange/formats/side_car.h"
#include "exchange/streams/sensor_settings.h"
#include "exchange/values/times.h"
#include "tests/exchange/tables.h"
#include "tests/recording/sample_recording.h"

namespace flextip::exchange {
namespace {

using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteText;
using test_support::PlanWithSettings;
using testing::HasSubstr;

TEST(WithOffset, KeepsToWhatARecordingHolds) {
  constexpr TimeNs kMost = 4'000'000'000'000'000'000;
  EXPECT_EQ(WithOffset(5, -7), -2);
  EXPECT_EQ(WithOffset(kMost - 1000, 500), kMost - 500);
  EXPECT_FALSE(WithOffset(kMost, kMost / 10));
  EXPECT_FALSE(WithOffset(-kMost, -kMost / 10));
  for (const TimeNs t_ns :
       {std::numeric_limits<TimeNs>::max(), std::numeric_limits<TimeNs>::min()}) {
    EXPECT_FALSE(WithOffset(t_ns, t_ns));
    EXPECT_FALSE(WithOffset(t_ns, 0));
  }
}

TEST(FarTimes, OfATableAreRefused) {
  const TemporaryFolder folder;
  for (const bool two_columns : {false, true}) {
    const std::string rows =
        two_columns
            ? "header.stamp.sec,header.stamp.nanosec,x,y,z\n3999999999,3999999999000000000,1,2,3\n"
            : "t [s],x [m],y [m],z [m]\n3999999999,1,2,3\n";
    WriteText(folder / "a.csv", rows + rows.substr(rows.find('\n') + 1));
    ImportPlan plan = PlanWithSettings();
    plan.streams["wrist0"].file = folder / "a.csv";
    plan.streams["wrist0"].units["length"] = "m";
    plan.streams["wrist0"].offset_ns = 3'900'000'000'000'000'000;
    TellSensor(plan, "test", "wrist0", "position_noise_m", "1e-4");
    TellSensor(plan, "test", "wrist0", "orientation_noise_rad", "1e-3");
    EXPECT_THAT(test_support::Refusal(plan), HasSubstr("a.csv:2: the time is beyond"));
  }
}

// Their rate is below what a recording holds: it was written, and could not be read.
TEST(FarTimes, ApartByHoursAreRefused) {
  const TemporaryFolder folder;
  WriteText(folder / "a.csv", "t [s],x [m],y [m],z [m]\n0,1,2,3\n60000,1,2,3\n");
  ImportPlan plan = PlanWithSettings();
  plan.streams["wrist0"].file = folder / "a.csv";
  plan.streams["wrist0"].units["length"] = "m";
  TellSensor(plan, "test", "wrist0", "position_noise_m", "1e-4");
  TellSensor(plan, "test", "wrist0", "orientation_noise_rad", "1e-3");
  EXPECT_THAT(test_support::Refusal(plan), HasSubstr("wrist0: its samples are 6e+04 s apart"));
}

// One leap among many rows does not change their rate.
TEST(FarTimes, LeapsOfYearsAreRefused) {
  for (const char* rate_hz : {"", "10"}) {
    const TemporaryFolder folder;
    WriteText(folder / "a.csv",
              "t [s],x [m],y [m],z [m]\n0,1,2,3\n0.1,1,2,3\n0.2,1,2,3\n"
              "86400000,1,2,3\n86400000.1,1,2,3\n");
    ImportPlan plan = PlanWithSettings();
    plan.streams["wrist0"].file = folder / "a.csv";
    plan.streams["wrist0"].units["length"] = "m";
    TellSensor(plan, "test", "wrist0", "position_noise_m", "1e-4");
    TellSensor(plan, "test", "wrist0", "orientation_noise_rad", "1e-3");
    if (*rate_hz) TellSensor(plan, "test", "wrist0", "rate_hz", rate_hz);
    EXPECT_THAT(test_support::Refusal(plan),
                HasSubstr("wrist0: its samples 3 and 4 are 1e+03 days apart, expected at most 30"));
  }
}

TEST(FarTimes, OfASideCarAreRefused) {
  const TemporaryFolder folder;
  WriteText(folder / "v.json", R"({"timestamps": [-3.9e9], "estimated_latency": 3.9e9})");
  EXPECT_THAT(flextip::test_support::Refusal([&] { ReadSideCar(folder / "v.json"); }),
              HasSubstr("v.json: the time of frame 0 is beyond"));
}

// A chunk of a bag states how much it holds; the memory is asked for as it is unpacked.
TEST(Decompress, RefusesWhatHoldsLessThanItStates) {
  const std::vector<std::uint8_t> packed(100, 7);
  for (const char* kind : {"lz4", "zstd"}) {
    try {
      Decompress(packed, kind, 1ULL << 31);
      ADD_FAILURE() << kind;
    } catch (const WireError& error) {
      EXPECT_THAT(error.what(), HasSubstr("cannot be unpacked"));
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("was built without"));
    }
  }
}

}  // namespace
}  // namespace flextip::exchange
