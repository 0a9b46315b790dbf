#include "tests/project/draw_rules.h"

#include <gmock/gmock.h>

namespace flextip {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(DrawRules, NoCallDrawsInTwoOfItsArguments) {
  const SourceTree tree = ReadSourceTree(FLEXTIP_SOURCE_DIR);
  ASSERT_TRUE(tree.contains("core/draw_vector.h"));
  EXPECT_THAT(UnorderedDraws(tree), IsEmpty()) << "draw into named values, or by DrawVector";
}

std::vector<std::string> DrawsIn(const std::string& code) {
  return UnorderedDraws({{"a.cpp", "void F(std::mt19937& rng) {\n" + code + "\n}"}});
}

TEST(DrawRules, SeeTwoArgumentsThatDraw) {
  EXPECT_THAT(DrawsIn("return Vector3d(u(rng), 0, 1 + 2 * n(rng));"),
              ElementsAre("a.cpp:2: Vector3d(...) draws in 2 arguments"));
  EXPECT_THAT(DrawsIn("Vector2d x(u(rng), u(rng)), y;"),
              ElementsAre("a.cpp:2: x(...) draws in 2 arguments"));
  EXPECT_THAT(DrawsIn("v.emplace_back(u(rng),\n  {1, u(rng)});"),
              ElementsAre("a.cpp:2: emplace_back(...) draws in 2 arguments"));
  EXPECT_THAT(DrawsIn("G(1, std::vector<int>(H(u(rng)), H(Pose(rng))));"),
              ElementsAre("a.cpp:2: >(...) draws in 2 arguments"));
}

TEST(DrawRules, SeeLambdasAndMembersThatDraw) {
  EXPECT_THAT(
      DrawsIn("const auto d = [&](double s) -> double { return s * n(rng); };\nG(d(1), d(2));"),
      ElementsAre("a.cpp:3: G(...) draws in 2 arguments"));
  EXPECT_THAT(UnorderedDraws({{"a.h", "class A { std::mt19937_64 rng_; };"},
                              {"a.cpp", "void A::F() { G(u_(rng_), u_(rng_)); }"}}),
              ElementsAre("a.cpp:1: G(...) draws in 2 arguments"));
}

TEST(DrawRules, LeaveAnOrderThatTheLanguageFixes) {
  EXPECT_THAT(DrawsIn("G({u(rng), u(rng)}); Vector2d x{u(rng), u(rng)};"), IsEmpty());
  EXPECT_THAT(DrawsIn("const double a = u(rng), b = u(rng); G(a, b);"), IsEmpty());
  EXPECT_THAT(DrawsIn("G(u(rng), rng); H(DrawVector<3>(n, rng), rng);"),
              IsEmpty());  // drawn, then G
  EXPECT_THAT(DrawsIn("G(u(rng)).H(u(rng));"), IsEmpty());
  EXPECT_THAT(DrawsIn("G([&] { return u(rng); }, u(rng));"), IsEmpty());
  EXPECT_THAT(DrawsIn("for (int i = u(rng); i < 3; i += u(rng)) G(i);"), IsEmpty());
}

}  // namespace
}  // namespace flextip
