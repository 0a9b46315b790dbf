#include "exchange/bags/camera_info.h"

#include <fmt/format.h>

#include "core/error.h"
#include "recording/cameras/format_parts.h"

namespace flextip::exchange {

std::optional<CameraDescription> CameraOf(const CameraInfoMessage& info, const std::string& topic,
                                          const std::string& picture_topic) {
  if (info.K[0] == 0.0) return {};
  const auto refuse = [&](const std::string& what) {
    throw InputError(fmt::format("{}: {}", topic, what));
  };
  CameraDescription camera;
  CameraCalibration& c = camera.calibration;
  c.width_px = info.width_px;
  c.height_px = info.height_px;
  if (info.binning_x > 1 || info.binning_y > 1 || info.crops) {
    refuse("the pictures are binned or cut out, expected whole ones");
  }
  const auto check = [&] {
    if (const auto problem = ProblemOf(c); !problem.empty()) refuse(problem);
    return camera;
  };
  if (picture_topic.find("rect") != std::string::npos) {
    c.fu_px = info.P[0], c.cu_px = info.P[2], c.fv_px = info.P[5], c.cv_px = info.P[6];
    return check();
  }
  if (const auto problem = TakeIntrinsics(info.K, c); !problem.empty()) refuse("K: " + problem);
  const RosLens lens = RosLensOf(info.distortion_model, info.D);
  if (!lens.problem.empty()) refuse(fmt::format("{}: {}", lens.wrong_key, lens.problem));
  c.distortion = lens.distortion;
  c.distortion_coefficients = lens.coefficients;
  return check();
}

}  // namespace flextip::exchange
