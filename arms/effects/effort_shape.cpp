// What real efforts have beyond rigid bodies, springs and plain friction, alike in all recordings:
// smooth in the joints, and friction that changes with place and speed. A nuisance of arms whose
// masses no file states; what changes from one recording to the next is none of it.
#include <cmath>

#include "arms/effects/effects.h"

namespace flextip::arms {
namespace {

constexpr double kSize_Nm = 0.05, kSize_N = 0.4;
constexpr double kStill_rad_s = 0.03, kStill_m_s = 0.003;  // the direction turns about this speed

class EffortShape : public PlainEffect {
 public:
  std::string Name() const override { return "effort_shape"; }
  std::string Summary() const override { return "what efforts have beyond rigid bodies"; }
  bool Applies(const ArmData& data) const override {
    return data.torque.Any() && data.arm.links.empty() && !data.at_stops;
  }
  bool IsAnswer() const override { return false; }
  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    std::vector<FitParameter> parameters;
    for (int i = 0; i < data.Size(); ++i)
      for (int f = 0; f < Functions(data); ++f)
        parameters.push_back({data.TypicalOf(i, kSize_Nm, kSize_N)});
    return parameters;
  }
  void ActOnEffort(const ArmData& data, EffortStage& stage) const override {
    const auto& torque = data.torque;
    const Eigen::Index rows = torque.track.Rows(), joints = torque.track.values.cols();
    const int count = Functions(data);
    for (int i = 0; i < int(joints); ++i) {
      std::vector<Eigen::MatrixXd> shapes(count, Eigen::MatrixXd::Zero(rows, joints));
      for (Eigen::Index k = 0; k < rows; ++k) {
        const Eigen::VectorXd values = Values(data, torque.where[k], i);
        for (int f = 0; f < count; ++f) shapes[f](k, i) = values[f];
      }
      for (int f = 0; f < count; ++f) stage.Add(i * count + f, std::move(shapes[f]));
    }
  }

 protected:
  std::vector<Named> Names(const ArmData& data) const override {
    return {{"coefficients", data.Size() * Functions(data)}};
  }

 private:
  static int Functions(const ArmData& data) {
    const int n = data.Size();
    return n * (n + 1) / 2 + 2 * n;
  }

  /// Products of joints, direction times joints and their squares.
  static Eigen::VectorXd Values(const ArmData& data, const Where& where, int joint) {
    const int n = data.Size();
    const Eigen::RowVectorXd q = At(data.smooth, where), v = At(data.rate, where);
    Eigen::VectorXd x(n), values(Functions(data));
    for (int i = 0; i < n; ++i) x[i] = q[i] / data.TypicalOf(i, 0.7, 0.07);
    const double direction = std::tanh(v[joint] / data.TypicalOf(joint, kStill_rad_s, kStill_m_s));
    int at = 0;
    for (int i = 0; i < n; ++i)
      for (int j = i; j < n; ++j) values[at++] = x[i] * x[j];
    for (int i = 0; i < n; ++i) {
      values[at++] = direction * x[i];
      values[at++] = direction * x[i] * x[i];
    }
    return values;
  }
};

}  // namespace

std::unique_ptr<ArmEffect> MakeEffortShape() { return std::make_unique<EffortShape>(); }

}  // namespace flextip::arms
