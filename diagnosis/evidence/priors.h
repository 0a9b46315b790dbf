// The priors of all parameters in one vector, effect by effect: what evidence asks of a catalogue,
// be it of a shaft or of an arm.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

namespace flextip::diagnosis {

/// One fitted parameter. Its prior is normal about zero, which is the base simulation: with
/// `tolerance` while the effect is not thought present, with `typical` (and a third and three times
/// of it) while it is.
struct FitParameter {
  double tolerance = 0.0;
  double typical = 0.0;
  bool positive = false;  ///< a negative value has no meaning
};

/// The place of one effect's parameters in the vector.
struct ParameterSpan {
  int first = 0, size = 0;
};

class Priors {
 public:
  /// Appends the parameters of one effect.
  void Append(const std::vector<FitParameter>& own) {
    spans_.push_back({Size(), int(own.size())});
    parameters_.insert(parameters_.end(), own.begin(), own.end());
    tolerances_.resize(Size());
    // A parameter said to be known exactly keeps a sliver of freedom, so that no matrix is
    // singular.
    for (int j = 0; j < Size(); ++j) {
      tolerances_[j] = std::max(parameters_[j].tolerance, 1e-6 * parameters_[j].typical);
      if (tolerances_[j] <= 0.0) tolerances_[j] = 1e-12;
    }
  }

  const ParameterSpan& Span(int effect) const { return spans_[effect]; }
  int Size() const { return int(parameters_.size()); }
  const FitParameter& Parameter(int j) const { return parameters_[j]; }
  /// Standard deviations while no effect is present.
  const Eigen::VectorXd& Tolerances() const { return tolerances_; }
  /// Returns standard deviations with the effects of `present` widened, each by its own `scale`.
  Eigen::VectorXd Widened(const std::vector<int>& present,
                          const std::vector<double>& scales) const {
    Eigen::VectorXd sd = tolerances_;
    for (std::size_t i = 0; i < present.size(); ++i) {
      const ParameterSpan& span = spans_[present[i]];
      for (int j = span.first; j < span.first + span.size; ++j)
        sd[j] = std::max(sd[j], scales[i] * parameters_[j].typical);
    }
    return sd;
  }

 private:
  std::vector<ParameterSpan> spans_;
  std::vector<FitParameter> parameters_;
  Eigen::VectorXd tolerances_;
};

}  // namespace flextip::diagnosis
