// Errors of base and extended model on stretches of time that neither was fitted to.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "arms/diagnose/diagnose.h"
#include "arms/search/search.h"

namespace flextip::arms {

/// Residuals of all channels with one model.
using Residuals = std::vector<Eigen::MatrixXd>;

/// Sums of squares of one model in one stretch.
struct ErrorSums {
  std::map<std::string, std::pair<double, double>> by_name;  ///< squares and count
  double weighted = 0.0, count = 0.0;
  double tip = 0.0, tip_count = 0.0, tip_sum = 0.0;
  void Add(const ErrorSums& other);
  double Rms(const std::string& name) const;
  double Weighted() const { return count > 0.0 ? std::sqrt(weighted / count) : 0.0; }
  double Tip() const { return tip_count > 0.0 ? std::sqrt(tip / tip_count) : 0.0; }
  double TipMean() const { return tip_count > 0.0 ? tip_sum / tip_count : 0.0; }
};

/// Adds rows `from` to `to` of channel `i`: each component under CHANNEL_COMPONENT, and all of a
/// unit together under CHANNEL_UNIT (of a position or orientation the whole vector). The tip is
/// that of the arm's file, or the tracked marker.
void AddErrors(const Replay& replay, std::size_t i, const ChannelNoise& noise,
               const Eigen::MatrixXd& residual, Eigen::Index from, Eigen::Index to,
               ErrorSums& sums);

struct ArmHeldOut {
  ErrorSums base, extended;
  std::vector<ErrorSums> base_recordings, extended_recordings;
  double low = 1.0, high = 1.0;  ///< 90 % interval of the weighted ratio
};

/// `base` is evaluated at the base, `extended` at the best place.
ArmHeldOut MeasureHeldOut(const Replay& base, const Replay& extended, const Found& found,
                          const Problem& base_problem, int parts, int folds = 4);

/// Where nuisances alone are fitted to `sums`.
Eigen::VectorXd NuisancesOf(const diagnosis::NormalSums& sums, const Layout& layout);

}  // namespace flextip::arms
