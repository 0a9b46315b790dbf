// A cycle at an arm's joints: desired joints in, the command that brings the true ones there out.
#include <fmt/format.h>

#include <cmath>

#include <flextip/control/joints/joint_feed_forward.h>

using namespace flextip;

namespace {

/// Two joints that swing, with their rates.
JointWish WishAt(double t_s) {
  const Eigen::Vector2d size(0.3, 0.2), speed(2.0, 1.3);
  JointWish wish;
  wish.q = size.array() * (speed * t_s).array().sin();
  wish.v = size.array() * speed.array() * (speed * t_s).array().cos();
  wish.a = -size.array() * speed.array().square() * (speed * t_s).array().sin();
  return wish;
}

}  // namespace

int main() {
  // What flextip diagnose found of the arm; arms/feed_forward/joint_model.h reads its model.yaml.
  JointModel arm(2);
  arm.delay_s = 0.02;                      // commands arrive late
  arm.lag_s = Eigen::Vector2d(0.04, 0.0);  // the first servo lags
  arm.offset = Eigen::Vector2d(0.0, 0.01);
  arm.play(1, 1) = 0.03;  // the second joint's cable has play
  JointFeedForward feed_forward(arm, {}, WishAt(0.0).q);

  JointCommand command;
  int limited = 0;
  for (int k = 0; k < 1000; ++k) {
    const double t_s = 0.002 * k + feed_forward.Lead_s();
    JointWish wish = WishAt(t_s);
    wish.v_ahead.resize(2);  // where each joint turns is known ahead
    for (int j = 0; j < 2; ++j) wish.v_ahead[j] = WishAt(t_s + feed_forward.TurnAhead_s()[j]).v[j];
    command = feed_forward.Step(wish, 0.002);
    limited += command.rate_limited;
  }
  const Eigen::Vector2d off_mrad = 1e3 * (command.q - WishAt(2.0).q);
  fmt::print("command {:+.1f} and {:+.1f} mrad off the wish, {}; {} of 1000 limited\n", off_mrad[0],
             off_mrad[1], Name(command.status), limited);
}
