// Random damage anywhere in a recording: it reads, or it fails with one line that names the file.
#include <gmock/gmock.h>

#include <random>

#include "core/error.h"
#include "recording/recording_reader.h"
#include "tests/recording/sample_recording.h"

namespace flextip {
namespace {

using flextip::test_support::ReadText;
using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteSample;
using flextip::test_support::WriteText;

std::string Damaged(std::string text, std::mt19937& generator) {
  const auto random = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(generator);
  };
  static const std::string kBytes = ",,\n\n:[]{}\"'#&*!|>%@-+.0123456789einfa \t\r\\\x80\xff";
  const std::size_t at = random(text.size());
  switch (random(4)) {
    case 0:
      return text.substr(0, at);
    case 1:
      text[at] = kBytes[random(kBytes.size())];
      return text;
    case 2: {
      const char byte = kBytes[random(kBytes.size())];
      return text.insert(at, 1 + random(3), byte);
    }
    default:
      return text.erase(at, 1 + random(30));
  }
}

bool AllFinite(const Recording& r) {
  for (const auto& sample : r.wrist0->samples) {
    if (!sample.value.p_RW.allFinite()) return false;
  }
  for (const auto& sample : r.em0->samples) {
    if (!(std::abs(sample.value.q_RS.norm() - 1) < 1e-9)) return false;
  }
  return r.p_RP.allFinite() && r.instrument.length_m > 0;
}

TEST(Damage, NeverCrashesNorReadsAsNumbersThatAreNone) {
  const TemporaryFolder folder;
  WriteSample(folder.path());
  std::vector<std::filesystem::path> files = {folder / "recording.yaml"};
  for (const char* sensor : {"wrist0", "em0", "strain0", "cam0", "vision0"}) {
    files.push_back(folder.path() / sensor / "sensor.yaml");
    files.push_back(folder.path() / sensor / "data.csv");
  }
  files.push_back(folder / "tags0/sensor.yaml");
  std::mt19937 generator(5);
  int rejected = 0, read = 0;
  for (int i = 0; i < 1500; ++i) {
    const auto& file = files[static_cast<std::size_t>(i) % files.size()];
    const std::string whole = ReadText(file);
    const std::string damaged = Damaged(whole, generator);
    WriteText(file, damaged);
    try {
      EXPECT_TRUE(AllFinite(ReadRecording(folder.path(), {.check_frames = false}).recording));
      ++read;
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_THAT(message, ::testing::HasSubstr(file.string())) << damaged;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      ++rejected;
    }
    WriteText(file, whole);
  }
  EXPECT_GT(rejected, 500);
  EXPECT_GT(read, 100);
}

}  // namespace
}  // namespace flextip
