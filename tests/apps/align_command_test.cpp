// flextip align, and its result in other commands.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "recording/calibrations/file.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;

const std::string kSample = std::string(FLEXTIP_SOURCE_DIR) + "/testdata/recordings/sample_4";

/// The sample with em0 late by so many seconds; written into `folder`.
std::string WithEmLate(const TestFolder& folder, double late_s) {
  Recording r = ReadRecording(kSample, {.check_frames = false}).recording;
  for (auto& sample : r.em0->samples) sample.t_ns += std::llround(1e9 * late_s);
  const auto path = folder / "recording";
  std::filesystem::create_directories(path);
  WriteRecording(path, r);
  return path.string();
}

TEST(AlignCommand, FindsAShiftAndEstimateTakesIt) {
  const TestFolder folder;
  const auto recording = WithEmLate(folder, 2.5), out = (folder / "clocks").string();
  const auto result = RunProgram({"align", recording, "-o", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Calibration found = ReadCalibration(folder / "clocks/calibration.yaml");
  EXPECT_NEAR(found.numbers.at("em0.time_offset_s")[0], -2.5, 0.01);
  const auto summary = nlohmann::json::parse(ReadText(folder / "clocks/summary.json"));
  EXPECT_EQ(summary["reference"], "wrist0");
  EXPECT_THAT(result.out, HasSubstr("em0's clock is 2."));
  EXPECT_TRUE(PageIsMadeAgain(folder / "clocks"));
  const auto estimate = RunProgram({"estimate", recording, "--calibration",
                                    (folder / "clocks/calibration.yaml").string(), "-o",
                                    (folder / "estimated").string()});
  ASSERT_EQ(estimate.exit_code, 0) << estimate.err;
  const auto used = nlohmann::json::parse(ReadText(folder / "estimated/summary.json"));
  EXPECT_EQ(used["calibrations"][0]["kind"], "clocks");
}

TEST(AlignCommand, RefusesWhatItCannotCompare) {
  const TestFolder folder;
  const auto out = (folder / "clocks").string();
  EXPECT_TRUE(IsRefused(RunProgram({"align", kSample, "--reference", "em9", "-o", out}),
                        {"--reference em9", "wrist0"}));
  EXPECT_TRUE(IsRefused(
      RunProgram(
          {"align", std::string(FLEXTIP_SOURCE_DIR) + "/testdata/recordings/rendered", "-o", out}),
      {"wrist0 alone", "em0, vision0"}));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace flextip
