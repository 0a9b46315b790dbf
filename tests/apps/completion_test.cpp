// Shell completion by a real bash, man pages by groff's own checks.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "tests/apps/run_program.h"

namespace flextip {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

std::string OutputOf(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  for (int c = fgetc(pipe); c != EOF; c = fgetc(pipe)) text += static_cast<char>(c);
  pclose(pipe);
  return text;
}

/// What bash offers for a line whose last word is being typed.
std::vector<std::string> Completions(const std::string& script,
                                     const std::vector<std::string>& line) {
  std::string words;
  for (const auto& word : line) words += " '" + word + "'";
  const std::string out = OutputOf("bash -c 'source " + script + "; COMP_WORDS=(flextip" + words +
                                   "); COMP_CWORD=" + std::to_string(line.size()) +
                                   "; _flextip; printf \"%s\\n\" \"${COMPREPLY[@]}\"' 2>&1");
  std::istringstream lines(out);
  std::vector<std::string> offered;
  for (std::string offer; std::getline(lines, offer);) offered.push_back(offer);
  return offered;
}

TEST(Completion, OffersCommandsAndTheirOptions) {
  const TestFolder folder;
  const auto result = RunProgram({"completion"});
  ASSERT_EQ(result.exit_code, 0);
  folder.Write("flextip.bash", result.out);
  const std::string script = (folder / "flextip.bash").string();
  EXPECT_THAT(Completions(script, {"tra"}), testing::ElementsAre("track"));
  EXPECT_THAT(Completions(script, {"calibrate", "st"}),
              testing::UnorderedElementsAre("stereo", "stiffness", "strain"));
  EXPECT_THAT(Completions(script, {"track", "recording", "--over"}),
              testing::ElementsAre("--overlay"));
  EXPECT_THAT(Completions(script, {"estimate", "--w"}), testing::Contains("--window"));
  EXPECT_THAT(Completions(script, {"track", "some"}), testing::ElementsAre(""));
}

TEST(Manual, HasAPageForEveryCommandWithoutRoffErrors) {
  const TestFolder folder;
  ASSERT_EQ(RunProgram({"completion", "--man", (folder / "man").string(), "--date", "2026-01-02"})
                .exit_code,
            0);
  for (const std::string command : {FLEXTIP_COMMANDS}) {
    const auto page = folder / "man" / ("flextip-" + command + ".1");
    ASSERT_TRUE(std::filesystem::exists(page)) << page;
    EXPECT_EQ(OutputOf("groff -man -Tascii -ww -z " + page.string() + " 2>&1"), "");
  }
  const std::string track =
      OutputOf("groff -man -Tascii " + (folder / "man/flextip-track.1").string() + " 2>&1");
  EXPECT_THAT(track, HasSubstr("--overlay"));
  EXPECT_THAT(track, HasSubstr("2026-01-02"));
}

}  // namespace
}  // namespace flextip
