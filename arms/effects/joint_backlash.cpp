// Play between encoder and joint, with memory of direction, that drags other joints with it. Where
// in its play joint j stands is s_j in -1/2 .. 1/2 (play.h), replayed through a window:
//   true_i = measured_i + sum over j of moved_ij s_j,
// width_j = moved_jj, drag_ij = moved_ij / moved_jj. Without play all is zero whatever the window.
// What is dragged may pass through the play of the joint that it drags (CarriedStates), as where
// one cable pulls on another joint's. Then moved_ij says when joint i moves, too, and what gives
// way to friction gives way to a spring that pulls a joint back (play_spring.cpp).
#include <algorithm>

#include "arms/effects/effects.h"
#include "arms/effects/play.h"

namespace flextip::arms {
namespace {

constexpr double kLost = 0.05;  // of a window
constexpr double kGuess = 0.5;  // of a drag
constexpr double kShows = 6.0;  // tolerances
constexpr double kStep = 1e-4;  // of a state, or in rad

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
    const Eigen::MatrixXd& x = stage.input.values;
    const Eigen::MatrixXd moved = Moved(data, theta);
    Eigen::VectorXd start = Eigen::VectorXd::Zero(x.cols());
    for (int j = 0; j < data.Size() && stage.play_start.size() > 0; ++j)
      if (Begins(data, moved, j)) start[j] = stage.play_start[j];
    const PlayHistory history = HistoryAt(data, moved);
    const Eigen::MatrixXd drawn = Drawn(x, history, stage.pull_back);
    const Eigen::MatrixXd states = States(drawn, history, start);
    const int n = data.Size();
    for (int j = 0; j < n; ++j) {
      const Eigen::VectorXd state = states.col(j);
      if (state.isZero(0.0)) continue;
      for (int i = 0; i < n; ++i) stage.Linear(IndexOf(n, i, j), i, moved(i, j), state);
    }
    stage.output += drawn - x;
    if (!stage.WantsDerivatives()) return;
    if (stage.play_start.size() > 0) DeriveByStart(data, drawn, history, start, moved, stage);
    if (history.by_parameters) DeriveByHistory(data, x, start, moved, stage);
    if (stage.pull_back.size() > 0) DeriveByPull(x, history, start, moved, stage);
  }

  PlayHistory History() const override { return history_; }
  void SetHistory(const PlayHistory& history) override { history_ = history; }
  std::vector<int> OfWindow(const ArmData& data, int joint) const override {
    const int n = data.Size();
    std::vector<int> own{joint};
    for (int m = 0; m < n * n - n; ++m)
      if (OffDiagonal(n, m).column == joint) own.push_back(n + m);
    return own;
  }

  PlayHistory Carrying(const ArmData& data, Eigen::VectorXd& theta) const override {
    const int n = data.Size();
    const Eigen::MatrixXd moved = Moved(data, theta.data());
    PlayHistory history = history_;
    if (history.windows.size() != n) history.windows = Eigen::VectorXd::Zero(n);
    history.carried.setZero(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        if (i == j || !Drags(data, moved(i, j), i, history.windows[i])) continue;
        history.carried(i, j) = moved(i, j);
        // A joint that nobody commands shows its own play where it is dragged: a guess to begin at.
        if (theta[i] <= 0.0) theta[i] = kGuess * std::abs(moved(i, j));
      }
    return history;
  }

