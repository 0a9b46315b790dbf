#include <algorithm>
#include <cmath>

#include "diagnosis/model/catalogue.h"

namespace flextip::diagnosis {
namespace {

/// Fitted as stiffness times rest axis, which the couple is linear in.
class PortMoment : public Effect {
 public:
  std::string Name() const override { return "port_moment"; }
  std::string Summary() const override { return "the incision resists rotation of the shaft"; }
  bool Applies(const SampleSet&) const override { return true; }
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {
    const auto tolerance = ToleranceOf(samples, Name(), "stiffness_Nm_rad", 0.005);
    return WithTypical({tolerance[0], tolerance[0], tolerance[0]}, 0.1);
  }
  void Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const override {
    for (int i = 0; i < 3; ++i) change.Linear(i, sample_input::kPortCouple + i, 1.0);
  }
  std::vector<ReportedParameter> Report(const Eigen::VectorXd& theta,
                                        const Eigen::MatrixXd& covariance) const override {
    const double k = std::max(theta.norm(), 1e-12);
    const Eigen::Vector3d axis =
        theta.norm() > k / 2 ? Eigen::Vector3d(theta / k) : Eigen::Vector3d::UnitX();
    const Eigen::Matrix3d across =
        (Eigen::Matrix3d::Identity() - axis * axis.transpose()) * covariance *
        (Eigen::Matrix3d::Identity() - axis * axis.transpose()) / (k * k);
    ReportedParameter rest{"rest_axis", {}, {}};
    for (int i = 0; i < 3; ++i) {
      rest.value.push_back(axis[i]);
      // Without a couple the axis is unknown; no component of a unit vector is off by more than 1.
      rest.sd.push_back(std::min(1.0, std::sqrt(std::max(0.0, across(i, i)))));
    }
    const double sd = std::sqrt(std::max(0.0, double(axis.transpose() * covariance * axis)));
    return {{"stiffness_Nm_rad", {k}, {sd}}, rest};
  }
  Eigen::VectorXd FromReported(const std::vector<std::vector<double>>& values) const override {
    const auto& axis = values.at(1);
    return values.at(0).at(0) * Eigen::Vector3d(axis.at(0), axis.at(1), axis.at(2));
  }
};

}  // namespace

std::unique_ptr<Effect> MakePortMoment() { return std::make_unique<PortMoment>(); }

}  // namespace flextip::diagnosis
