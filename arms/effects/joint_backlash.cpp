// Play between encoder and joint, with memory of direction, that drags other joints with it. Where
// in its play joint j stands is s_j in -1/2 .. 1/2 (play.h), replayed through a window:
//   true_i = measured_i + sum over j of moved_ij s_j,
// width_j = moved_jj, drag_ij = moved_ij / moved_jj. Without play all is zero whatever the window.
// What is dragged may pass through the play of the joint that it drags (CarriedStates), as where
// one cable pulls on another joint's: then the settings carry how far.
#include "arms/effects/effects.h"
#include "arms/effects/play.h"

namespace flextip::arms {
namespace {

class JointBacklash : public ArmEffect {
 public:
  std::string Name() const override { return "joint_backlash"; }
  std::string Summary() const override { return "play between encoder and joint drags others too"; }
  bool Applies(const ArmData& data) const override { return data.seen.Any() || data.pose.Any(); }

  std::vector<FitParameter> Parameters(const ArmData& data) const override {
    auto parameters = PerJoint(data, "joint_backlash.width", {0.0005, 0.0002, 0.05, 0.002, true});
    const int n = data.Size();
    for (int m = 0; m < n * n - n; ++m) {
      const Entry entry = OffDiagonal(n, m);
      parameters.push_back({0.02 * data.TypicalOf(entry.row, 0.0005, 0.0002),
                            data.TypicalOf(entry.row, 0.04, 1e-3)});
    }
    return parameters;
  }

  void ActOnJoints(const ArmData& data, const double* theta, JointStage& stage) const override {
    const int n = data.Size();
    const Eigen::MatrixXd states = States(stage.input.values);
    for (int j = 0; j < n; ++j) {
      const Eigen::VectorXd state = states.col(j);
      if (state.isZero(0.0)) continue;
      stage.Linear(j, j, theta[j], state);
      for (int m = 0; m < n * n - n; ++m) {
        const Entry entry = OffDiagonal(n, m);
        if (entry.column == j) stage.Linear(n + m, entry.row, theta[n + m], state);
      }
    }
  }

  Eigen::VectorXd Windows() const override { return windows_; }
  void SetWindows(const Eigen::VectorXd& widths) override { windows_ = widths; }
  std::vector<int> OfWindow(const ArmData& data, int joint) const override {
    const int n = data.Size();
    std::vector<int> own{joint};
    for (int m = 0; m < n * n - n; ++m)
      if (OffDiagonal(n, m).column == joint) own.push_back(n + m);
    return own;
  }

  Eigen::VectorXd Carrying(const ArmData& data, const Eigen::VectorXd& theta) const override {
    const int n = data.Size();
    Eigen::VectorXd settings = Eigen::VectorXd::Zero(n + n * n);
    if (windows_.size() >= n) settings.head(n) = windows_.head(n);
    for (int m = 0; m < n * n - n; ++m) {
      const Entry entry = OffDiagonal(n, m);
      // A drag that is lost in the play of what it drags carries nothing.
      if (std::abs(theta[n + m]) > 0.05 * settings[entry.row])
        settings[n + entry.row * n + entry.column] = theta[n + m];
    }
    return settings;
  }

  std::vector<ArmParameter> Report(const ArmData& data, const Eigen::VectorXd& theta,
                                   const Eigen::MatrixXd& covariance) const override {
    const int n = data.Size();
    ArmParameter width{"width", {}, {}}, drag{"drag", {}, {}}, window{"window", {}, {}};
    const auto sd = [&](int j) { return std::sqrt(std::max(0.0, covariance(j, j))); };
    for (int j = 0; j < n; ++j) {
      width.value.push_back(theta[j]);
      width.sd.push_back(sd(j));
      window.value.push_back(windows_.size() >= n ? windows_[j] : theta[j]);
      window.sd.push_back(0.0);
    }
    for (int m = 0; m < n * n - n; ++m) {
      const double by = Divisor(data, theta, OffDiagonal(n, m).column);
      drag.value.push_back(theta[n + m] / by);
      drag.sd.push_back(sd(n + m) / by);
    }
    if (windows_.size() != n + n * n) return {width, drag, window};
    ArmParameter carried{"carried", {}, std::vector<double>(std::size_t(n * n), 0.0)};
    for (int m = 0; m < n * n; ++m) carried.value.push_back(windows_[n + m]);
    return {width, drag, window, carried};
  }

  Eigen::VectorXd FromReported(const ArmData& data,
                               const std::vector<ArmParameter>& reported) const override {
    const int n = data.Size();
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(n * n);
    const std::vector<double> width = ListOf(Name(), reported, "width", n);
    const std::vector<double> drag = ListOf(Name(), reported, "drag", n * n - n);
    theta.head(n) = Eigen::Map<const Eigen::VectorXd>(width.data(), n);
    for (int m = 0; m < n * n - n; ++m)
      theta[n + m] = drag[m] * Divisor(data, theta, OffDiagonal(n, m).column);
    // What SetWindows takes: they may be absent.
    for (const ArmParameter& p : reported) {
      if (p.name == "window") ListOf(Name(), reported, p.name, n);
      if (p.name == "carried") ListOf(Name(), reported, p.name, n * n);
    }
    return theta;
  }

 private:
  /// The settings are windows alone, or windows and what each joint carries of each, row by row.
  Eigen::MatrixXd States(const Eigen::MatrixXd& x) const {
    const Eigen::Index n = x.cols();
    if (windows_.size() == n + n * n) {
      Eigen::MatrixXd carried(n, n);
      for (Eigen::Index i = 0; i < n; ++i)
        carried.row(i) = windows_.segment(n + i * n, n).transpose();
      return CarriedStates(x, windows_.head(n), carried);
    }
    Eigen::MatrixXd states(x.rows(), n);
    for (Eigen::Index j = 0; j < n; ++j)
      states.col(j) = PlayState(x.col(j), windows_.size() == n ? windows_[j] : 0.0);
    return states;
  }

  /// A width to divide by: joints without play of their own keep a sliver.
  static double Divisor(const ArmData& data, const Eigen::VectorXd& theta, int j) {
    return std::max(std::abs(theta[j]), data.TypicalOf(j, 0.0005, 0.0002));
  }

  Eigen::VectorXd windows_;
};

}  // namespace

std::unique_ptr<ArmEffect> MakeJointBacklash() { return std::make_unique<JointBacklash>(); }

}  // namespace flextip::arms
