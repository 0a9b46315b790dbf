// A cold start takes a bounded number of solves, and none where the load cannot be reached.
#include "kinematics/load_steps.h"

#include <gtest/gtest.h>

namespace flextip {
namespace {

/// Counts the solves of a rod that has no equilibrium above `limit`, a part of the load.
struct Counted {
  int solves = 0, iterations = 0;
};
Counted Start(double load, double limit) {
  Counted counted;
  double x = 0.0;
  counted.iterations = InLoadSteps(
      load, 20, x, [](double part) { return part; },
      [&](double part, double& at) {
        ++counted.solves;
        at = part;
        return part <= limit ? 3 : 0;
      });
  return counted;
}

TEST(LoadSteps, ReachesALoadInAsManyStepsAsItsSizeAsks) {
  EXPECT_EQ(Start(0.5, 1.0).solves, 1);
  EXPECT_EQ(Start(6.9, 1.0).solves, 10);
  EXPECT_EQ(Start(6.9, 1.0).iterations, 30);
  EXPECT_EQ(Start(41.9, 1.0).solves, 60);
}

TEST(LoadSteps, DoesNotSetOutForALoadThatItCannotReach) {
  for (const double load : {42.1, 100.0, 1e6, 1e300}) {
    EXPECT_EQ(Start(load, 1.0).solves, 0) << load;
    EXPECT_EQ(Start(load, 1.0).iterations, 0) << load;
  }
}

TEST(LoadSteps, GivesUpWhereTheStepsLeftCannotReachTheLoad) {
  for (const double load : {0.5, 7.0, 30.0}) {
    for (const double limit : {0.0, 0.3, 0.999}) {
      const Counted counted = Start(load, limit);
      EXPECT_EQ(counted.iterations, 0);
      EXPECT_LT(counted.solves, 60) << load << ", " << limit;
    }
    EXPECT_LE(Start(load, 0.0).solves, 6) << load;
  }
}

}  // namespace
}  // namespace flextip
