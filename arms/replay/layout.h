// All parameters of a set of recordings in one vector: effects, in all recordings or in some, and
// nuisances.
#pragma once

#include <string>
#include <vector>

#include "arms/effects/effect.h"

namespace flextip::arms {

class Layout {
 public:
  struct Block {
    ArmEffect* effect = nullptr;
    int first = 0, size = 0;
    std::vector<bool> in;  ///< a recording each
    int first_in = 0;      ///< the first recording that has it
    bool change = false;   ///< not in the recordings before
  };

  /// `recordings` of one arm, in order of time; effects named in `without` are left out.
  Layout(const std::vector<ArmData>& recordings, const std::vector<std::string>& without);

  const std::vector<Block>& Blocks() const { return blocks_; }
  int EffectCount() const { return effect_count_; }  ///< blocks that may be an answer: the first
  int Size() const { return priors_.Size(); }
  const diagnosis::Priors& Prior() const { return priors_; }
  const std::vector<ArmData>& Recordings() const { return recordings_; }
  /// Recording by which a block's parameters are described.
  const ArmData& DataOf(const Block& block) const { return recordings_[block.first_in]; }
  /// Returns `to` with what left its bound brought back to it; what was there in `from` stays.
  Eigen::VectorXd WithinBounds(const Eigen::VectorXd& from, Eigen::VectorXd to) const;
  /// Returns `theta` with what is bounded at zero, away from its bounds.
  Eigen::VectorXd InTheMiddle(Eigen::VectorXd theta) const;
  /// Effects with a window (ArmEffect::Windows) by their block; -1: none.
  int WindowBlock() const { return window_block_; }

 private:
  void Add(ArmEffect& effect, const std::vector<bool>& in, bool change);

  const std::vector<ArmData>& recordings_;
  Effects effects_, nuisances_;
  std::vector<Block> blocks_;
  diagnosis::Priors priors_;
  int effect_count_ = 0, window_block_ = -1;
};

}  // namespace flextip::arms
