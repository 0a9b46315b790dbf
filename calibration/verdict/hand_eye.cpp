#include "calibration/verdict/hand_eye.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace flextip {
namespace {

constexpr double kDegrees = 180.0 / M_PI;
// What makes a calibration one to be careful with.
constexpr double kManyRejected = 0.2;  // of the views
constexpr double kMuchWorse = 1.5;     // held-out error over the one in sample
constexpr double kNoisierWrist = 2.0;  // than wrist0 states

std::string PositionSd(const Eigen::MatrixXd& C) {
  return fmt::format("{:.2f} mm", 1e3 * std::sqrt(C.bottomRightCorner(3, 3).trace()));
}
std::string TurnSd(const Eigen::MatrixXd& C) {
  return fmt::format("{:.3f}°", kDegrees * std::sqrt(C.topLeftCorner(3, 3).trace()));
}

std::string InWords(const std::string& name) {
  static const std::map<std::string, std::string> words = {{"cam0.T_RC", "camera in R"},
                                                           {"cam0.T_WC", "camera on the wrist"},
                                                           {"board.T_WB", "board on the wrist"},
                                                           {"board.T_RB", "board in R"},
                                                           {"tags0.T_WE", "collar on the wrist"}};
  const auto it = words.find(name);
  return it == words.end() ? name : it->second + ", " + name;
}

void AddValues(const HandEyeResult& r, const Calibration& found, CalibrationVerdict& verdict) {
  for (const auto& [name, pose] : found.poses) {
    const Eigen::MatrixXd C = found.CovarianceOf(name);
    verdict.Add(InWords(name), PlaceText(pose.p),
                fmt::format("{} and {}", PositionSd(C), TurnSd(C)));
  }
  if (r.has_time_offset) {
    verdict.Add("camera behind the robot", fmt::format("{:.1f} ms", -1e3 * r.time_offset_s),
                fmt::format("{:.1f} ms", 1e3 * std::sqrt(r.covariance(12, 12))));
  }
  verdict.Add("error in the picture", fmt::format("{:.2f} px", r.rms_px));
  verdict.Add("error in space", fmt::format("{:.2f} mm", r.rms_mm));
  if (std::isfinite(r.held_out_px)) {
    verdict.Add("views held out",
                fmt::format("{:.2f} px, {:.2f} mm", r.held_out_px, r.held_out_mm));
  }
  verdict.Add("corners scatter", fmt::format("{:.2f} px an axis", r.corner_noise_px));
  verdict.Add("views used", fmt::format("{} of {}", r.views_used, r.views.size()));
}

void AddReasons(const HandEyeResult& r, CalibrationVerdict& verdict) {
  const auto disagree = static_cast<std::size_t>(
      std::count_if(r.views.begin(), r.views.end(),
                    [](const HandEyeViewResult& v) { return v.seen && !v.used; }));
  verdict.MentionCount(
      disagree, static_cast<double>(r.views.size()), kManyRejected,
      Counted(disagree, "view") + " did not agree with the others, see the warnings");
  const double scale = std::max(r.orientation_noise_scale, r.position_noise_scale);
  if (scale > kNoisierWrist) {
    verdict.Beware(fmt::format(
        "the wrist scatters {:.1f} times as much as wrist0 states; the uncertainties are by what "
        "was found",
        scale));
  }
  if (r.held_out_px > kMuchWorse * r.rms_px) {
    verdict.Beware(
        fmt::format("views that were held out are {:.1f} times as far off: there are "
                    "too few of them, or they are too much alike",
                    r.held_out_px / r.rms_px));
  }
}

}  // namespace

CalibrationVerdict JudgeHandEye(const HandEyeResult& r, const Calibration& found) {
  CalibrationVerdict verdict;
  verdict.not_found = found.unobservable;
  AddReasons(r, verdict);
  if (!r.knows_camera) {
    verdict.grade = Grade::kNotFound;
    verdict.says = r.knows_board ? "Where the board is was found, but not where the camera is."
                                 : "These views do not tell where camera and board are.";
  } else {
    const Eigen::MatrixXd C = r.covariance.topLeftCorner(6, 6);
    verdict.says = fmt::format("{} The camera's place is known to {} and {}", verdict.Judged(),
                               PositionSd(C), TurnSd(C));
    verdict.says +=
        std::isfinite(r.held_out_mm)
            ? fmt::format("; a board it had not seen is predicted to {:.2f} mm.", r.held_out_mm)
            : ".";
  }
  AddValues(r, found, verdict);
  if (!r.motions.empty()) {
    const HandEyeMotion& m = r.motions.front();
    verdict.next = m.words;
    if (m.sd_before_m > 0) {
      verdict.next += fmt::format(" ({:.2f} mm would become {:.2f} mm for a point on the board)",
                                  1e3 * m.sd_before_m, 1e3 * m.sd_after_m);
    }
  }
  const bool with_collar = found.poses.contains("tags0.T_WE");  // else a board was seen
  verdict.AdviseUse(
      "the commands on what this camera records",
      with_collar
          ? "flextip track RECORDING --calibration RESULT/calibration.yaml -o RESULT-tracked"
          : "flextip track recording --calibration RESULT/calibration.yaml -o recording-tracked");
  return verdict;
}

}  // namespace flextip
