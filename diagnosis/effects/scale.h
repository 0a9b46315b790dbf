// An effect by one factor, fitted as its logarithm and reported as `scale`.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/model/effect.h"

namespace flextip::diagnosis {

class ScaleEffect : public Effect {
 public:
  std::string Name() const override { return name_; }
  std::string Summary() const override { return summary_; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override;
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override;
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override;

 protected:
  /// `tolerance` and `typical` are of the factor less one.
  ScaleEffect(const char* name, const char* summary, double tolerance, double typical)
      : name_(name), summary_(summary), tolerance_(tolerance), typical_(typical) {}

 private:
  const char *name_, *summary_;
  double tolerance_, typical_;
};

}  // namespace flextip::diagnosis
