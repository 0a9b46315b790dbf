// Pipes, devices and folders in the place of files; texts of a file that would move a terminal; and
// files that are written whole or not at all.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>

#include "core/error.h"
#include "recording/calibrations/file.h"
#include "recording/cameras/camera_formats.h"
#include "recording/recording_reader.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"
#include "tests/recording/sample_recording.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using flextip::test_support::ReadText;
using flextip::test_support::Refusal;
using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteSample;
using flextip::test_support::WriteText;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

void Exchange(const fs::path& file, const std::string& by) {
  fs::remove_all(file);
  if (by == "pipe") ASSERT_EQ(mkfifo(file.c_str(), 0600), 0);
  if (by == "device") fs::create_symlink("/dev/zero", file);
  if (by == "folder") fs::create_directories(file);
}

class OddFile : public ::testing::TestWithParam<const char*> {};

// A reader that opened a pipe would wait here for ever.
TEST_P(OddFile, IsRefusedByEveryReader) {
  const TemporaryFolder folder;
  const auto file = folder / "odd";
  Exchange(file, GetParam());
  const auto says = AllOf(HasSubstr(file.string() + ": "), HasSubstr(GetParam()));
  ReadLog log;
  EXPECT_THAT(Refusal([&] { ReadTextFile(file); }), says);
  EXPECT_THAT(Refusal([&] { YamlMap::Load(file); }), says);
  EXPECT_THAT(Refusal([&] { CsvReader(file, log); }), says);
  EXPECT_THAT(Refusal([&] { ReadCalibration(file); }), says);
  EXPECT_THAT(Refusal([&] { GuessCameraFormat(file); }), says);
  EXPECT_THAT(Refusal([&] { ReadCameraDescription(file, CameraFormat::kOpenCv); }), says);
}

TEST_P(OddFile, IsRefusedWithinARecording) {
  for (const char* name : {"recording.yaml", "wrist0/sensor.yaml", "wrist0/data.csv",
                           "cam0/data.csv", "cam0/data/0.png", "tags0/sensor.yaml"}) {
    const TemporaryFolder folder;
    WriteSample(folder.path());
    Exchange(folder / name, GetParam());
    EXPECT_THAT(Refusal([&] { ReadRecording(folder.path()); }), HasSubstr(name));
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, OddFile, ::testing::Values("pipe", "device", "folder"));

TEST(ControlCharacters, OfAFileReachNoTerminal) {
  const TemporaryFolder folder;
  const std::string escape = "\x1b[31m", c1 = "\xc2\x9b"
                                              "2J";
  WriteText(folder / "a.yaml", "\"ke\\e[31my\": 1\nformat: \"x\\ey\\a\\x9b\"\n");
  const YamlMap yaml = YamlMap::Load(folder / "a.yaml");
  const std::string message =
      yaml.Error("format", "found " + yaml.Text("format") + escape + c1 + "\n\t\x7f").what();
  for (const char c : message) EXPECT_GE(static_cast<unsigned char>(c), 0x20) << message;
  EXPECT_THAT(message, AllOf(Not(HasSubstr("\x7f")), Not(HasSubstr("\xc2\x9b"))));
  ReadLog log;
  yaml.WarnUnknown(log);
  for (const auto& warning : log.warnings) EXPECT_THAT(warning, Not(HasSubstr("\x1b")));
  EXPECT_EQ(Printable("na\xc3\xafve \xe2\x82\xac\n"), "na\xc3\xafve \xe2\x82\xac\n");
}

TEST(OtherLibraries, KeepTheirWords) {
  const TemporaryFolder folder;
  WriteText(folder / "a.yaml", "a: [1, 2\nb: }");
  EXPECT_THAT(Refusal([&] { YamlMap::Load(folder / "a.yaml"); }),
              AllOf(HasSubstr("a.yaml:"), HasSubstr("is not YAML from here on")));
  for (const char* text :
       {"%YAML:1.0\n---\ncamera_matrix: !!opencv-matrix\n   rows: -3\n",
        "%YAML:1.0\n---\ncamera_matrix: [", "<?xml version=\"1.0\"?>\n<a>",
        "{\"camera_matrix\": {\"type_id\": \"opencv-matrix\", \"rows\": 1e9}}"}) {
    WriteText(folder / "camera.yml", text);
    EXPECT_THAT(
        Refusal([&] { ReadCameraDescription(folder / "camera.yml", CameraFormat::kOpenCv); }),
        AllOf(HasSubstr("camera.yml:"), Not(HasSubstr("OpenCV(")), Not(HasSubstr("error"))))
        << text;
  }
}

TEST(WrittenFile, IsWholeOrAsItWas) {
  const TemporaryFolder folder;
  const auto file = folder / "a.txt";
  WriteTextFile(file, "before");
  WriteTextFile(file, "after");
  EXPECT_EQ(ReadText(file), "after");
  fs::create_directories(folder / "kept");
  EXPECT_THROW(WriteTextFile(folder / "kept", "x"), WorkError);
  WriteTextFile(folder / "new/deep/b.txt", "b");
  EXPECT_EQ(ReadText(folder / "new/deep/b.txt"), "b");
  fs::create_symlink(file, folder / "link");
  WriteTextFile(folder / "link", "through");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(ReadText(file), "through");
  EXPECT_THAT(Refusal([] { WriteTextFile("/dev/full", "x"); }),
              AllOf(HasSubstr("/dev/full: "), HasSubstr("No space left")));
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
    files += entry.is_regular_file() ? 1 : 0;
  EXPECT_EQ(files, 3u);  // a.txt, link to it, b.txt: nothing is left beside them
}

TEST(Names, WithLineBreaksStayInTheirField) {
  CsvWriter csv({"file"}, false);
  csv.Add(std::string("a\nb")).EndRow();
  EXPECT_EQ(csv.text(), "file\na?b\n");
}

}  // namespace
}  // namespace flextip
