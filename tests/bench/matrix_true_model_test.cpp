// The model with the label's parameters: what it names, what it could know at best, what it leaves.
#include "bench/diagnosis_matrix/true_model.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "bench/diagnosis_matrix/bound.h"
#include "bench/diagnosis_matrix/heldout.h"
#include "diagnosis/evidence/linear_problem.h"

namespace flextip::bench {
namespace {

std::array<double, diagnosis::kChannelCount> StatedNoise() {
  std::array<double, diagnosis::kChannelCount> scale;
  scale.fill(1.0);
  return scale;
}

hidden::HiddenRecording Hidden(const std::string& effect, hidden::EffectSize size,
                               bool with_load = true) {
  hidden::HiddenOptions options;
  options.effects = {effect};
  options.size = size;
  options.exact = true;
  options.with_load = with_load;
  options.scene.load = hidden::LoadKind::kVarying;
  options.scene.duration_s = 8.0;
  options.links_per_side = 30;
  return hidden::MakeHidden(options, 31);
}

TEST(TrueModel, KnowsWhatTheLabelNamesAndWhatNot) {
  const hidden::HiddenRecording hidden = Hidden("port_motion", hidden::EffectSize::kPlain, false);
  const TrueModel truth(hidden.recording, hidden);
  const auto unnamed_of = [&](const std::string& effect) {
    const auto& block = truth.layout.Blocks()[truth.layout.Find(effect)];
    int count = 0;
    for (const int j : truth.parameters.unnamed)
      count += j >= block.first && j < block.first + block.size ? 1 : 0;
    return count;
  };
  EXPECT_EQ(unnamed_of("port_motion"), 6);    // overtones
  EXPECT_EQ(unnamed_of("em_distortion"), 3);  // where it is zero
  EXPECT_EQ(unnamed_of("backlash"), 3);       // where in the play it began
  EXPECT_EQ(unnamed_of("focal_length"), 1);   // the turn beside it
  EXPECT_EQ(unnamed_of("lens_radial"), 2);    // depth and turn beside it
  EXPECT_EQ(unnamed_of("port_moment"), 0);
  EXPECT_EQ(unnamed_of("stiffness"), 0);
  int nuisance = 0;
  for (const auto& block : truth.layout.Blocks()) nuisance += block.nuisance ? block.size : 0;
  EXPECT_EQ(int(truth.parameters.unnamed.size()), 6 + 3 + 3 + 1 + 2 + nuisance);
  EXPECT_GT(nuisance, 0);
  ASSERT_EQ(truth.present.size(), 1u);
  EXPECT_EQ(truth.layout.Blocks()[truth.present[0]].effect->Name(), "port_motion");
}

TEST(CramerRaoBound, IsTheInverseOfWhatDataAndPriorSay) {
  Eigen::Matrix2d H;
  H << 4.0, 2.0, 2.0, 4.0;
  const Eigen::MatrixXd free = PosteriorCovariance(H, Eigen::Vector2d(1e5, 1e5));
  EXPECT_NEAR(free(0, 0), 1.0 / 3.0, 1e-6);
  EXPECT_NEAR(free(0, 1), -1.0 / 6.0, 1e-6);
  const Eigen::MatrixXd held = PosteriorCovariance(H, Eigen::Vector2d(0.5, 1e-6));
  EXPECT_NEAR(held(0, 0), 1.0 / (4.0 + 4.0), 1e-6);
  EXPECT_NEAR(held(1, 1), 1e-12, 1e-15);
}

double BoundOn(const hidden::HiddenRecording& hidden, const std::string& effect) {
  TrueModel truth(hidden.recording, hidden);
  for (const diagnosis::EffectFit& bound : CramerRaoBounds(truth))
    if (bound.effect == effect) return bound.parameters.at(0).sd.at(0);
  ADD_FAILURE() << effect << " has no bound";
  return 0.0;
}

/// Who must learn how the EM field is bent knows less of the length.
TEST(CramerRaoBound, OfAPairIsLargerThanOfOneAlone) {
  hidden::HiddenRecording hidden = Hidden("length", hidden::EffectSize::kPlain);
  const double alone = BoundOn(hidden, "length");
  hidden.label.present = {"em_distortion", "length"};
  EXPECT_GT(BoundOn(hidden, "length"), 1.01 * alone);
  EXPECT_GT(alone, 0.0);
}

/// Reported is the scale, fitted its logarithm.
TEST(CramerRaoBound, IsInTheTermsOfTheReport) {
  const hidden::HiddenRecording hidden = Hidden("stiffness", hidden::EffectSize::kStrong);
  TrueModel truth(hidden.recording, hidden);
  const auto bounds = CramerRaoBounds(truth);
  const double scale = hidden.label.parameters.at("stiffness").at("scale").at(0);
  ASSERT_EQ(bounds.size(), 1u);
  EXPECT_NEAR(bounds[0].parameters.at(0).value.at(0), scale, 1e-12);
  const Eigen::MatrixXd C =
      PosteriorCovariance(diagnosis::MakeLinearProblem(truth.replay, {}, 1).total.H,
                          truth.layout.Widened({truth.layout.Find("stiffness")}, {3.0}));
  const int j = truth.layout.Blocks()[truth.layout.Find("stiffness")].first;
  EXPECT_NEAR(bounds[0].parameters.at(0).sd.at(0), scale * std::sqrt(C(j, j)), 1e-12);
}

TEST(TrueHeldOut, FitsOnlyWhatIsFree) {
  Eigen::Matrix2d X;
  X << 1.0, 0.0, 1.0, 2.0;
  const Eigen::Vector2d z(1.0, 7.0);
  diagnosis::NormalSums sums(2);
  sums.H = X.transpose() * X;
  sums.g = X.transpose() * z;
  const Eigen::VectorXd wide = Eigen::VectorXd::Constant(2, 1e6);
  // The first stays 3, so the second explains 7 - 3 by 2 x.
  const Eigen::VectorXd fitted = FitFree(sums, {1}, wide, Eigen::Vector2d(3.0, 100.0));
  EXPECT_EQ(fitted[0], 3.0);
  EXPECT_NEAR(fitted[1], 2.0, 1e-6);
  const Eigen::VectorXd narrow = FitFree(sums, {1}, 0.5 * Eigen::Vector2d::Ones(), fitted);
  EXPECT_NEAR(narrow[1], 2.0 * 4.0 / (4.0 + 4.0), 1e-9);
  EXPECT_EQ(FitFree(sums, {}, wide, fitted), fitted);
}

/// Of all rows, with parameters as the replay has them, in standard deviations.
double WeightedRms(const diagnosis::Replay& replay) {
  const auto residuals = replay.ForceFreeResiduals();
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    const diagnosis::Rows sd = replay.RowNoise(k);
    for (int r = 0; r < diagnosis::row::kCount; ++r) {
      if (!replay.Set().samples[k].present[r]) continue;
      sum += std::pow(residuals[k][r] / sd[r], 2);
      count += 1.0;
    }
  }
  return std::sqrt(sum / count);
}

TEST(TrueHeldOut, TheTrueModelLeavesNoiseAndTheBaseDoesNot) {
  const hidden::HiddenRecording hidden = Hidden("length", hidden::EffectSize::kPlain, false);
  TrueModel truth(hidden.recording, hidden);
  const double error = TrueHeldOutError(truth, StatedNoise());
  EXPECT_GT(error, 0.8);  // unknown forces take up some of the noise
  EXPECT_LT(error, 1.05);
  truth.replay.Evaluate(Eigen::VectorXd::Zero(truth.layout.Size()));
  EXPECT_GT(WeightedRms(truth.replay), 2.0 * error);
  auto doubled = StatedNoise();
  for (double& scale : doubled) scale = 2.0;
  EXPECT_LT(TrueHeldOutError(truth, doubled), 0.6 * error);
}

/// A breath is no pure sine, and the label says nothing of its overtone.
TEST(TrueHeldOut, WhatTheLabelDoesNotNameIsFitted) {
  const hidden::HiddenRecording hidden = Hidden("port_motion", hidden::EffectSize::kStrong);
  TrueModel truth(hidden.recording, hidden);
  const double error = TrueHeldOutError(truth, StatedNoise());
  ASSERT_TRUE(truth.StandAtTruth());
  EXPECT_GT(WeightedRms(truth.replay), 1.2 * error);
}

}  // namespace
}  // namespace flextip::bench
