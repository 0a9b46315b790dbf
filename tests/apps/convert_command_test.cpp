// flextip convert camera, as a user runs it.
#include <gmock/gmock.h>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::HasSubstr;

const char* kSensor =
    "sensor_type: camera\ncomment: left\nrate_hz: 30\nresolution: [640, 480]\n"
    "camera_model: pinhole\nintrinsics: [500.25, 501, 320, 240]\n"
    "distortion_model: radial-tangential\ndistortion_coefficients: [-0.2, 0.1, 1e-05, 0]\n"
    "gamma: 2.2\n"
    "T_RC: {rows: 4, cols: 4, data: [1,0,0,0.1, 0,1,0,0, 0,0,1,0, 0,0,0,1]}\n";

ProgramResult Convert(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"convert", "camera"});
  return RunProgram(arguments);
}

TEST(ConvertCommand, RefusesALossUnlessItIsDropped) {
  const TestFolder folder;
  const auto in = folder.Write("sensor.yaml", kSensor);
  const auto out = (folder / "camchain.yaml").string();
  EXPECT_TRUE(IsRefused(Convert({in, out}),
                        {"sensor.yaml", "kalibr", "gamma", "T_RC", "--drop gamma,pose"}));
  EXPECT_TRUE(IsRefused(Convert({in, out, "--drop", "gamma"}), {"T_RC", "--drop pose"}));
  EXPECT_FALSE(std::filesystem::exists(out));
  const auto done = Convert({in, out, "--drop", "gamma,pose"});
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_THAT(ReadText(out), HasSubstr("distortion_coeffs: [-0.2, 0.1, 1.0e-05, 0.0]"));
  EXPECT_TRUE(IsRefused(Convert({in, out, "--drop", "gamma,pose"}), {"camchain.yaml", "--force"}));
}

TEST(ConvertCommand, GoesThroughEveryFormatAndBack) {
  const TestFolder folder;
  std::string text = kSensor;
  text.erase(text.find("gamma"));
  const auto in = folder.Write("sensor.yaml", text);
  const std::vector<std::string> chain = {
      in, (folder / "camchain.yaml").string(), (folder / "camera_info.yaml").string(),
      (folder / "c.xml").string(), (folder / "back/sensor.yaml").string()};
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
    const auto result = Convert({chain[i], chain[i + 1]});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  const std::string back = ReadText(chain.back());
  for (const char* line : {"comment: \"left\"\n", "rate_hz: 30", "resolution: [640, 480]\n",
                           "intrinsics: [500.25, 501, 320, 240]\n", "radial-tangential\n",
                           "distortion_coefficients: [-0.2, 0.1, 1e-05, 0]\n"}) {
    EXPECT_THAT(back, HasSubstr(line));
  }
  EXPECT_THAT(back, testing::Not(HasSubstr("T_RC")));  // nobody said where it is
}

TEST(ConvertCommand, RefusesWhatItCannotName) {
  const TestFolder folder;
  const auto in = folder.Write("sensor.yaml", kSensor);
  EXPECT_TRUE(IsRefused(Convert({in, (folder / "a.yaml").string()}), {"a.yaml", "--to"}));
  EXPECT_TRUE(IsRefused(Convert({in, (folder / "a.yaml").string(), "--to", "mrcal"}), {"mrcal"}));
  EXPECT_TRUE(IsRefused(Convert({(folder / "none.yaml").string(), "sensor.yaml"}), {"none.yaml"}));
  EXPECT_TRUE(IsRefused(Convert({in, (folder / "a.yml").string(), "--camera", "cam1"}), {"cam1"}));
  EXPECT_TRUE(IsRefused(Convert({in, (folder / "a.yml").string(), "--from", "ros"}),
                        {"sensor.yaml", "image_width"}));
}

}  // namespace
}  // namespace flextip
