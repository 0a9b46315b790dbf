#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/mean_sd.h"
#include "core/median.h"

namespace flextip {
namespace {

TEST(Median, IsTheUpperOfTwoInTheMiddle) {
  EXPECT_EQ(Median<double>({5.0, 1.0, 3.0}), 3.0);
  EXPECT_EQ(Median<int>({4, 1, 3, 2}), 3);
  EXPECT_EQ(Median<double>({}), 0.0);
  EXPECT_EQ(Median(std::array{5.0, 1.0, 3.0}), 3.0);
  EXPECT_EQ(Median(std::array{4, 1, 3, 2}), 3);
}

TEST(Quantile, InterpolatesBetweenNeighbours) {
  EXPECT_DOUBLE_EQ(Quantile({4.0, 0.0, 2.0}, 0.25), 1.0);
  EXPECT_DOUBLE_EQ(Quantile({4.0, 0.0, 2.0}, 0.0), 0.0);
  EXPECT_DOUBLE_EQ(Quantile({4.0, 0.0, 2.0}, 1.0), 4.0);
  EXPECT_DOUBLE_EQ(Quantile({4.0, 0.0, 2.0}, 7.0), 4.0);
  EXPECT_EQ(Quantile({}, 0.5), 0.0);
}

TEST(LowerQuantile, IsAMemberOfTheValues) {
  EXPECT_EQ(LowerQuantile<double>({4.0, 0.0, 2.0}, 0.49), 0.0);
  EXPECT_EQ(LowerQuantile<double>({4.0, 0.0, 2.0}, 0.5), 2.0);
  EXPECT_EQ(LowerQuantile<double>({4.0, 0.0, 2.0}, 1.0), 4.0);
  EXPECT_EQ(LowerQuantile<double>({}, 0.5), 0.0);
}

TEST(MeanSd, IsThatOfASample) {
  const MeanSd of = MeanSdOf({2, 4, 4, 4, 5, 5, 7, 9});
  EXPECT_EQ(of.count, 8);
  EXPECT_DOUBLE_EQ(of.mean, 5.0);
  EXPECT_DOUBLE_EQ(of.sd, std::sqrt(32.0 / 7.0));
  EXPECT_DOUBLE_EQ(of.StandardError(), of.sd / std::sqrt(8.0));
  EXPECT_EQ(MeanSdOf({3.0}).sd, 0.0);
  EXPECT_EQ(MeanSdOf({}).StandardError(), 0.0);
}

}  // namespace
}  // namespace flextip
