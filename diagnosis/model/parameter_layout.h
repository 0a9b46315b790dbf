// All parameters of all effects in one vector.
#pragma once

#include <vector>

#include "diagnosis/evidence/priors.h"
#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {

/// The effects of a catalogue, then the registration where it is uncertain, and the place of their
/// parameters in the vector theta.
class ParameterLayout : public Priors {
 public:
  ParameterLayout(const SampleSet& samples, Catalogue catalogue);

  struct Block {
    const Effect* effect = nullptr;
    int first = 0, size = 0;
    bool nuisance = false;
  };
  const std::vector<Block>& Blocks() const { return blocks_; }
  /// The blocks that may be an answer: the first so many.
  int EffectCount() const { return effect_count_; }
  int Find(const std::string& effect) const;  ///< its block, or -1
  /// The blocks with a parameter to scan.
  const std::vector<int>& ScannedBlocks() const { return scanned_; }
  Effect& MutableEffect(int block) { return *catalogue_[block]; }

 private:
  Catalogue catalogue_;
  int effect_count_ = 0;
  std::vector<Block> blocks_;
  std::vector<int> scanned_;
};

}  // namespace flextip::diagnosis
