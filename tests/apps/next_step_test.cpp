// The next step that a command names: a line to copy, which runs.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// The line below "Next: ...".
std::string CopiedLine(const std::string& out) {
  std::istringstream lines(out);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("Next: ")) continue;
    std::getline(lines, line);
    return line.substr(line.find_first_not_of(' '));
  }
  return "";
}

ProgramResult RunInShell(const std::string& line) {
  const std::string place = fs::path(FLEXTIP_PROGRAM).parent_path().string();
  return RunProgram({"-c", "PATH='" + place + "':\"$PATH\"; " + line}, "/bin/sh");
}

nlohmann::json SummaryOf(const fs::path& folder) {
  return nlohmann::json::parse(ReadText(folder / "summary.json"));
}

// Paths with a space and a quote: the shell must get them as they are.
TEST(NextStep, ALineCopiedFromTheTerminalRuns) {
  const TestFolder folder;
  const fs::path recording = folder / "lab's data" / "rec 1", tracked = folder / "lab's data" / "t";
  fs::create_directories(recording.parent_path());
  fs::copy(fs::path(FLEXTIP_SOURCE_DIR) / "testdata/recordings/rendered", recording,
           fs::copy_options::recursive);
  const auto track = RunProgram({"track", recording.string(), "-o", tracked.string()});
  ASSERT_EQ(track.exit_code, 0) << track.err;
  const std::string line = CopiedLine(track.out);
  EXPECT_THAT(line, HasSubstr("flextip estimate "));
  EXPECT_EQ(SummaryOf(tracked)["verdict"]["command"], line);  // and the page has it
  EXPECT_TRUE(PageIsMadeAgain(tracked));

  const auto estimate = RunInShell(line);
  ASSERT_EQ(estimate.exit_code, 0) << line << "\n" << estimate.err;
  const fs::path estimated = tracked.string() + "-estimate";
  const auto summary = SummaryOf(estimated);
  EXPECT_EQ(summary["command"], "estimate");
  EXPECT_THAT(summary["inputs"], testing::Contains(tracked.string()));
  const auto next = RunInShell(CopiedLine(estimate.out));  // and the next one after it
  EXPECT_EQ(next.exit_code, 0) << CopiedLine(estimate.out) << "\n" << next.err;
}

// A page whose head is made of the summary alone names its step on the terminal, too.
TEST(NextStep, ACommandWithoutAJudgementNamesItsStep) {
  const TestFolder folder;
  const auto out = folder / "tags";
  const auto picture = std::string(FLEXTIP_SOURCE_DIR) +
                       "/testdata/recordings/rendered/cam0/data/1700000000000000000.png";
  const auto found = RunProgram({"detect", picture, "--family", "tag25h9", "-o", out.string()});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  const std::string line = CopiedLine(found.out);
  EXPECT_THAT(line, HasSubstr(picture));
  EXPECT_THAT(ReadText(out / "report.html"), HasSubstr("<pre>" + line + "</pre>"));
  EXPECT_EQ(RunInShell(line).exit_code, 0) << line;
}

}  // namespace
}  // namespace flextip
