// How much more probable the samples since a moment are with a cause that set in then, than within
// tolerance.
#pragma once

#include <array>
#include <optional>

#include "core/linear_algebra.h"
#include "diagnosis/running/information.h"
#include "diagnosis/running/watched_parameters.h"

namespace flextip::diagnosis::running {

/// One cause that set in at one moment.
struct OnsetEvidence {
  double log_ratio = 0.0;        ///< of the probabilities, natural logarithm
  double value = 0.0, sd = 0.0;  ///< of what is told, in SI units
  /// Of all that set in, in tolerances, less two standard deviations.
  double beyond = 0.0;
  double farthest = 0.0;  ///< of a parameter, in typical sizes
};

/// What grows from a moment on in proportion to time, as sums over blocks: w the blocks since then.
struct Growth {
  static constexpr int kCount = 3;
  Eigen::Matrix<double, kParameters, kCount> cross =
      Eigen::Matrix<double, kParameters, kCount>::Zero();  ///< sum of w H
  Eigen::Matrix3d own = Eigen::Matrix3d::Zero();           ///< sum of w^2 H
  Eigen::Vector3d g = Eigen::Vector3d::Zero();             ///< sum of w g

  /// Takes `block`, older than those before, whose sums are `since`. `first` is the column.
  void TakeOlder(const Information& since, const Information& block, int first);
};

/// All samples, for comparison with any part of them. Parameters within tolerance are the same
/// before and after the moment.
class AllSamples {
 public:
  /// Takes the sums of all samples.
  void Take(const Information& all);

  /// Takes the sums since a moment.
  void Since(const Information& part);
  /// Returns the evidence of the cause `block`, whose first parameters set in at that moment. Its
  /// size is as likely 0.3, 1 and 3 times the typical one.
  OnsetEvidence Of(const WatchedBlock& block, const WatchedParameters& parameters) const;
  /// The same of a drift (per block) that began then.
  OnsetEvidence Of(const WatchedBlock& block, const WatchedParameters& parameters,
                   const Growth& growth) const;
  /// Returns the logarithm of the ratio for all causes at once that set in at that moment.
  double OfAll(const WatchedParameters& parameters) const;

 private:
  Llt<kParameters> factor_;
  Information::Vector whitened_g_;
  Information::Matrix whitened_part_;
  Information part_;
};

/// Returns log(exp(a) + exp(b)).
double AddLogarithms(double a, double b);

}  // namespace flextip::diagnosis::running
