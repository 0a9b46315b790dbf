// What residuals are held against must not have their own noise in it.
#include "diagnosis/evidence/generic_basis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/model/catalogue.h"
#include "diagnosis/samples/sample_set.h"
#include "testdata/hidden/recording.h"

namespace flextip::diagnosis {
namespace {

double Correlation(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd x = a.array() - a.mean(), y = b.array() - b.mean();
  return x.dot(y) / (x.norm() * y.norm());
}

// A hung mass pulls the same all the time: what is found of it from sample to sample is noise.
TEST(Regressors, AnUnknownForcesNoiseIsNotInThem) {
  hidden::HiddenOptions options{.exact = true};
  options.with_load = false;
  options.scene = {
      .motion = hidden::MotionKind::kSines, .load = hidden::LoadKind::kHungMass, .duration_s = 8.0};
  const SampleSet samples = MakeSampleSet(hidden::MakeHidden(options, 71).recording, "small");
  const ParameterLayout layout(samples, MakeCatalogue(samples));
  Replay replay(samples, layout);
  ASSERT_TRUE(replay.Evaluate(Eigen::VectorXd::Zero(layout.Size())));
  const auto load = [&](Eigen::Index at) { return replay.Samples()[at].f_tip_N.norm(); };
  constexpr Eigen::Index kFar = 5;
  Eigen::VectorXd noise(Eigen::Index(samples.samples.size()) - 2 * kFar);
  for (Eigen::Index k = 0; k < noise.size(); ++k)
    noise[k] = load(k + kFar) - 0.5 * (load(k) + load(k + 2 * kFar));
  const auto regressors = Regressors(replay);
  const auto of_load = std::ranges::find(regressors, "load", &Regressor::name);
  ASSERT_NE(of_load, regressors.end());
  EXPECT_LT(std::abs(Correlation(of_load->value.segment(kFar, noise.size()), noise)), 0.2);
}

}  // namespace
}  // namespace flextip::diagnosis
