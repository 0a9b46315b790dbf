// Cables of one joint pull another: true = measured + matrix * measured. What they pull pulls back:
// the motors' efforts are those of the joints plus matrix^T times them.
#include "arms/data/effort_slopes.h"
#include "arms/effects/effects.h"

namespace flextip::arms {
namespace {

class JointCoupling : public PlainEffect {
 public:
  std::string Name() const override { return "joint_coupling"; }
  std::string Summary() const override { return "cables of one joint pull another"; }
  bool Applies(const ArmData& data) const override {
    return data.Size() > 1 && (data.seen.Any() || data.pose.Any());
  }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    const int n = data.Size(), count = n * n - n;
    const auto tolerance = ToleranceOf(data, "joint_coupling.matrix", 0.001, count);
    std::vector<FitParameter> parameters;
    for (int m = 0; m < count; ++m) {
      const Entry entry = OffDiagonal(n, m);
      const double ratio = UnitRatio(data, entry.row, entry.column);
      parameters.push_back({tolerance[m] * ratio, 0.05 * ratio});
    }
    return parameters;
  }
  bool IsLikeSprings() const override { return true; }
  void ActOnJoints(const ArmData& data, const double* theta, JointStage& stage) const override {
    const int n = data.Size();
    for (int m = 0; m < n * n - n; ++m) {
      const Entry entry = OffDiagonal(n, m);
      stage.Linear(m, entry.row, theta[m], stage.input.values.col(entry.column));
    }
  }
  void ActOnEffort(const ArmData& data, EffortStage& stage) const override {
    if (data.arm.links.empty()) return;
    const Eigen::MatrixXd effort = StatedEffort(data);
    const int n = data.Size();
    for (int m = 0; m < n * n - n; ++m) {
      const Entry entry = OffDiagonal(n, m);
      if (entry.row >= effort.cols() || entry.column >= effort.cols()) continue;
      Eigen::MatrixXd shape = Eigen::MatrixXd::Zero(effort.rows(), effort.cols());
      shape.col(entry.column) = effort.col(entry.row);
      stage.Add(m, std::move(shape));
    }
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override {
    return {{"matrix", data.Size() * data.Size() - data.Size()}};
  }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeJointCoupling() { return std::make_unique<JointCoupling>(); }

}  // namespace flextip::arms
