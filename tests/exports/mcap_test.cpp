// A recording as MCAP, read by the format's own library.
#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "exports/mcap/export_mcap.h"
#include "exports/mcap/writer.h"
#include "report/report.h"
#include "report/result_files.h"

namespace flextip::exports {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path kSource = FLEXTIP_SOURCE_DIR;

bool HasReader() {
  return fs::exists(FLEXTIP_NODE) && fs::exists(kSource / "node_modules/@mcap/core");
}

fs::path Scratch(const std::string& name) {
  return fs::temp_directory_path() / fmt::format("flextip-{}-{}", ::getpid(), name);
}

/// Returns what tests/exports/read_mcap.mjs says of a file.
Json ReadMcap(const fs::path& file) {
  const std::string command = fmt::format("'{}' '{}' '{}' '{}'", FLEXTIP_NODE,
                                          (kSource / "tests/exports/read_mcap.mjs").string(),
                                          (kSource / "node_modules").string(), file.string());
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    text.append(buffer.data(), n);
  }
  EXPECT_EQ(pclose(pipe), 0) << command;
  return Json::parse(text);
}

TEST(Mcap, OfARecordingWithPicturesIsRead) {
  if (!HasReader()) GTEST_SKIP() << "no node, or node_modules without @mcap/core (npm ci)";
  const fs::path recording = kSource / "testdata/recordings/rendered", file = Scratch("r.mcap");
  const McapContent content = ExportMcap(recording, {}, file);
  const Json read = ReadMcap(file);
  fs::remove(file);
  EXPECT_TRUE(read["complete"]);
  EXPECT_TRUE(read["sorted"]);
  EXPECT_EQ(read["streamed"], content.messages);
  EXPECT_EQ(read["statistics"], content.messages);
  EXPECT_GE(read["chunks"].get<int>(), 1);
  EXPECT_EQ(read["topics"].size(), content.topics.size());
  for (const auto& [name, topic] : read["topics"].items()) {
    EXPECT_EQ(topic["encoding"], "jsonschema") << name;
    EXPECT_TRUE(topic["unknown"].empty()) << name << topic["unknown"];  // keys the schema lacks
  }
  const Json& image = read["topics"]["/cam0/image"];
  EXPECT_EQ(image["schema"], "foxglove.CompressedImage");
  EXPECT_EQ(image["messages"], 8);
  // The very bytes of the first picture.
  const auto table = report::ReadResultTable(recording / "cam0/data.csv");
  EXPECT_EQ(image["firstTime"], table.texts[0][0]);
  EXPECT_EQ(image["first"]["data"],
            report::Base64(report::ReadBytes(recording / "cam0/data" / table.texts[1][0])));
  EXPECT_EQ(read["topics"]["/wrist0/path"]["schema"], "foxglove.PosesInFrame");
  EXPECT_EQ(read["topics"]["/cam0/calibration"]["first"]["K"].size(), 9u);
}

TEST(Mcap, OfSensorsHasPosesAndPlots) {
  if (!HasReader()) GTEST_SKIP() << "no node, or node_modules without @mcap/core (npm ci)";
  const fs::path recording = kSource / "testdata/recordings/sample_0", file = Scratch("s.mcap");
  ExportMcap(recording, {}, file);
  const Json read = ReadMcap(file);
  fs::remove(file);
  const auto em = report::ReadResultTable(recording / "em0/data.csv");
  const Json& pose = read["topics"]["/em0/pose"];
  EXPECT_EQ(pose["schema"], "foxglove.PoseInFrame");
  EXPECT_EQ(pose["messages"], em.Rows());
  EXPECT_EQ(pose["first"]["frame_id"], "R");
  EXPECT_EQ(pose["first"]["pose"]["position"]["x"].get<double>(), em.Column("p_RS_x")->front());
  EXPECT_EQ(pose["first"]["timestamp"]["sec"].get<long>(),
            std::stol(em.texts[0][0]) / 1'000'000'000);
  const Json& strain = read["topics"]["/strain0"];
  EXPECT_EQ(strain["schema"], "flextip.strain0");
  const auto moments = report::ReadResultTable(recording / "strain0/data.csv");
  EXPECT_EQ(strain["first"]["m1_y_Nm"].get<double>(), moments.Column("m1_y")->front());
}

// Many chunks, times that repeat, an empty channel.
TEST(McapWriter, WritesWhatTheReaderCounts) {
  if (!HasReader()) GTEST_SKIP() << "no node, or node_modules without @mcap/core (npm ci)";
  const fs::path file = Scratch("w.mcap");
  McapWriter writer(file);
  const std::string schema = R"({"type":"object","properties":{"text":{"type":"string"}}})";
  const auto a = writer.AddChannel("/a", "text", schema),
             b = writer.AddChannel("/b", "text", schema);
  writer.AddChannel("/empty", "other", schema);
  const std::string text(5000, 'x');
  for (int i = 0; i < 600; ++i)
    writer.Add(i % 3 == 0 ? b : a, i / 2, R"({"text":")" + text + "\"}");
  writer.Finish();
  const Json read = ReadMcap(file);
  fs::remove(file);
  EXPECT_EQ(read["statistics"], 600);
  EXPECT_EQ(read["streamed"], 600);
  EXPECT_GE(read["chunks"].get<int>(), 3);
  EXPECT_EQ(read["topics"]["/a"]["messages"], 400);
  EXPECT_EQ(read["topics"]["/b"]["messages"], 200);
  EXPECT_EQ(read["topics"]["/b"]["first"]["text"], text);
}

TEST(McapWriter, SeesADamagedFile) {
  if (!HasReader()) GTEST_SKIP() << "no node, or node_modules without @mcap/core (npm ci)";
  const fs::path file = Scratch("d.mcap");
  McapWriter writer(file);
  const auto a = writer.AddChannel("/a", "text", "{}");
  writer.Add(a, 1, R"({"text":"good"})");
  writer.Finish();
  std::string bytes = report::ReadBytes(file);
  bytes.replace(bytes.find("good"), 4, "evil");
  std::ofstream(file, std::ios::binary) << bytes;
  const std::string command =
      fmt::format("'{}' '{}' '{}' '{}' 2>/dev/null >/dev/null", FLEXTIP_NODE,
                  (kSource / "tests/exports/read_mcap.mjs").string(),
                  (kSource / "node_modules").string(), file.string());
  EXPECT_NE(std::system(command.c_str()), 0);  // the chunk's CRC
  fs::remove(file);
}

}  // namespace
}  // namespace flextip::exports
