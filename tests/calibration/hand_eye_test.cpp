// Hand-eye calibration of a robot that is known exactly.
#include "calibration/hand_eye.h"

#include <gmock/gmock.h>

#include "calibration/hand_eye_chain.h"
#include "core/derivative_check.h"
#include "core/error.h"
#include "tests/calibration/hand_eye_scene.h"

namespace flextip {
namespace {

using namespace hand_eye_test;  // NOLINT

Eigen::VectorXd ErrorOf(const HandEyeResult& found, const Scene& truth) {
  Eigen::VectorXd e(found.has_time_offset ? 13 : 12);
  e.head<6>() = PoseDifference(found.T_FC, truth.T_FC);
  e.segment<6>(6) = PoseDifference(found.T_KB, truth.T_KB);
  if (found.has_time_offset) e[12] = truth.time_offset_s - found.time_offset_s;
  return e;
}

TEST(HandEye, Tmp) {
  for (const Scene& s : {EyeToHand(), EyeInHand()}) {
    double nees = 0;
    const int runs = 40;
    for (int run = 0; run < runs; ++run) {
      const auto r = CalibrateHandEye(Record(s, 20, 100 + run), {.hold_out = run == 0});
      ASSERT_TRUE(r.IsUsable()) << r.message;
      const Eigen::VectorXd e = ErrorOf(r, s);
      const double n = e.dot(r.covariance.ldlt().solve(e)) / static_cast<double>(e.size());
      nees += n / runs;
      if (run == 0) {
        fmt::print("px {} mm {} ho {} {} used {} scale {} {} corner {}\n", r.rms_px, r.rms_mm,
                   r.held_out_px, r.held_out_mm, r.views_used, r.orientation_noise_scale,
                   r.position_noise_scale, r.corner_noise_px);
        for (auto& u : r.unobservable) fmt::print("{}: {}\n", u.parameter, u.reason);
        for (auto& m : r.motions) fmt::print("{}: {} {}\n", m.words, m.sd_before_m, m.sd_after_m);
        fmt::print("err mm {} deg {}\n", 1e3 * e.segment<3>(3).norm(), 57.3 * e.head<3>().norm());
      }
      if (n > 3)
        fmt::print("run {} nees {} used {} err {}\n", run, n, r.views_used, e.segment<3>(3).norm());
    }
    fmt::print("nees/dof {}\n", nees);
  }
  Scene s = EyeToHand();
  s.frame_period_s = 0.3137;
  s.board = Sweep(s, 0.25, 0.5);
  s.time_offset_s = 0.043;
  double nees = 0;
  const int runs = 40;
  for (int run = 0; run < runs; ++run) {
    const auto r = CalibrateHandEye(Record(s, 20, 100 + run), {.hold_out = run == 0});
    ASSERT_TRUE(r.IsUsable()) << r.message;
    const Eigen::VectorXd e = ErrorOf(r, s);
    const double n = e.dot(r.covariance.ldlt().solve(e)) / static_cast<double>(e.size());
    nees += n / runs;
    fmt::print("td {} +- {}  nees {} used {}\n", r.time_offset_s, std::sqrt(r.covariance(12, 12)),
               n, r.views_used);
  }
  fmt::print("nees/dof {}\n", nees);
}

}  // namespace
}  // namespace flextip
