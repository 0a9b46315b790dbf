#include "arms/effects/play.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace flextip::arms {
namespace {

constexpr double kPartsOfAWindow = 4.0;
constexpr int kMostParts = 8;
constexpr int kMostSweeps = 60;
constexpr double kAtRest = 1e-9;  // widths

}  // namespace

Eigen::VectorXd PlayState(const Eigen::VectorXd& x, double width, double start) {
  Eigen::VectorXd state = Eigen::VectorXd::Constant(x.size(), std::clamp(start, -0.5, 0.5));
  for (Eigen::Index k = 1; k < x.size(); ++k) {
    const double step = x[k] - x[k - 1];
    if (step == 0.0) {
      state[k] = state[k - 1];
    } else if (width <= 0.0) {
      state[k] = step > 0.0 ? -0.5 : 0.5;
    } else {
      state[k] = std::clamp(state[k - 1] - step / width, -0.5, 0.5);
    }
  }
  return state;
}

bool IsTied(const Eigen::MatrixXd& carried, Eigen::Index j) {
  return !carried.row(j).isZero(0.0) || !carried.col(j).isZero(0.0);
}

namespace {

/// The states of joints that are all tied.
Eigen::MatrixXd TiedStates(const Eigen::MatrixXd& x, const Eigen::VectorXd& widths,
                           const Eigen::MatrixXd& carried, const Eigen::VectorXd& start) {
  const Eigen::Index n = x.cols();
  Eigen::MatrixXd states(x.rows(), n);
  Eigen::VectorXd state = start.cwiseMax(-0.5).cwiseMin(0.5);
  states.row(0) = state.transpose();
  Eigen::VectorXd leader = x.row(0).transpose() + carried * state;
  for (Eigen::Index k = 1; k < x.rows(); ++k) {
    // Joints that move far together are moved together.
    const Eigen::VectorXd step = (x.row(k) - x.row(k - 1)).transpose();
    double windows = 0.0;  // crossed by the fastest
    for (Eigen::Index i = 0; i < n; ++i)
      if (widths[i] > 0.0) windows = std::max(windows, std::abs(step[i]) / widths[i]);
    const int parts =
        int(std::clamp(std::ceil(kPartsOfAWindow * windows), 1.0, double(kMostParts)));
    for (int part = 1; part <= parts; ++part) {
      const Eigen::VectorXd at = x.row(k - 1).transpose() + double(part) / parts * step;
      const Eigen::VectorXd before = leader, follower = leader + widths.cwiseProduct(state);
      for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        double moved = 0.0;
        for (Eigen::Index i = n; i-- > 0;) {
          leader[i] = at[i] + carried.row(i).dot(state);
          double now = state[i];
          if (widths[i] > 0.0) {
            now = std::clamp((follower[i] - leader[i]) / widths[i], -0.5, 0.5);
          } else if (leader[i] != before[i]) {
            now = leader[i] > before[i] ? -0.5 : 0.5;
          }
          moved = std::max(moved, std::abs(now - state[i]));
          state[i] = now;
        }
        if (moved < kAtRest) break;
      }
      leader = at + carried * state;
    }
    states.row(k) = state.transpose();
  }
  return states;
}

}  // namespace

Eigen::MatrixXd CarriedStates(const Eigen::MatrixXd& x, const Eigen::VectorXd& widths,
                              const Eigen::MatrixXd& carried, const Eigen::VectorXd& start) {
  std::vector<Eigen::Index> tied;
  Eigen::MatrixXd states(x.rows(), x.cols());
  for (Eigen::Index j = 0; j < x.cols(); ++j) {
    if (IsTied(carried, j)) {
      tied.push_back(j);
    } else {
      states.col(j) = PlayState(x.col(j), widths[j], start[j]);
    }
  }
  states(Eigen::all, tied) =
      TiedStates(x(Eigen::all, tied), widths(tied), carried(tied, tied), start(tied));
  return states;
}

Eigen::MatrixXd DrawnBack(const PlayHistory& history, const Eigen::VectorXd& pull_back) {
  Eigen::MatrixXd by = history.carried;
  for (Eigen::Index j = 0; j < by.cols(); ++j)
    by(j, j) = IsTied(history.carried, j) ? history.windows[j] : 0.0;
  return by * pull_back.asDiagonal();
}

}  // namespace flextip::arms
