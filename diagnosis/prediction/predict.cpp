#include "diagnosis/prediction/predict.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "core/error.h"
#include "diagnosis/model/catalogue.h"
#include "diagnosis/prediction/error_sums.h"
#include "diagnosis/prediction/found_again.h"
#include "diagnosis/samples/noise_level.h"
#include "diagnosis/signature.h"

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kStretches = 20;

SampleSet SamplesFor(const Recording& recording, const std::string& name,
                     const ExtendedModel& model) {
  SampleSet samples = MakeSampleSet(recording, name);
  samples.centre = model.centre_m;  // what the model's EM gradient is about
  return samples;
}

/// The effects of the model in its order, those beyond tolerance first. The registration is found
/// again.
Catalogue EffectsOf(const ExtendedModel& model, const EffectMakers& own) {
  Catalogue catalogue;
  for (const auto* list : {&model.effects, &model.within_tolerance})
    for (const EffectFit& fit : *list)
      if (auto effect = MakeEffect(fit.effect, own)) catalogue.push_back(std::move(effect));
  return catalogue;
}

/// The layout refers to the samples, the replays to both.
struct Work {
  SampleSet samples;
  ParameterLayout layout;
  Replay base, extended;
  std::vector<int> present;  ///< blocks of the effects beyond tolerance

  Work(const Recording& recording, const std::string& name, const ExtendedModel& model,
       const EffectMakers& own)
      : samples(SamplesFor(recording, name, model)),
        layout(samples, EffectsOf(model, own)),
        base(samples, layout),
        extended(samples, layout) {
    for (const EffectFit& fit : model.effects)
      if (const int b = layout.Find(fit.effect); b >= 0) present.push_back(b);
  }
};

/// The model's parameters, but for what effects within tolerance have of another recording.
Eigen::VectorXd ParametersOf(const ExtendedModel& model, const ParameterLayout& layout) {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  const auto set = [&](const EffectFit& fit, bool present) {
    const int b = layout.Find(fit.effect);
    if (b < 0) return;
    const auto& block = layout.Blocks()[b];
    std::vector<std::vector<double>> values;
    for (const ReportedParameter& parameter : fit.parameters) values.push_back(parameter.value);
    theta.segment(block.first, block.size) = block.effect->FromReported(values);
    if (present) return;
    // What hangs on how a pose was found (a part of its effect) is rather as it was than zero.
    const std::vector<int> all = block.effect->OwnParameters();
    const bool is_whole = int(all.size()) == block.size;
    for (const int own : is_whole ? all : block.effect->StateParameters())
      theta[block.first + own] = 0.0;
  };
  for (const EffectFit& fit : model.effects) set(fit, true);
  for (const EffectFit& fit : model.within_tolerance) set(fit, false);
  return theta;
}

[[noreturn]] void RefuseWithout(const std::string& what, const Replay& replay,
                                const std::string& name) {
  throw WorkError(
      fmt::format("{}: {} has no equilibrium in {} of {} samples: check length, port and load",
                  name, what, replay.FailedSamples(), replay.Samples().size()));
}

/// Both replays where they predict best, with the noise that the better of them shows.
void FindBoth(Work& work, const ExtendedModel& model, const std::string& name) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(work.layout.Size());
  const Eigen::VectorXd theta = ParametersOf(model, work.layout);
  if (!FindAgain(work.base, none, {})) RefuseWithout("the nominal instrument", work.base, name);
  if (!FindAgain(work.extended, theta, work.present))
    RefuseWithout("the instrument of the model", work.extended, name);
  const bool gains = work.extended.ChiSquaredPerDof() < work.base.ChiSquaredPerDof();
  Replay& better = gains ? work.extended : work.base;
  Replay& other = gains ? work.base : work.extended;
  better.LeaveOut(FarSamples(better));
  better.SetNoiseScale(NoiseScale(better));
  better.FixNoiseModel();
  other.TakeSettings(better);
  FindAgain(work.base, work.base.Theta(), {});
  FindAgain(work.extended, work.extended.Theta(), work.present);
}

/// Effects that act on a sensor which the recording has not.
std::vector<std::string> NotShown(const Work& work) {
  std::vector<std::string> names;
  const WhitenedRows rows = work.extended.Whiten();
  for (const int b : work.present) {
    const auto& block = work.layout.Blocks()[b];
    if (rows.X.middleCols(block.first, block.size).squaredNorm() == 0.0)
      names.push_back(block.effect->Name());
  }
  return names;
}

void Compare(const Work& work, Prediction& prediction) {
  const TipRows tip(work.samples);
  PredictionErrors base(work.base, tip), extended(work.extended, tip);
  base.JudgeOnlyWith(work.extended);
  extended.JudgeOnlyWith(work.base);
  const std::size_t n = work.samples.samples.size();
  std::vector<ErrorSums> base_sums, extended_sums;
  ErrorSums b, e;
  for (std::size_t i = 0; i < kStretches; ++i) {
    base_sums.push_back(base.Sum(n * i / kStretches, n * (i + 1) / kStretches));
    extended_sums.push_back(extended.Sum(n * i / kStretches, n * (i + 1) / kStretches));
    b.Add(base_sums.back());
    e.Add(extended_sums.back());
  }
  prediction.base = b.Score();
  prediction.extended = e.Score();
  prediction.base.chi2_per_dof = work.base.ChiSquaredPerDof();
  prediction.extended.chi2_per_dof = work.extended.ChiSquaredPerDof();
  prediction.base_tip_mean_m = b.TipMean();
  prediction.extended_tip_mean_m = e.TipMean();
  Gain& gain = prediction.gain;
  gain.measured = b.Weighted() > 0.0;
  if (gain.measured) gain.heldout_error_ratio = e.Weighted() / b.Weighted();
  if (b.TipRms() > 0.0) gain.tip_error_ratio = e.TipRms() / b.TipRms();
  std::tie(gain.heldout_error_ratio_low, gain.heldout_error_ratio_high) =
      RatioInterval(base_sums, extended_sums);
}

}  // namespace

Prediction Predict(const Recording& recording, const std::string& name, const ExtendedModel& model,
                   const EffectMakers& own) {
  Prediction prediction;
  Work work(recording, name, model, own);
  FindBoth(work, model, name);
  Compare(work, prediction);
  prediction.samples = int(work.samples.samples.size());
  for (std::size_t k = 0; k < work.samples.samples.size(); ++k)
    prediction.judged += work.base.Samples()[k].ok && work.extended.Samples()[k].ok &&
                         work.samples.samples[k].present.any();
  prediction.residuals = MakeResidualTable(work.base, work.extended);
  prediction.not_shown = NotShown(work);
  prediction.warnings = work.samples.warnings;
  if (!model.discovered.empty())
    prediction.warnings.emplace_back("the model's terms without a name are left out");
  for (const std::string& effect : prediction.not_shown)
    prediction.warnings.push_back(effect + " of the model shows in no sensor of this recording");
  return prediction;
}

}  // namespace flextip::diagnosis
