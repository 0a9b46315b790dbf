#include "arms/diagnose/predict.h"

#include <algorithm>
#include <cmath>

#include "arms/diagnose/curves.h"
#include "arms/diagnose/heldout.h"
#include "arms/effects/effects.h"
#include "arms/search/nuisances.h"

namespace flextip::arms {
namespace {

using diagnosis::EffectFit;

constexpr Eigen::Index kFirstRows = 20;

const EffectFit* FindFit(const std::vector<EffectFit>& fits, const std::string& effect) {
  for (const EffectFit& fit : fits)
    if (fit.effect == effect) return &fit;
  return nullptr;
}

/// Of each channel its first twentieth alone, of 20 rows or more.
Noise FirstRows(Noise noise) {
  for (ChannelNoise& own : noise) {
    const Eigen::Index rows = own.keep.rows();
    const Eigen::Index kept = std::min(rows, std::max(kFirstRows, rows / 20));
    own.keep.bottomRows(rows - kept).setConstant(false);
  }
  return noise;
}

/// A payload's block is that of its place.
bool IsOfPlace(const Layout& layout, const Layout::Block& block, const EffectFit& fit) {
  if (fit.effect != "payload") return true;
  double own = 0.0;
  const double wanted = ListOf(fit.effect, ParametersOf(fit), "place", 1)[0];
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(block.size);
  for (const auto& p : block.effect->Report(layout.DataOf(block), zero,
                                            Eigen::MatrixXd::Zero(block.size, block.size)))
    if (p.name == "place") own = p.value[0];
  return wanted == own;
}

}  // namespace

ArmPrediction Predict(const ArmData& data, const ArmModel& model) {
  data.RequireJudged();
  const std::vector<ArmData> recordings{data};
  const Layout layout(recordings, {});
  Eigen::VectorXd base_theta = Eigen::VectorXd::Zero(layout.Size()), theta = base_theta;
  ArmPrediction prediction;
  std::vector<EffectFit> given = model.effects;
  given.insert(given.end(), model.within_tolerance.begin(), model.within_tolerance.end());
  for (const EffectFit& fit : model.effects) {
    const bool shown = std::any_of(
        layout.Blocks().begin(), layout.Blocks().end(),
        [&](const auto& block) { return block.effect->Name() == fit.effect && block.in[0]; });
    if (!shown) prediction.not_shown.push_back(fit.effect);
  }
  for (const Layout::Block& block : layout.Blocks()) {
    const bool nuisance = !block.effect->IsAnswer();
    const EffectFit* fit = FindFit(nuisance ? model.nuisances : given, block.effect->Name());
    if (fit != nullptr && IsOfPlace(layout, block, *fit)) {
      theta.segment(block.first, block.size) = block.effect->FromReported(data, ParametersOf(*fit));
      if (!nuisance && !block.effect->OfWindow(data, 0).empty())
        block.effect->SetHistory(PlayHistoryOf(ParametersOf(*fit), data.Size()));
    }
    const EffectFit* base = FindFit(model.base_nuisances, block.effect->Name());
    if (nuisance && base != nullptr)
      base_theta.segment(block.first, block.size) =
          block.effect->FromReported(data, ParametersOf(*base));
  }
  Replay replay(layout);
  const auto residuals = [&](const Eigen::VectorXd& at) {
    Eigen::VectorXd here = at;
    replay.Evaluate(here);
    replay.Register();
    replay.Evaluate(here);
    Noise noise = MeasureNoise(replay, false);
    for (ChannelNoise& own : noise) own.sd = own.floor;  // what is left here is error, not noise
    // Only what is each recording's own is found again: how it begins from its first rows.
    const Noise first = FirstRows(noise);
    for (int round = 0; round < 5; ++round) {
      const Eigen::VectorXd moved = FitOwn(replay, noise), begun = FitOwn(replay, first);
      for (const Layout::Block& block : layout.Blocks()) {
        if (block.effect->IsAnswer() || !block.effect->OwnInEach()) continue;
        here.segment(block.first, block.size) =
            (std::isfinite(block.effect->Bound()) ? begun : moved).segment(block.first, block.size);
      }
      replay.Evaluate(here);
    }
    Residuals all;
    for (const Channel& channel : replay.Channels()) all.push_back(channel.residual);
    return all;
  };
  const Residuals base = residuals(base_theta), extended = residuals(theta);
  const Noise noise = MeasureNoise(replay, false);
  ErrorSums base_sums, sums;
  for (std::size_t i = 0; i < replay.Channels().size(); ++i) {
    AddErrors(replay, i, noise[i], base[i], 0, base[i].rows(), base_sums);
    AddErrors(replay, i, noise[i], extended[i], 0, extended[i].rows(), sums);
  }
  for (const auto& [name, unused] : sums.by_name) {
    prediction.base_rms[name] = base_sums.Rms(name);
    prediction.extended_rms[name] = sums.Rms(name);
  }
  prediction.base_tip_rms_m = base_sums.Tip();
  prediction.extended_tip_rms_m = sums.Tip();
  prediction.base_tip_mean_m = base_sums.TipMean();
  prediction.extended_tip_mean_m = sums.TipMean();
  if (base_sums.Weighted() > 0.0) prediction.ratio = sums.Weighted() / base_sums.Weighted();
  if (base_sums.Tip() > 0.0) prediction.tip_ratio = sums.Tip() / base_sums.Tip();
  prediction.samples = int(data.joints.Rows());
  FillCurves(replay, base, extended, prediction.curves);
  prediction.residuals = ResidualTableOf(replay, base, extended, noise);
  return prediction;
}

}  // namespace flextip::arms
