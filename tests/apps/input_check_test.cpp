// The check at the start of commands: what is said, what is left out, what --no-check does.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/rotation.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "testdata/hidden/recording.h"
#include "tests/apps/run_program.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class InputCheck : public testing::Test {
 protected:
  /// Six seconds of a healthy recording, made wrong by `change`. All is as its files say: what is
  /// off within tolerance may miss the sensors by twice their noise.
  void Write(const std::function<void(Recording&)>& change) const {
    hidden::HiddenOptions options;
    options.exact = true;
    options.scene.duration_s = 6.0;
    options.tick_rate_hz = 50.0;
    options.links_per_side = 30;
    hidden::HiddenRecording hidden = hidden::MakeHidden(options, 71);
    change(hidden.recording);
    hidden::WriteHidden(folder_ / "rec", hidden);
  }
  /// The rendered pictures of testdata, with `change` in their recording, and an EM sensor on the
  /// straight shaft.
  void WriteRendered(const std::function<void(Recording&)>& change) const {
    const fs::path source = fs::path(FLEXTIP_SOURCE_DIR) / "testdata/recordings/rendered";
    Recording recording = ReadRecording(source).recording;
    EmStream& em = recording.em0.emplace();
    em.rate_hz = recording.wrist0->rate_hz;
    em.distance_from_tip_m = 0.02;
    em.position_noise_m = em.orientation_noise_rad = 1e-3;
    for (const auto& s : recording.wrist0->samples) {
      const Eigen::Vector3d along = (recording.p_RP - s.value.p_RW).normalized();
      const double at = recording.instrument.length_m - em.distance_from_tip_m;
      em.samples.push_back({s.t_ns,
                            {s.value.p_RW + at * along, Eigen::Quaterniond(RotationWithoutTwist(
                                                            Eigen::Vector3d::UnitX(), along))}});
    }
    change(recording);
    fs::create_directories(folder_ / "rec");
    WriteRecording(folder_ / "rec", recording);
    fs::create_directories(folder_ / "rec/cam0");
    fs::copy(source / "cam0/data", folder_ / "rec/cam0/data", fs::copy_options::recursive);
  }
  ProgramResult Run(std::vector<std::string> command, const std::vector<std::string>& more = {}) {
    command.insert(command.end(),
                   {(folder_ / "rec").string(), "-o", (folder_ / "out").string(), "--force"});
    command.insert(command.end(), more.begin(), more.end());
    return RunProgram(command);
  }
  nlohmann::json Summary() const {
    return nlohmann::json::parse(ReadText(folder_ / "out/summary.json"));
  }

  TestFolder folder_;
};

void EmInMillimetres(Recording& r) {
  for (auto& s : r.em0->samples) s.value.p_RS *= 1e3;
}

TEST_F(InputCheck, SaysWhatIsWrongBeforeTheAnswer) {
  Write(EmInMillimetres);
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"estimate"}, {"diagnose"}}) {
    const ProgramResult result = Run(command, {"--quiet"});
    EXPECT_THAT(result.err, AllOf(HasSubstr("wrong: em0: positions look like millimetres"),
                                  HasSubstr("  mend: import with --unit em0=mm")));
    if (result.exit_code != 0) continue;  // there is no answer
    EXPECT_EQ(Summary()["findings"][0]["finding"], "em0.unit");
    EXPECT_EQ(Summary()["verdict"]["grade"], "beware") << command.back();
  }
}

TEST_F(InputCheck, IsSkippedOnDemand) {
  Write(EmInMillimetres);
  const ProgramResult result = Run({"estimate"}, {"--no-check"});
  EXPECT_THAT(result.err, Not(HasSubstr("millimetres")));
}

TEST_F(InputCheck, SaysDoubtsOnTheTerminalThePageAndInTheSummary) {
  Write([](Recording& r) { r.em0->rate_hz *= 2.0; });
  const ProgramResult result = Run({"estimate"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("beware: em0: 50 samples a second, the file states 100"));
  EXPECT_EQ(Summary()["findings"][0]["finding"], "em0.rate");
  const std::string page = ReadText(folder_ / "out/report.html");
  const auto beware = page.find("Beware: the input is doubtful"),
             lead = page.find("class=\"says\"");
  ASSERT_NE(beware, std::string::npos);
  EXPECT_LT(lead, beware);  // the answer first
  EXPECT_TRUE(PageIsMadeAgain(folder_ / "out"));
  EXPECT_EQ(Run({"estimate"}, {"--quiet"}).err, "");
}

TEST_F(InputCheck, FindsNothingInAHealthyRecording) {
  Write([](Recording&) {});
  const ProgramResult result = Run({"estimate"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_FALSE(Summary().contains("findings"));
}

/// The EM system's own frame is what calibrate em finds.
TEST_F(InputCheck, DoesNotAskForWhatTheCommandIsToFind) {
  Write([](Recording& r) {
    const Pose T{ExpRotation({0.4, -1.1, 0.7}), {0.3, -0.2, 0.4}};
    for (auto& s : r.em0->samples) {
      s.value.p_RS = T * s.value.p_RS;
      s.value.q_RS = T.Quaternion() * s.value.q_RS;
    }
  });
  EXPECT_THAT(Run({"estimate"}).err, HasSubstr("wrong: em0"));
  const ProgramResult result = Run({"calibrate", "em"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, Not(HasSubstr("em0")));
}

TEST_F(InputCheck, LeavesOutWhatOnlyHelpsTracking) {
  WriteRendered(EmInMillimetres);
  const ProgramResult result = Run({"track"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("beware: em0: positions look like millimetres"),
                                HasSubstr("; em0 is left out here [em0.unit]")));
  EXPECT_EQ(Summary()["findings"][0]["finding"], "em0.unit");
}

TEST_F(InputCheck, SeesTagsThatDoNotFit) {
  WriteRendered([](Recording& r) {
    for (CollarTag& tag : r.tags0->tags) tag.size_m *= 5.0 / 6.0;
  });
  const ProgramResult result = Run({"track"});
  EXPECT_THAT(result.err, testing::ContainsRegex("wrong: tags0: found [0-9]+ tags of this family; "
                                                 "they fit a tag of [0-9.]+ mm, the file says"));
}

TEST_F(InputCheck, SaysThatTipsAreTheCameras) {
  WriteRendered([](Recording&) {});
  const std::string collar = (folder_ / "rec/tags0/sensor.yaml").string();
  ASSERT_EQ(RunProgram({"convert", "camera", (folder_ / "rec/cam0/sensor.yaml").string(),
                        (folder_ / "camera_info.yaml").string(), "--to", "ros", "--drop", "pose",
                        "--drop", "gamma"})
                .exit_code,
            0);
  const ProgramResult result =
      RunProgram({"track", (folder_ / "rec/cam0/data").string(), "--camera",
                  (folder_ / "camera_info.yaml").string(), "--collar", collar, "--rate", "25", "-o",
                  (folder_ / "out").string()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("the tips are in the camera's frame"));
  EXPECT_EQ(Summary()["frame"], "C");
  EXPECT_THAT(ReadText(folder_ / "out/vision0/sensor.yaml"), HasSubstr("in the camera's frame"));
}

}  // namespace
}  // namespace flextip
