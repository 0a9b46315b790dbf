// Link lengths and twists differ from the arm's file: a, d and alpha of each link.
#include "arms/effects/effects.h"

namespace flextip::arms {
namespace {

class LinkGeometry : public ArmEffect {
 public:
  std::string Name() const override { return "link_geometry"; }
  std::string Summary() const override { return "link lengths and twists differ from the file"; }
  bool Applies(const ArmData& data) const override {
    return data.pose.Any() && data.arm.convention != ArmConvention::kUrdf;
  }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    const int n = data.Size();
    const auto a = ToleranceOf(data, "link_geometry.a_m", 0.0002, n);
    const auto d = ToleranceOf(data, "link_geometry.d_m", 0.0002, n);
    const auto alpha = ToleranceOf(data, "link_geometry.alpha_rad", 0.0005, n);
    std::vector<FitParameter> parameters;
    for (int i = 0; i < n; ++i) {
      parameters.push_back({a[i], 0.003});
      parameters.push_back({d[i], 0.003});
      parameters.push_back({alpha[i], 0.01});
    }
    return parameters;
  }
  void ActOnPose(const ArmData& data, const double* theta, PoseStage& stage) const override {
    for (int j = 0; j < 3 * data.Size(); ++j) stage.Add(j, PoseStage::kGeometry + j, theta[j]);
  }

  std::vector<ArmParameter> Report(const ArmData& data, const Eigen::VectorXd& theta,
                                   const Eigen::MatrixXd& covariance) const override {
    std::vector<ArmParameter> reported{{"a_m", {}, {}}, {"d_m", {}, {}}, {"alpha_rad", {}, {}}};
    for (int j = 0; j < 3 * data.Size(); ++j) {
      reported[j % 3].value.push_back(theta[j]);
      reported[j % 3].sd.push_back(std::sqrt(std::max(0.0, covariance(j, j))));
    }
    return reported;
  }
  Eigen::VectorXd FromReported(const ArmData& data,
                               const std::vector<ArmParameter>& reported) const override {
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(3 * data.Size());
    int kind = 0;
    for (const char* name : {"a_m", "d_m", "alpha_rad"}) {
      const std::vector<double> values = ListOf(Name(), reported, name, data.Size());
      for (int i = 0; i < data.Size(); ++i) theta[3 * i + kind] = values[i];
      ++kind;
    }
    return theta;
  }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeLinkGeometry() { return std::make_unique<LinkGeometry>(); }

}  // namespace flextip::arms