  std::vector<ArmParameter> Report(const ArmData& data, const Eigen::VectorXd& theta,
                                   const Eigen::MatrixXd& covariance) const override {
    const int n = data.Size();
    ArmParameter width{"width", {}, {}}, drag{"drag", {}, {}}, window{"window", {}, {}};
    const auto sd = [&](int j) { return std::sqrt(std::max(0.0, covariance(j, j))); };
    const PlayHistory history = HistoryAt(data, Moved(data, theta.data()));
    for (int j = 0; j < n; ++j) {
      width.value.push_back(theta[j]);
      width.sd.push_back(sd(j));
      window.value.push_back(history.windows.size() == n ? history.windows[j] : theta[j]);
      window.sd.push_back(0.0);
    }
    for (int m = 0; m < n * n - n; ++m) {
      const double by = Divisor(data, theta, OffDiagonal(n, m).column);
      drag.value.push_back(theta[n + m] / by);
      drag.sd.push_back(sd(n + m) / by);
    }
    if (history.carried.size() == 0) return {width, drag, window};
    ArmParameter carried{"carried", {}, std::vector<double>(std::size_t(n * n), 0.0)};
    for (int m = 0; m < n * n; ++m) carried.value.push_back(history.carried(m / n, m % n));
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
    // What the history is made of: they may be absent.
    for (const ArmParameter& p : reported) {
      if (p.name == "window") ListOf(Name(), reported, p.name, n);
      if (p.name == "carried") ListOf(Name(), reported, p.name, n * n);
    }
    return theta;
  }

 private:
  static int IndexOf(int n, int row, int column) {
    return row == column ? row : n + row * (n - 1) + column - (column > row ? 1 : 0);
  }

  /// How far joint i moves while joint j crosses its play.
  static Eigen::MatrixXd Moved(const ArmData& data, const double* theta) {
    const int n = data.Size();
    Eigen::MatrixXd moved(n, n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) moved(i, j) = theta[IndexOf(n, i, j)];
    return moved;
  }

  /// Whether it counts where the play begins. Within tolerance it is in the middle: anywhere else
  /// it would be one more offset.
  static bool Begins(const ArmData& data, const Eigen::MatrixXd& moved, int j) {
    return std::abs(moved(j, j)) > kShows * data.TypicalOf(j, 0.0005, 0.0002);
  }

  /// A drag that is lost in the play of what it drags carries nothing.
  static bool Drags(const ArmData& data, double moved, int i, double window) {
    return std::abs(moved) > kLost * window &&
           std::abs(moved) > kShows * data.TypicalOf(i, 0.0005, 0.0002);
  }

  /// The history with what it takes from the parameters.
  PlayHistory HistoryAt(const ArmData& data, const Eigen::MatrixXd& moved) const {
    PlayHistory history = history_;
    if (!history.by_parameters) return history;
    for (int i = 0; i < data.Size(); ++i) {
      if (IsTied(history_.carried, i))
        history.windows[i] = std::max(moved(i, i), data.TypicalOf(i, 0.0005, 0.0002));
      for (int j = 0; j < data.Size(); ++j)
        if (history_.carried(i, j) != 0.0) history.carried(i, j) = moved(i, j);
    }
    return history;
  }

  /// Where joints would stand without friction: what their plays are about.
  static Eigen::MatrixXd Drawn(const Eigen::MatrixXd& x, const PlayHistory& history,
                               const Eigen::VectorXd& pull_back) {
    if (history.carried.size() == 0 || pull_back.size() == 0) return x;
    return x - x * DrawnBack(history, pull_back).transpose();
  }

  static Eigen::MatrixXd States(const Eigen::MatrixXd& x, const PlayHistory& history,
                                const Eigen::VectorXd& start) {
    const Eigen::Index n = x.cols();
    if (history.carried.size() > 0)
      return CarriedStates(x, history.windows, history.carried, start);
    Eigen::MatrixXd states(x.rows(), n);
    for (Eigen::Index j = 0; j < n; ++j)
      states.col(j) =
          PlayState(x.col(j), history.windows.size() == n ? history.windows[j] : 0.0, start[j]);
    return states;
  }

  static Eigen::MatrixXd Followed(const Eigen::MatrixXd& x, const PlayHistory& history,
                                  const Eigen::VectorXd& pull_back, const Eigen::VectorXd& start,
                                  const Eigen::MatrixXd& moved) {
    const Eigen::MatrixXd drawn = Drawn(x, history, pull_back);
    return drawn + States(drawn, history, start) * moved.transpose();
  }

