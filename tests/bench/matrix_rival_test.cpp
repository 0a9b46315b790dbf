// Rivals of one and of two effects, on columns made by hand.
#include "bench/diagnosis_matrix/rival.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace flextip::bench {
namespace {

enum : int { kStiffness, kLength, kEmLatency, kTipCompliance };

/// Four effects of one parameter each; only the last cannot be negative.
diagnosis::ParameterLayout FourEffects() {
  diagnosis::SampleSet samples;
  samples.has_load = true;  // no mean of an unknown force
  diagnosis::Catalogue catalogue;
  catalogue.push_back(diagnosis::MakeStiffness());
  catalogue.push_back(diagnosis::MakeLength());
  catalogue.push_back(diagnosis::MakeEmLatency());
  catalogue.push_back(diagnosis::MakeTipCompliance());
  return {samples, std::move(catalogue)};
}

/// Every effect ten tolerances beyond nominal, and columns that say what one tolerance of each does
/// to four measured rows.
struct Toy {
  diagnosis::ParameterLayout layout = FourEffects();
  Eigen::VectorXd theta = 10.0 * layout.Tolerances();
  Eigen::Matrix4d columns = 5.0 * Eigen::Matrix4d::Identity();

  Separation Rival(const std::vector<int>& present) const {
    const Eigen::MatrixXd X =
        columns * Eigen::MatrixXd(layout.Tolerances().cwiseInverse().asDiagonal());
    return NearestRival(X.transpose() * X, theta, layout, present);
  }
  /// Least cost of the signal of effect `j`, which nothing else shares.
  double CostAlone(int j, bool is_present) const {
    const double A = columns.col(j).squaredNorm();
    const double wide = 3.0 * layout.Parameter(j).typical / layout.Tolerances()[j];
    return 100.0 * A / (1.0 + (is_present ? wide * wide : 1.0) * A);
  }
};

TEST(MatrixRival, WhatNothingKnownMakesIsLeftWhole) {
  const Toy toy;
  const Eigen::MatrixXd X =
      toy.columns * Eigen::MatrixXd(toy.layout.Tolerances().cwiseInverse().asDiagonal());
  const Eigen::MatrixXd H = X.transpose() * X;
  const Separation none = NearestKnown(H, Eigen::Vector4d::Zero(), 50.0, toy.layout);
  EXPECT_EQ(none.rival, "none");
  EXPECT_DOUBLE_EQ(none.value, 50.0);
  // Beside what a latency makes, but for what its prior costs.
  Eigen::VectorXd latency = Eigen::VectorXd::Zero(4);
  latency[kEmLatency] = toy.theta[kEmLatency];
  const Eigen::VectorXd g = H * latency;
  const Separation some = NearestKnown(H, g, latency.dot(g) + 50.0, toy.layout);
  EXPECT_EQ(some.rival, "em_latency");
  EXPECT_NEAR(some.value, 50.0 + toy.CostAlone(kEmLatency, true), 1e-6);
}

TEST(MatrixRival, APairIsAsFarFromOneOfItAsTheOtherShows) {
  Toy toy;
  toy.columns.col(kLength) *= 0.5;
  const Separation separation = toy.Rival({kStiffness, kLength});
  EXPECT_EQ(separation.rival, "stiffness");
  EXPECT_NEAR(separation.value, toy.CostAlone(kLength, false) - toy.CostAlone(kLength, true), 1e-6);
  EXPECT_GT(separation.value, kSeparable);
}

TEST(MatrixRival, APairOfWhichOneAddsNothingIsNotSeparable) {
  Toy toy;
  toy.columns.col(kLength).setZero();
  const Separation separation = toy.Rival({kStiffness, kLength});
  EXPECT_EQ(separation.rival, "stiffness");
  EXPECT_NEAR(separation.value, 0.0, 1e-6);
  toy.columns.setZero();
  EXPECT_EQ(toy.Rival({kStiffness, kLength}).rival, "none");
}

TEST(MatrixRival, AnotherPairWithATwinIsTheRival) {
  Toy toy;
  EXPECT_GT(toy.Rival({kStiffness, kLength}).value, kSeparable);
  toy.columns.col(kEmLatency) = 0.9 * toy.columns.col(kLength);
  const Separation pair = toy.Rival({kStiffness, kLength}), single = toy.Rival({kLength});
  EXPECT_EQ(pair.rival, "em_latency+stiffness");
  EXPECT_LT(pair.value, 1.0);
  EXPECT_EQ(single.rival, "em_latency");
  EXPECT_LT(single.value, 1.0);
}

TEST(MatrixRival, WhatCannotBeNegativeIsNoRivalWhereItWouldHaveToBe) {
  Toy toy;
  toy.columns.col(kTipCompliance) = -toy.columns.col(kLength);
  EXPECT_GT(toy.Rival({kStiffness, kLength}).value, kSeparable);
  toy.columns.col(kTipCompliance) *= -1.0;
  const Separation separation = toy.Rival({kStiffness, kLength});
  EXPECT_LT(separation.value, 1.0);
  EXPECT_EQ(separation.rival, "stiffness+tip_compliance");
}

TEST(MatrixRival, PairsAreNoRivalsOfASingleEffect) {
  Toy toy;
  toy.columns.col(kLength) = toy.columns.col(kStiffness) + toy.columns.col(kEmLatency);
  EXPECT_GT(toy.Rival({kLength}).value, kSeparable);
  const Separation pair = toy.Rival({kLength, kTipCompliance});
  EXPECT_GT(pair.value, kSeparable);
  EXPECT_NE(pair.rival, "none");
}

/// One parameter and one generic term with correlated columns.
TEST(MatrixRival, GenericTermsTakeWhatTheirPriorAllows) {
  diagnosis::LinearProblem problem;
  problem.parameters = 1;
  problem.generic_row = {0};
  problem.total = diagnosis::NormalSums(2);
  problem.total.H << 4.0, 2.0, 2.0, 3.0;
  const auto left = [&](double sd) {
    return WithoutGeneric(problem, Eigen::VectorXd::Constant(1, sd))(0, 0);
  };
  EXPECT_NEAR(left(1e-9), 4.0, 1e-9);
  EXPECT_NEAR(left(1.0), 4.0 - 2.0 * 2.0 / (3.0 + 1.0), 1e-12);
  EXPECT_NEAR(left(1e6), 4.0 - 4.0 / 3.0, 1e-9);
}

}  // namespace
}  // namespace flextip::bench
