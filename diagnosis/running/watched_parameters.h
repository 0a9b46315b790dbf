// The parameters of all watched effects in one vector, and how a moment depends on them.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "diagnosis/effects/watched.h"
#include "diagnosis/running/information.h"

namespace flextip::diagnosis::running {

inline constexpr int kMostCauses = 24, kMostWidened = 6;

/// The columns of one effect.
struct WatchedBlock {
  const WatchedEffect* row = nullptr;  ///< of the table
  std::unique_ptr<Effect> effect;
  EffectMemory memory{};
  int first = 0, count = 0;  ///< columns
  int widened = 0;           ///< of the first ones, while it is thought present; 0: never
  bool positive = false;
  bool drifts = false;  ///< the columns are those of another block; they grow in proportion to time
  double least = 1.0;   ///< what is smaller is no cause, in units of the tolerance
  std::array<double, kMostWidened> typical{};  ///< in units of the tolerance
};

class WatchedParameters {
 public:
  /// `port_prior_m`: how well the port is registered, where that is worse than its tolerance.
  WatchedParameters(const SampleSet& set, double port_prior_m);

  const std::vector<WatchedBlock>& Blocks() const { return blocks_; }
  /// Returns the tolerance of a column, its unit.
  double Tolerance(int column) const { return tolerance_[column]; }

  /// Returns how the sample's inputs depend on the parameters, with the port at `s_port_m` on the
  /// shaft. Call it once a sample, in order.
  const std::vector<InputChange::Column>& ColumnsAt(const SampleSet& set, double s_port_m,
                                                    double ds_port_dfriction_m,
                                                    double port_friction);

 private:
  void AddDrift(const WatchedEffect& row);

  std::vector<WatchedBlock> blocks_;
  Information::Vector tolerance_ = Information::Vector::Ones();
  std::vector<InputChange::Column> columns_;
};

}  // namespace flextip::diagnosis::running
