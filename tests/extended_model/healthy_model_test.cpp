// A healthy recording estimated with the model that a diagnosis of it writes: what is within
// tolerance must not make the tip worse, nor surer than it is.
#include <gtest/gtest.h>

#include <cmath>

#include "core/linear_algebra.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/model/extended_instrument.h"
#include "diagnosis/model/latency.h"
#include "pipeline/estimate_recording.h"
#include "testdata/hidden/recording.h"

namespace flextip {
namespace {

/// Error (m, RMS) and mean squared Mahalanobis distance of the tip, at the truth's own times.
struct TipQuality {
  double rms_m = 0.0, nees = 0.0;
  int samples = 0;
};

TipQuality QualityOf(const Series<ShaftEstimate>& estimates, const Series<TruthSample>& truth) {
  TipQuality quality;
  std::size_t k = 0;
  for (const auto& estimate : estimates) {
    while (k < truth.size() && truth[k].t_ns < estimate.t_ns) ++k;
    if (k == truth.size()) break;
    if (truth[k].t_ns != estimate.t_ns || estimate.value.status != EstimateStatus::kOk) continue;
    const Eigen::Vector3d miss = estimate.value.p_RE - truth[k].value.p_RE;
    quality.rms_m += miss.squaredNorm();
    quality.nees += MahalanobisSquared(miss, estimate.value.p_RE_covariance_m2);
    ++quality.samples;
  }
  EXPECT_GT(quality.samples, 100);
  quality.rms_m = std::sqrt(quality.rms_m / quality.samples);
  quality.nees /= quality.samples;
  return quality;
}

struct Draw {
  std::uint64_t seed;
  bool with_load, vision_alone;  ///< beside the wrist
  bool exact = true;             ///< nothing is off, not even within tolerance
};

/// Of a healthy recording, estimated without a model and with its own.
struct Both {
  TipQuality without, with;
};

Both Estimated(const Draw& draw) {
  hidden::HiddenOptions options;
  options.exact = draw.exact;
  options.scene.duration_s = 12.0;
  options.with_load = draw.with_load;
  if (draw.vision_alone) options.left_out = {"em0", "strain0"};
  const hidden::HiddenRecording hidden = hidden::MakeHidden(options, draw.seed);
  const Recording& recording = hidden.recording;
  const diagnosis::DiagnosisResult result = diagnosis::Diagnose(recording, "healthy");
  EXPECT_EQ(result.verdict, diagnosis::Verdict{"none"});
  const diagnosis::ExtendedModel found = diagnosis::FromResult(result);
  diagnosis::ExtendedInstrument model(found, recording);
  EstimatorOptions estimator =
      EstimatorOptionsFor(recording.instrument, recording.p_RP, recording.gravity_m_s2);
  estimator.estimate_tissue = false;
  InstrumentEstimator without(estimator), with(estimator);
  const Recording timed = diagnosis::WithoutLatency(recording, found);
  return {QualityOf(EstimateRecording(recording, without), hidden.truth),
          QualityOf(EstimateRecording(timed, with, &model), hidden.truth)};
}

TEST(HealthyRecording, ItsOwnModelKeepsTheTip) {
  double squares_without = 0.0, squares_with = 0.0;
  for (const Draw& draw : {Draw{31, false, false}, Draw{32, true, false}, Draw{33, false, true},
                           Draw{34, true, true}, Draw{35, false, true}, Draw{36, true, true}}) {
    const Both both = Estimated(draw);
    EXPECT_LT(both.with.nees, 1.25 * both.without.nees) << draw.seed;
    squares_without += both.without.rms_m * both.without.rms_m;
    squares_with += both.with.rms_m * both.with.rms_m;
  }
  // What the data say of parameters that are truly nominal is noise: it costs a little.
  EXPECT_LT(std::sqrt(squares_with / squares_without), 1.1);
}

// What is off within tolerance makes the stated deviation of the tip too small. The model knows it.
TEST(HealthyRecording, ItsOwnModelMakesTheDeviationOfTheTipHonest) {
  for (const std::uint64_t seed : {301, 302, 303}) {
    const Both both = Estimated({seed, true, false, false});
    EXPECT_GT(both.without.nees, 2.0 * 3.0) << seed;  // 3 numbers: an honest deviation gives 3
    EXPECT_GT(both.with.nees, 0.6 * 3.0) << seed;
    EXPECT_LT(both.with.nees, 1.6 * 3.0) << seed;
    EXPECT_LT(both.with.rms_m, 0.8 * both.without.rms_m) << seed;
  }
}

}  // namespace
}  // namespace flextip
