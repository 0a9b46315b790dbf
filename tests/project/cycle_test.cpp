// The control cycle reads on one page.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

namespace flextip {
namespace {

std::string TextOf(const std::string& file) {
  std::ifstream stream(std::string(FLEXTIP_SOURCE_DIR) + "/" + file);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Lines from the function's head to the brace that closes it; 0 where there is no such function.
long LinesOf(const std::string& text, const std::string& head) {
  const std::size_t begin = text.find("\n" + head);
  if (begin == std::string::npos) return 0;
  const std::size_t end = text.find("\n}\n", begin);
  const auto first = text.begin() + static_cast<std::ptrdiff_t>(begin + 1);
  return 1 + std::count(first, text.begin() + static_cast<std::ptrdiff_t>(end + 2), '\n');
}

TEST(Cycle, OneFunctionOfAtMostFortyLinesCarriesIt) {
  const std::string text = TextOf("pipeline/instrument_controller.cpp");
  const std::string head = "ControllerCommand InstrumentController::Step(";
  EXPECT_GT(LinesOf(text, head), 5);
  EXPECT_LE(LinesOf(text, head), 40);
  const std::string cycle = text.substr(text.find(head));
  std::size_t at = 0;
  for (const char* stage :
       {"See(", "Gather(", "Correct(", "Vote(", "Estimate(", "Fuse(", "Control(", "Supervise("}) {
    at = cycle.find(stage, at);
    EXPECT_NE(at, std::string::npos) << stage;
  }
}

TEST(Cycle, LinesAreCountedToTheClosingBrace) {
  EXPECT_EQ(LinesOf("\nvoid F() {\n  if (a) {\n  }\n}\nvoid G() {\n}\n", "void F("), 4);
  EXPECT_EQ(LinesOf("\n", "void F("), 0);
}

}  // namespace
}  // namespace flextip
