// A term's columns against their formulas, its derivatives against differences.
#include "diagnosis/effects/discovered/discovered_term.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "diagnosis/effects/discovered/term_text.h"
#include "tests/diagnosis/small_recording.h"

namespace flextip::diagnosis {
namespace {

Term EmTerm(TermShape shape, TermVariable variable, std::vector<double> at) {
  Term term;
  term.shape = shape;
  term.variable = variable;
  term.at = std::move(at);
  term.amplitude = Eigen::MatrixXd::Zero(3, term.Columns());
  for (Eigen::Index i = 0; i < term.amplitude.size(); ++i)
    term.amplitude.reshaped()[i] = 1e-3 * double(i + 1);
  term.offset = Eigen::Vector3d(1e-4, -2e-4, 3e-4);
  return term;
}

TermState At(double v) {
  TermState state;
  state.t_s = v;
  state.scalar.fill(v);
  state.position = Eigen::Vector3d(v, 2.0 * v, 0.0);
  state.own = Eigen::Vector4d(v, -v, 0.5 * v, 0.0);
  return state;
}

double Column(TermShape shape, std::vector<double> at, double v, Eigen::Index column = 0) {
  EffectMemory memory{};
  return ColumnsAt(EmTerm(shape, TermVariable::kTime, std::move(at)), At(v), memory)(1, column);
}

TEST(DiscoveredTerm, HasTheColumnsOfItsShape) {
  const double v = 1.3;
  EXPECT_DOUBLE_EQ(Column(TermShape::kLinear, {0.5}, v), 0.8);
  EXPECT_DOUBLE_EQ(Column(TermShape::kQuadratic, {0.5}, v, 1), 0.8 * 0.8);
  EXPECT_DOUBLE_EQ(Column(TermShape::kPeriodic, {0.7}, v),
                   std::sin(2.0 * std::numbers::pi * 0.7 * v));
  EXPECT_NEAR(Column(TermShape::kStep, {1.0, 0.05}, v), 1.0, 1e-6);
  EXPECT_NEAR(Column(TermShape::kStep, {2.0, 0.05}, v), 0.0, 1e-6);
  EXPECT_DOUBLE_EQ(Column(TermShape::kBeyond, {1.0}, v), v - 1.0);
  EXPECT_DOUBLE_EQ(Column(TermShape::kBelow, {1.0}, v), 0.0);
  EXPECT_DOUBLE_EQ(Column(TermShape::kBand, {1.0}, v), v - 1.0);
  EXPECT_DOUBLE_EQ(Column(TermShape::kExponential, {2.0, 0.1}, v), std::exp(-1.2 / 2.0));
  EXPECT_DOUBLE_EQ(Column(TermShape::kAfter, {2.0, 2.0}, v), 0.0);
}

TEST(DiscoveredTerm, HasTheProductsOfAVectorsComponents) {
  TermState state;
  state.image = Eigen::Vector2d(0.3, -0.4);
  const auto row = [&](TermShape shape) {
    EffectMemory memory{};
    return Eigen::VectorXd(
        ColumnsAt(EmTerm(shape, TermVariable::kImagePosition, {}), state, memory).row(2));
  };
  Eigen::VectorXd products(5);
  products << 0.3, -0.4, 0.3 * 0.3, 0.3 * -0.4, -0.4 * -0.4;
  EXPECT_LT((row(TermShape::kQuadratic) - products).norm(), 1e-15);
  // As Brown's first radial coefficient moves a ray.
  EXPECT_LT((row(TermShape::kRadial) - 0.25 * Eigen::Vector2d(0.3, -0.4)).norm(), 1e-15);
}

TEST(DiscoveredTerm, SplinesAddUpToOneWithinTheirRangeAndFadeOutside) {
  const auto sum = [](double v) {
    double all = 0.0;
    for (Eigen::Index j = 0; j < kSplines; ++j) all += Column(TermShape::kSmooth, {1.0, 3.0}, v, j);
    return all;
  };
  for (const double v : {1.0, 1.2, 1.9, 2.5, 3.0}) EXPECT_NEAR(sum(v), 1.0, 1e-12) << v;
  EXPECT_NEAR(sum(3.1), 0.5, 1e-9);
  EXPECT_EQ(sum(4.0), 0.0);
}

TEST(DiscoveredTerm, APlayIsThePlayOperatorOfEachInput) {
  const double half = 0.2;
  const Term term = EmTerm(TermShape::kPlay, TermVariable::kOwnValue, {half});
  EffectMemory memory{};
  double kept = 0.0;
  for (int k = 0; k < 200; ++k) {
    const double v = std::sin(0.07 * k);
    const TermColumns columns = ColumnsAt(term, At(v), memory);
    kept = k == 0 ? -v : std::clamp(kept, -v - half, -v + half);  // of the second input: -v
    EXPECT_NEAR(columns(1, 0), -v - kept, 1e-12) << k;
  }
}

TEST(DiscoveredTerm, WhatRelaxesIsForgottenWithItsTimeConstant) {
  const Term term = EmTerm(TermShape::kRelaxing, TermVariable::kInsertionDepth, {0.5});
  EffectMemory memory{};
  TermState state = At(0.0);
  ColumnsAt(term, state, memory);
  state.scalar[1] = 1.0;  // jumps, and stays
  double last = 0.0;
  for (int k = 1; k <= 100; ++k) {
    state.t_s = 0.01 * k;
    last = ColumnsAt(term, state, memory)(0, 0);
  }
  EXPECT_NEAR(last, std::exp(-1.0 / 0.5), 1e-9);
}

TEST(DiscoveredTerm, DerivativesAreThoseOfDifferences) {
  const SampleSet samples = SmallSamples(4.0, true, 5);
  struct Case {
    TermShape shape;
    TermVariable variable;
    std::vector<double> at;
    double sd;
  };
  const std::vector<Case> cases = {
      {TermShape::kPeriodic, TermVariable::kTime, {1.7}, 0.02},
      {TermShape::kExponential, TermVariable::kTime, {1.5, 0.0}, 0.2},
      {TermShape::kStep, TermVariable::kInsertionDepth, {0.2, 0.05}, 0.01},
      {TermShape::kTanh, TermVariable::kSlidingVelocity, {0.02}, 0.002}};
  for (const Case& one : cases) {
    const DiscoveredTerm effect(EmTerm(one.shape, one.variable, one.at), "found", {one.sd});
    Eigen::VectorXd theta = effect.Theta();
    theta[theta.size() - 1] = 0.5 * one.sd;
    const auto inputs = [&](const Eigen::VectorXd& x, std::vector<InputChange::Column>& columns) {
      SampleInputs u = SampleInputs::Zero();
      EffectMemory memory{};
      InputChange change(x.data(), 0, u, columns);
      effect.Apply(x.data(), {samples, 90, samples.samples[90].t_s}, memory, change);
      return u;
    };
    std::vector<InputChange::Column> columns, ignored;
    inputs(theta, columns);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(sample_input::kCount, theta.size());
    for (const auto& column : columns) J(column.input, column.parameter) += column.value;
    for (Eigen::Index j = 0; j < theta.size(); ++j) {
      const double h = 1e-4 * (j + 1 == theta.size() ? one.sd : 1e-3);
      const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(theta.size(), j);
      const Eigen::VectorXd difference =
          (inputs(theta + step, ignored) - inputs(theta - step, ignored)) / (2.0 * h);
      EXPECT_LT((J.col(j) - difference).norm(), 1e-4 * (difference.norm() + 1e-9))
          << Name(one.shape) << " " << j;
    }
  }
}

TEST(DiscoveredTerm, IsSaidInWordsAndUnits) {
  Term swing = EmTerm(TermShape::kPeriodic, TermVariable::kTime, {1.312});
  swing.amplitude << 0.0, 0.00082, 0.0, 0.0, 0.0, 0.0;
  swing.offset.resize(0);
  EXPECT_EQ(TextOf(swing), "the EM position swings by 0.82 mm at 1.312 Hz");
  const auto parameters = TermParameters(swing);
  ASSERT_EQ(parameters.size(), 3U);
  EXPECT_EQ(parameters[0].name, "amplitude_m");
  EXPECT_NEAR(parameters[0].value[0], 0.00082, 1e-12);
  EXPECT_EQ(parameters[1].name, "phase_rad");
  EXPECT_NEAR(parameters[1].value[0], 0.5 * std::numbers::pi, 1e-9);
  EXPECT_EQ(parameters[2].name, "frequency_hz");
  Term slope = EmTerm(TermShape::kLinear, TermVariable::kTime, {1.0});
  slope.amplitude = Eigen::Vector3d(0.0, 4e-5, 3e-5);
  EXPECT_EQ(TextOf(slope), "the EM position changes in proportion to time, by 0.05 mm per s");
  slope.variable = TermVariable::kOwnValue;
  EXPECT_EQ(TextOf(slope), "the EM position changes by 5e-05 of its own value");
  EXPECT_EQ(FormOf(swing), TermForm::kPeriodic);
}

TEST(DiscoveredTerm, AnExponentialDecaysOrSaturates) {
  Term term = EmTerm(TermShape::kExponential, TermVariable::kTime, {2.0, 0.0});
  term.amplitude = Eigen::Vector3d(-1e-3, 0.0, 0.0);
  term.offset = Eigen::Vector3d(1e-3, 0.0, 0.0);
  EXPECT_EQ(FormOf(term), TermForm::kSaturating);  // from nothing to 1 mm
  term.offset.setZero();
  EXPECT_EQ(FormOf(term), TermForm::kDecaying);
}

}  // namespace
}  // namespace flextip::diagnosis
