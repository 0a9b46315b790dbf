#include "apps/common/output.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/error.h"
#include "core/version.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class Output : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::temp_directory_path() /
             ("flextip_output_" + std::string(test->name()) + "_" + std::to_string(getpid()));
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  static void Write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }
  static std::string Read(const fs::path& file) {
    std::ifstream in(file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// Names of everything in the test's folder: nothing may be left over beside the output.
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
      names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  std::string Refusal(const fs::path& name, const OutputOptions& options = {}) const {
    try {
      OutputFolder output(name, "test", options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  }
  fs::path folder;
};

TEST_F(Output, AppearsWithCommitAndNotBefore) {
  OutputFolder output(folder / "new/out/", "track");
  Write(output.folder() / "a.txt", "a");
  EXPECT_FALSE(fs::exists(folder / "new/out"));
  EXPECT_EQ(output.folder().parent_path(), fs::canonical(folder / "new"));
  output.Commit();
  EXPECT_EQ(output.folder(), output.name());
  EXPECT_EQ(Read(folder / "new/out/a.txt"), "a");
  folder = folder / "new";
  EXPECT_THAT(Names(), ElementsAre("out"));
  folder = folder.parent_path();
}

TEST_F(Output, IsGoneWithoutCommit) {
  try {
    OutputFolder output(folder / "out", "track");
    Write(output.folder() / "a.txt", "a");
    throw WorkError("failed half-way");
  } catch (const WorkError&) {
  }
  EXPECT_THAT(Names(), IsEmpty());
}

TEST_F(Output, NeverOverwritesSilently) {
  fs::create_directory(folder / "out");
  EXPECT_EQ(Refusal(folder / "out"), "accepted");  // empty
  Write(folder / "out/a.txt", "old");
  EXPECT_THAT(Refusal(folder / "out"), HasSubstr("out: exists and is not empty"));
  EXPECT_EQ(Read(folder / "out/a.txt"), "old");
  Write(folder / "file", "old");
  EXPECT_THAT(Refusal(folder / "file"), HasSubstr("is a file, expected a folder"));
  EXPECT_THAT(Refusal(folder / "file", {.force = true}), HasSubstr("is a file, expected a folder"));
  EXPECT_THAT(Refusal(folder / "file/out"), HasSubstr("cannot make a folder there"));
  EXPECT_THAT(Refusal(""), HasSubstr("has no name"));
  EXPECT_THAT(Names(), ElementsAre("file", "out"));
}

TEST_F(Output, ForceReplacesTheWholeFolderOnlyAtCommit) {
  fs::create_directory(folder / "out");
  Write(folder / "out/old.txt", "old");
  {
    OutputFolder output(folder / "out", "track", {.force = true});
    Write(output.folder() / "new.txt", "new");
    EXPECT_EQ(Read(folder / "out/old.txt"), "old");
  }
  EXPECT_EQ(Read(folder / "out/old.txt"), "old");
  OutputFolder output(folder / "out", "track", {.force = true});
  Write(output.folder() / "new.txt", "new");
  output.Commit();
  EXPECT_EQ(Read(folder / "out/new.txt"), "new");
  EXPECT_FALSE(fs::exists(folder / "out/old.txt"));
  EXPECT_THAT(Names(), ElementsAre("out"));
}

TEST_F(Output, ForceDoesNotDeleteInputsRecordingsOrTheWorkingFolder) {
  fs::create_directories(folder / "rec/cam0");
  Write(folder / "rec/recording.yaml", "version: 1");
  Write(folder / "rec/cam0/a.png", "a");
  EXPECT_THAT(Refusal(folder / "rec", {.force = true, .inputs = {folder / "rec/cam0/a.png"}}),
              HasSubstr("not replaced: it holds the input"));
  EXPECT_THAT(Refusal(folder / "rec", {.force = true, .inputs = {folder / "rec/../rec"}}),
              HasSubstr("not replaced: it holds the input"));
  EXPECT_THAT(Refusal(folder / "rec", {.force = true}),
              HasSubstr("a recording that was not made by this program"));
  EXPECT_THAT(Refusal(fs::current_path(), {.force = true}), HasSubstr("the working folder"));
  Write(folder / "rec/summary.json", "{}");
  EXPECT_EQ(Refusal(folder / "rec", {.force = true, .inputs = {folder / "rec2", folder}}),
            "accepted");
  EXPECT_EQ(Read(folder / "rec/cam0/a.png"), "a");
}

TEST_F(Output, WhatAppearedInTheMeantimeIsKept) {
  OutputFolder output(folder / "out", "track");
  fs::create_directory(folder / "out");
  Write(folder / "out/theirs.txt", "theirs");
  EXPECT_THROW(output.Commit(), WorkError);
  EXPECT_EQ(Read(folder / "out/theirs.txt"), "theirs");
}

TEST_F(Output, SummaryHoldsTheKeysOfEveryCommand) {
  OutputFolder output(folder / "out", "track");
  output.Warn("torn line");
  output.Warn(std::vector<std::string>{"dropped frame", "not UTF-8: \xff"});
  output.WriteSummary({{"frames", 8}, {"rms", 0.1}});
  output.Commit();
  const auto summary = nlohmann::json::parse(Read(folder / "out/summary.json"));
  EXPECT_EQ(summary["command"], "track");
  EXPECT_EQ(summary["version"], kVersion);
  EXPECT_GE(summary["seconds"].get<double>(), 0.0);
  EXPECT_LT(summary["seconds"].get<double>(), 60.0);
  EXPECT_EQ(summary["frames"], 8);
  EXPECT_EQ(summary["rms"].get<double>(), 0.1);
  ASSERT_EQ(summary["warnings"].size(), 3u);
  EXPECT_EQ(summary["warnings"][1], "dropped frame");
}

TEST_F(Output, SummaryRefusesNumbersThatAreNone) {
  const OutputFolder output(folder / "out", "track");
  EXPECT_THROW(output.WriteSummary({{"rms", std::nan("")}}), WorkError);
  EXPECT_THROW(output.WriteSummary({{"list", {{{"rms", HUGE_VAL}}}}}), WorkError);
  output.WriteSummary({});
  EXPECT_THAT(nlohmann::json::parse(Read(output.folder() / "summary.json"))["warnings"], IsEmpty());
}

}  // namespace
}  // namespace flextip