  static void DeriveByStart(const ArmData& data, const Eigen::MatrixXd& x,
                            const PlayHistory& history, const Eigen::VectorXd& start,
                            const Eigen::MatrixXd& moved, JointStage& stage) {
    for (Eigen::Index j = 0; j < x.cols(); ++j) {
      if (!Begins(data, moved, int(j)) || std::abs(start[j]) >= 0.5) continue;
      Eigen::VectorXd up = start, down = start;
      up[j] += kStep;
      down[j] -= kStep;
      const Eigen::MatrixXd by =
          (States(x, history, up) - States(x, history, down)) / (2.0 * kStep) * moved.transpose();
      for (Eigen::Index i = 0; i < x.cols(); ++i)
        stage.DerivativeOfAny(stage.first_play_start + int(j), int(i), by.col(i));
    }
  }

  static void DeriveByPull(const Eigen::MatrixXd& x, const PlayHistory& history,
                           const Eigen::VectorXd& start, const Eigen::MatrixXd& moved,
                           JointStage& stage) {
    if (history.carried.size() == 0) return;
    for (Eigen::Index j = 0; j < x.cols(); ++j) {
      if (!IsTied(history.carried, j)) continue;
      Eigen::VectorXd up = stage.pull_back, down = stage.pull_back;
      up[j] += kStep;
      down[j] -= kStep;
      const Eigen::MatrixXd by =
          (Followed(x, history, up, start, moved) - Followed(x, history, down, start, moved)) /
          (2.0 * kStep);
      for (Eigen::Index i = 0; i < x.cols(); ++i)
        stage.DerivativeOfAny(stage.first_pull_back + int(j), int(i), by.col(i));
    }
  }

  /// What tied parameters change by changing when a joint moves, and what springs draw it by.
  void DeriveByHistory(const ArmData& data, const Eigen::MatrixXd& x, const Eigen::VectorXd& start,
                       const Eigen::MatrixXd& moved, JointStage& stage) const {
    const int n = data.Size();
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        if (i == j ? !IsTied(history_.carried, i) : history_.carried(i, j) == 0.0) continue;
        const double h = kStep * data.TypicalOf(i, 1.0, 0.1);
        Eigen::MatrixXd up = moved, down = moved;
        up(i, j) += h;
        down(i, j) -= h;
        const auto at = [&](const Eigen::MatrixXd& there) {
          return Followed(x, HistoryAt(data, there), stage.pull_back, start, moved);
        };
        const Eigen::MatrixXd by = (at(up) - at(down)) / (2.0 * h);
        for (int row = 0; row < n; ++row) stage.Derivative(IndexOf(n, i, j), row, by.col(row));
      }
  }

  /// A width to divide by: joints without play of their own keep a sliver.
  static double Divisor(const ArmData& data, const Eigen::VectorXd& theta, int j) {
    return std::max(std::abs(theta[j]), data.TypicalOf(j, 0.0005, 0.0002));
  }

  PlayHistory history_;
};

}  // namespace

PlayHistory PlayHistoryOf(const std::vector<ArmParameter>& backlash, int joints) {
  const auto list = [&](const char* name, int size) {
    return ListOf("joint_backlash", backlash, name, size);
  };
  const auto has = [&](const char* name) {
    return std::any_of(backlash.begin(), backlash.end(),
                       [&](const ArmParameter& p) { return p.name == name; });
  };
  const std::vector<double> windows = list(has("window") ? "window" : "width", joints);
  PlayHistory history{Eigen::Map<const Eigen::VectorXd>(windows.data(), joints), {}};
  if (has("carried")) {
    const std::vector<double> carried = list("carried", joints * joints);
    history.carried = Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(
        carried.data(), joints, joints);
  }
  return history;
}

std::unique_ptr<ArmEffect> MakeJointBacklash() { return std::make_unique<JointBacklash>(); }

}  // namespace flextip::arms
