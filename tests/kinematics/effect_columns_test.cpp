// Columns of the rod with effects by the processor's wide vectors and by narrow ones.
#include "kinematics/effect_columns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

namespace flextip::effect_flow {
namespace {

ColumnMatrix Random(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  return ColumnMatrix::NullaryExpr([&] { return normal(rng); });
}

double Difference(const FlowColumns& a, const FlowColumns& b) {
  return std::max({(a.turn - b.turn).cwiseAbs().maxCoeff(), (a.m - b.m).cwiseAbs().maxCoeff(),
                   (a.P - b.P).cwiseAbs().maxCoeff()});
}

TEST(EffectColumns, AreTheSameTwoAtATime) {
  std::mt19937_64 rng(71);
  FlowState start;
  start.m = {0.3, -0.8, 1.1};
  FlowPath path;
  ASSERT_TRUE(path.Walk(start, {{1.0, -2.0, 0.5}, {0.1, 0.2, -0.3}, {0.4, -0.2}, 1.1, -0.2}, 0.6));
  FlowForcing forcing;
  forcing.dn0 = Random(rng);
  forcing.dq = Random(rng);
  forcing.dcurvature = Random(rng).topRows<2>();
  const FlowColumns at_start{Random(rng), Random(rng), Random(rng)};
  const std::array places{0.1, -1.0, 0.55};
  FlowColumns wide = at_start, narrow = at_start;
  std::array<FlowColumns, 3> wide_at, narrow_at;
  CarryColumns(path, forcing, 0, kMaxColumns, wide, places, wide_at.data());
  CarryByTwo(path, forcing, 0, kMaxColumns, narrow, places, narrow_at.data());
  EXPECT_GT(Difference(wide, at_start), 0.1);  // the columns were carried at all
  EXPECT_LT(Difference(wide, narrow), 1e-13);
  for (std::size_t i = 0; i < places.size(); ++i)
    EXPECT_LT(Difference(wide_at[i], narrow_at[i]), 1e-13) << i;
}

}  // namespace
}  // namespace flextip::effect_flow
