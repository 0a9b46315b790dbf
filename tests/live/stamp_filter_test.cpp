#include "live/protocols/stamp_filter.h"

#include <gtest/gtest.h>

namespace flextip::live {
namespace {

WireMessage Numbers(const std::string& device, TimeNs t_ns) {
  return {device, t_ns, WireNumbers{}};
}
WireMessage Said(TimeNs t_ns, const std::string& text) { return {"state", t_ns, WireText{text}}; }

TEST(StampFilter, LetsEachDevicePassInIncreasingTime) {
  StampFilter filter;
  EXPECT_EQ(filter.Judge(Numbers("a", 10)), StampVerdict::kPass);
  EXPECT_EQ(filter.Judge(Numbers("b", 5)), StampVerdict::kPass);
  EXPECT_EQ(filter.Judge(Numbers("a", 10)), StampVerdict::kRepeated);
  EXPECT_EQ(filter.Judge(Numbers("a", 9)), StampVerdict::kOutOfOrder);
  EXPECT_EQ(filter.Judge(Numbers("a", 11)), StampVerdict::kPass);
  EXPECT_EQ(filter.Judge(Numbers("a", 10)), StampVerdict::kOutOfOrder);
  EXPECT_EQ(filter.Judge(Numbers("b", 6)), StampVerdict::kPass);
  EXPECT_EQ(filter.Last("a"), 11);
  EXPECT_EQ(filter.Last("c"), 0);
}

TEST(StampFilter, LetsDifferentTextsOfOneTimePass) {
  StampFilter filter;
  EXPECT_EQ(filter.Judge(Said(10, "home")), StampVerdict::kPass);
  EXPECT_EQ(filter.Judge(Said(10, "enable")), StampVerdict::kPass);
  EXPECT_EQ(filter.Judge(Said(10, "enable")), StampVerdict::kRepeated);
  EXPECT_EQ(filter.Judge(Said(9, "disable")), StampVerdict::kOutOfOrder);
}

TEST(StampFilter, LetsTimeZeroPassAsInvalid) {
  StampFilter filter;
  EXPECT_EQ(filter.Judge(Numbers("a", 10)), StampVerdict::kPass);
  EXPECT_EQ(filter.Judge(Numbers("a", 0)), StampVerdict::kPass);
  EXPECT_EQ(filter.Judge(Numbers("a", 0)), StampVerdict::kPass);
  EXPECT_EQ(filter.Judge(Numbers("a", 10)), StampVerdict::kRepeated);
}

TEST(StampFilter, KnowsANumberOfDevicesThatEnds) {
  StampFilter filter;
  for (int i = 0; i < 1024; ++i)
    EXPECT_EQ(filter.Judge(Numbers(std::to_string(i), 1)), StampVerdict::kPass);
  EXPECT_EQ(filter.Judge(Numbers("one more", 1)), StampVerdict::kTooManyDevices);
  EXPECT_EQ(filter.Judge(Numbers("7", 2)), StampVerdict::kPass);
}

}  // namespace
}  // namespace flextip::live
