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
};

class HealthyRecording : public testing::TestWithParam<Draw> {};

TEST_P(HealthyRecording, ItsModelKeepsTheTip) {
  hidden::HiddenOptions options;
  options.exact = getenv("INEXACT") == nullptr;
  options.scene.duration_s = 12.0;
  options.with_load = GetParam().with_load;
  if (GetParam().vision_alone) options.left_out = {"em0", "strain0"};
  const hidden::HiddenRecording hidden = hidden::MakeHidden(options, GetParam().seed);
  const Recording& recording = hidden.recording;
  const diagnosis::DiagnosisResult result = diagnosis::Diagnose(recording, "healthy");
  ASSERT_EQ(result.verdict, diagnosis::Verdict{"none"});
  const diagnosis::ExtendedModel found = diagnosis::FromResult(result);
  diagnosis::ExtendedInstrument model(found, recording);
  EstimatorOptions estimator =
      EstimatorOptionsFor(recording.instrument, recording.p_RP, recording.gravity_m_s2);
  estimator.estimate_tissue = false;
  InstrumentEstimator without(estimator), with(estimator);
  const TipQuality before = QualityOf(EstimateRecording(recording, without), hidden.truth);
  const Recording timed = diagnosis::WithoutLatency(recording, found);
  const TipQuality after = QualityOf(EstimateRecording(timed, with, &model), hidden.truth);
  if (getenv("SHOW"))
    printf("QUALITY %d %d %d exact %d base %.4f mm %.2f with %.4f mm %.2f\n", int(GetParam().seed),
           GetParam().with_load, GetParam().vision_alone, options.exact, 1e3 * before.rms_m,
           before.nees, 1e3 * after.rms_m, after.nees);
  EXPECT_LT(after.rms_m, 1.1 * before.rms_m);
  EXPECT_LT(after.nees, 1.25 * before.nees);
}

INSTANTIATE_TEST_SUITE_P(, HealthyRecording,
                         testing::Values(Draw{31, false, false}, Draw{32, true, false},
                                         Draw{33, false, true}, Draw{34, true, true},
                                         Draw{35, false, true}, Draw{36, true, true}));

}  // namespace
}  // namespace flextip
