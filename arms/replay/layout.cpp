#include "arms/replay/layout.h"

#include <algorithm>
#include <cmath>

#include "arms/effects/effects.h"

namespace flextip::arms {

Layout::Layout(const std::vector<ArmData>& recordings, const std::vector<std::string>& without)
    : recordings_(recordings),
      effects_(MakeEffects(recordings.front().arm)),
      nuisances_(MakeNuisances()) {
  const std::size_t count = recordings.size();
  const auto applies = [&](const ArmEffect& effect) {
    std::vector<bool> in;
    in.reserve(count);
    for (const ArmData& data : recordings) in.push_back(effect.Applies(data));
    return in;
  };
  const auto any = [](const std::vector<bool>& in) {
    return std::find(in.begin(), in.end(), true) != in.end();
  };
  for (const auto& effect : effects_) {
    if (std::find(without.begin(), without.end(), effect->Name()) != without.end()) continue;
    const std::vector<bool> in = applies(*effect);
    if (any(in) && !effect->OnlyChanges()) Add(*effect, in, false);
    // What the first recording has is what the others are held against.
    for (std::size_t r = 1; effect->MayChange() && r < count; ++r) {
      std::vector<bool> later(count, false);
      for (std::size_t other = r; other < count; ++other)
        later[other] = in[other] && (other == r || !effect->ComesAndGoes());
      if (any(later)) Add(*effect, later, true);
    }
  }
  effect_count_ = int(blocks_.size());
  for (const auto& nuisance : nuisances_) {
    const std::vector<bool> in = applies(*nuisance);
    if (!any(in)) continue;
    if (!nuisance->OwnInEach()) {
      Add(*nuisance, in, false);
      continue;
    }
    for (std::size_t r = 0; r < count; ++r) {
      std::vector<bool> alone(count, false);
      alone[r] = in[r];
      if (in[r]) Add(*nuisance, alone, false);
    }
  }
}

Eigen::VectorXd Layout::WithinBounds(const Eigen::VectorXd& from, Eigen::VectorXd to) const {
  for (const Block& block : blocks_) {
    const double bound = block.effect->Bound();
    for (int j = block.first; j < block.first + block.size; ++j)
      to[j] = std::abs(from[j]) >= bound ? from[j] : std::clamp(to[j], -bound, bound);
  }
  return to;
}

Eigen::VectorXd Layout::InTheMiddle(Eigen::VectorXd theta) const {
  for (const Block& block : blocks_)
    if (std::isfinite(block.effect->Bound())) theta.segment(block.first, block.size).setZero();
  return theta;
}

void Layout::Add(ArmEffect& effect, const std::vector<bool>& in, bool change) {
  Block block{&effect, Size(), 0, in, 0, change};
  block.first_in = int(std::find(in.begin(), in.end(), true) - in.begin());
  const auto own = effect.Parameters(recordings_[block.first_in]);
  block.size = int(own.size());
  priors_.Append(own);
  if (window_block_ < 0 && effect.IsAnswer() &&
      !effect.OfWindow(recordings_[block.first_in], 0).empty())
    window_block_ = int(blocks_.size());
  blocks_.push_back(std::move(block));
}

}  // namespace flextip::arms
