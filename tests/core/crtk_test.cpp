// Names and lines of robot states.
#include "core/robot/crtk.h"

#include <gtest/gtest.h>

namespace flextip {
namespace {

TEST(Crtk, NamesComeBack) {
  for (const CrtkState s :
       {CrtkState::kDisabled, CrtkState::kEnabled, CrtkState::kPaused, CrtkState::kFault}) {
    EXPECT_EQ(CrtkStateOf(Name(s)), s);
  }
  for (const CrtkCommand c : {CrtkCommand::kEnable, CrtkCommand::kDisable, CrtkCommand::kPause,
                              CrtkCommand::kResume, CrtkCommand::kHome, CrtkCommand::kUnhome}) {
    EXPECT_EQ(CrtkCommandOf(Name(c)), c);
  }
  EXPECT_STREQ(Name(CrtkState::kFault), "FAULT");
  EXPECT_STREQ(Name(CrtkCommand::kUnhome), "unhome");
  EXPECT_FALSE(CrtkStateOf("enabled"));
  EXPECT_FALSE(CrtkCommandOf("ENABLE"));
}

TEST(Crtk, LinesComeBack) {
  for (const bool homed : {false, true}) {
    for (const bool busy : {false, true}) {
      const auto back = CrtkOperatingStateOf(Text({CrtkState::kPaused, homed, busy}));
      ASSERT_TRUE(back);
      EXPECT_EQ(back->state, CrtkState::kPaused);
      EXPECT_EQ(back->is_homed, homed);
      EXPECT_EQ(back->is_busy, busy);
    }
  }
  EXPECT_EQ(Text({CrtkState::kEnabled, true, false}), "ENABLED homed");
}

TEST(Crtk, OtherLinesAreNone) {
  for (const char* text : {"", " ", "ENABLED homed homed", "ENABLED busy homed", "homed",
                           "ENABLED  homed", "ENABLED moving", "ENABLED\n"}) {
    EXPECT_FALSE(CrtkOperatingStateOf(text)) << text;
  }
}

}  // namespace
}  // namespace flextip
