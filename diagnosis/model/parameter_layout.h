// All parameters of all effects in one vector.
#pragma once

#include <vector>

#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {

/// The effects of a catalogue, then the registration where it is uncertain, and the place of their
/// parameters in the vector theta.
class ParameterLayout {
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
  int Size() const { return int(parameters_.size()); }
  const FitParameter& Parameter(int j) const { return parameters_[j]; }
  /// Standard deviations while no effect is present.
  const Eigen::VectorXd& Tolerances() const { return tolerances_; }
  /// Returns standard deviations with the blocks of `present` widened, each by its own `scale`.
  Eigen::VectorXd Widened(const std::vector<int>& present, const std::vector<double>& scales) const;
  int Find(const std::string& effect) const;  ///< its block, or -1
  /// The blocks with a parameter to scan.
  const std::vector<int>& ScannedBlocks() const { return scanned_; }
  Effect& MutableEffect(int block) { return *catalogue_[block]; }

 private:
  Catalogue catalogue_;
  int effect_count_ = 0;
  std::vector<Block> blocks_;
  std::vector<int> scanned_;
  std::vector<FitParameter> parameters_;
  Eigen::VectorXd tolerances_;
};

}  // namespace flextip::diagnosis
