#include "core/check.h"

#include <gtest/gtest.h>

namespace flextip {
namespace {

TEST(Check, PassesWhereTheConditionHolds) {
  int evaluated = 0;
  FLEXTIP_CHECK(++evaluated == 1, "evaluated once");
  EXPECT_EQ(evaluated, 1);
}

/// In every build type: NDEBUG does not turn it off.
TEST(CheckDeathTest, AbortsAndNamesConditionMessageFileAndLine) {
  const int index = 7;
  EXPECT_DEATH(FLEXTIP_CHECK(index < 4, "index within the gages"),
               "check failed: index within the gages \\(index < 4\\) at .*check_test\\.cpp:[0-9]+");
}

}  // namespace
}  // namespace flextip
