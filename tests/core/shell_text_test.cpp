#include "core/shell_text.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <memory>

namespace flextip {
namespace {

/// The arguments as a shell understands them, one a line.
std::string InShell(const std::string& words) {
  const std::string line = "printf '%s\\n' " + words;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(line.c_str(), "r"), pclose);
  std::string out;
  for (int c = std::fgetc(pipe.get()); c != EOF; c = std::fgetc(pipe.get())) out += char(c);
  return out;
}

TEST(ShellText, AShellTakesQuotedTextAsItIs) {
  for (const std::string text : {"plain/path-1.yaml", "two words", "it's", "$HOME", "a;b", "~", "*",
                                 "\"", "", "ä", "back\\slash"}) {
    EXPECT_EQ(InShell(ShellQuoted(text)), text + "\n");
  }
  EXPECT_EQ(ShellQuoted("plain/path-1.yaml"), "plain/path-1.yaml");
}

TEST(ShellText, PathsStandInPlaceOfTheirWords) {
  const std::vector<Placeholder> paths{{"RECORDING", "my data/rec"}, {"RESULT", "out/state"}};
  EXPECT_EQ(FillPlaceholders("flextip diagnose RECORDING -o RESULT-cause", paths),
            "flextip diagnose 'my data/rec' -o out/state-cause");
  EXPECT_EQ(FillPlaceholders("flextip estimate --model RESULT/model.yaml", paths),
            "flextip estimate --model out/state/model.yaml");
  EXPECT_EQ(FillPlaceholders("", paths), "");
  // Words that only look alike, and words whose path nobody knows.
  EXPECT_EQ(FillPlaceholders("x RECORDINGS RESULT_2 --RESULT PICTURE", paths),
            "x RECORDINGS RESULT_2 --RESULT PICTURE");
  EXPECT_EQ(FillPlaceholders("flextip check RECORDING", {{"RECORDING", ""}}),
            "flextip check RECORDING");
  EXPECT_EQ(FillPlaceholders("flextip check RECORDING", {{"RECORDING", "-rec"}}),
            "flextip check ./-rec");
  // A path with a placeholder's name is not filled again.
  EXPECT_EQ(FillPlaceholders("a RECORDING RESULT", {{"RECORDING", "RESULT"}, {"RESULT", "x"}}),
            "a RESULT x");
}

}  // namespace
}  // namespace flextip
