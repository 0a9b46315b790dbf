#include "arms/effects/play.h"

#include <algorithm>

namespace flextip::arms {

Eigen::VectorXd PlayState(const Eigen::VectorXd& x, double width) {
  Eigen::VectorXd state = Eigen::VectorXd::Zero(x.size());
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

Eigen::MatrixXd CarriedStates(const Eigen::MatrixXd& x, const Eigen::VectorXd& widths,
                              const Eigen::MatrixXd& carried) {
  constexpr int kParts = 4;
  const Eigen::Index n = x.cols();
  Eigen::MatrixXd states = Eigen::MatrixXd::Zero(x.rows(), n);
  Eigen::VectorXd state = Eigen::VectorXd::Zero(n), leader = x.row(0).transpose();
  for (Eigen::Index k = 1; k < x.rows(); ++k) {
    for (int part = 1; part <= kParts; ++part) {
      const double u = double(part) / kParts;
      for (Eigen::Index i = n; i-- > 0;) {
        const double at = (1.0 - u) * x(k - 1, i) + u * x(k, i) + carried.row(i).dot(state);
        const double step = at - leader[i];
        leader[i] = at;
        if (step == 0.0) continue;
        state[i] = widths[i] > 0.0 ? std::clamp(state[i] - step / widths[i], -0.5, 0.5)
                   : step > 0.0    ? -0.5
                                   : 0.5;
      }
    }
    states.row(k) = state.transpose();
  }
  return states;
}

}  // namespace flextip::arms
