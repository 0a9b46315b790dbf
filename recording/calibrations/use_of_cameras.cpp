// Cameras at another place, with another lens or clock, and the tips that they saw.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rotation.h"
#include "recording/calibrations/calibration_use.h"
#include "recording/cameras/yaml.h"

namespace flextip {
namespace {

Eigen::Vector3d MeanTip(const VisionStream& vision) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double seen = 0;
  for (const auto& sample : vision.tips) {
    if (sample.value.status == TipStatus::kLost) continue;
    sum += sample.value.p_RE;
    ++seen;
  }
  return sum / std::max(seen, 1.0);
}

/// The tips by the camera at its new place; `T_NO` takes the old R-coordinates to the new ones.
void MoveTips(const Pose& T_NO, VisionStream& vision) {
  for (auto& sample : vision.tips) {
    TipObservation& tip = sample.value;
    tip.p_RE = T_NO * tip.p_RE;
    tip.covariance_m2 = (T_NO.R * tip.covariance_m2 * T_NO.R.transpose()).eval();
    if (tip.d_RE) tip.d_RE = T_NO.R * *tip.d_RE;
  }
}

}  // namespace

RegistrationNoise NoiseAt(const Eigen::MatrixXd& covariance, const Pose& T_RA,
                          const Eigen::Vector3d& centre_R) {
  if (covariance.size() == 0) return {};
  Eigen::Matrix<double, 3, 6> by_pose;
  by_pose << -Skew(centre_R - T_RA.p), Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d at_centre = by_pose * covariance * by_pose.transpose();
  return {std::sqrt(covariance.topLeftCorner<3, 3>().trace() / 3),
          std::sqrt(at_centre.trace() / 3)};
}

void StateRegistrationNoise(const Calibration& calibration, VisionStream& vision) {
  const std::string name = vision.camera + ".T_RC";
  const auto found = calibration.poses.find(name);
  if (found == calibration.poses.end()) return;
  const RegistrationNoise noise =
      NoiseAt(calibration.CovarianceOf(name), found->second, MeanTip(vision));
  vision.registration_noise_rad = noise.turn_rad;
  vision.registration_noise_m = noise.shift_m;
}

void CalibrationUse::PlaceCamera(const std::string& camera, const Pose& T_RC) {
  CameraStream& stream = Camera(camera + ".");
  if (!stream.has_T_RC && SeenBy(camera + ".")) {
    Refuse(camera + ".T_RC",
           "vision0 was seen by a camera of unknown pose; run flextip track with it");
  }
  stream.has_T_RC = true;
  Pose& T_RC_now = stream.calibration.T_RC;
  const Pose T_NO = T_RC * T_RC_now.Inverse();
  T_RC_now = T_RC;
  if (!SeenBy(camera + ".")) return;
  MoveTips(T_NO, *recording_.vision0);
  StateRegistrationNoise(found_, *recording_.vision0);
}

/// Both are fixed to each other: cam1 goes with cam0 where it is not placed itself.
void CalibrationUse::PlaceCameras(const std::string& name, const Pose& T_RC) {
  const Pose T_C0R = Camera(name).calibration.T_RC.Inverse();
  const bool knew = Camera(name).has_T_RC;
  PlaceCamera(name.substr(0, 4), T_RC);
  const bool places_cam1 = knew && recording_.cam1 && recording_.cam1->has_T_RC;
  if (name == "cam0.T_RC" && places_cam1 && !Finds("cam1.T_RC")) {
    PlaceCamera("cam1", T_RC * T_C0R * recording_.cam1->calibration.T_RC);
  }
}

/// Comes after cam0.T_RC, by the order of their names.
void CalibrationUse::PlaceSecondCamera(const Pose& T_C0C1) {
  const char* name = "cam1.T_C0C1";
  Camera(name);  // refused where the recording has none
  if (!recording_.cam0) Refuse(name, "the recording has no cam0");
  if (!recording_.cam0->has_T_RC) {
    Refuse(name, "where cam0 is in R is unknown, expected cam0.T_RC by an earlier --calibration");
  }
  if (Finds("cam1.T_RC")) Refuse(name, "the file has cam1.T_RC too, expected one of them");
  PlaceCamera("cam1", recording_.cam0->calibration.T_RC * T_C0C1);
  WarnOfTips(name);
}

void CalibrationUse::SetIntrinsics(const std::string& name) {
  CameraCalibration& camera = Camera(name).calibration;
  const auto& k = Numbers(name, 4);
  if (!(k[0] > 0 && k[1] > 0)) {
    Refuse(name, fmt::format("found focal lengths {} and {}, expected more than 0", k[0], k[1]));
  }
  camera.fu_px = k[0], camera.fv_px = k[1], camera.cu_px = k[2], camera.cv_px = k[3];
  if (SeenBy(name)) WarnOfTips(name);
}

void CalibrationUse::SetDistortion(const std::string& name) {
  CameraCalibration& camera = Camera(name).calibration;
  const auto& terms = found_.numbers.at(name);
  const std::size_t n = terms.size();
  const auto model = found_.texts.find(name.substr(0, 5) + "distortion_model");
  if (model != found_.texts.end()) {
    const NamedDistortion named = DistortionOf(model->second, n);
    if (!named.distortion) Refuse(name.substr(0, 5) + named.wrong_key, named.expected);
    camera.distortion = *named.distortion;
  } else if (n != 4 && n != 5 && n != 8 && n != 12) {
    Refuse(name, fmt::format("found {} numbers, expected 4, 5, 8 or 12", n));
  } else if (n != 4) {
    camera.distortion = Distortion::kOpenCv;
  } else if (camera.distortion == Distortion::kOpenCv) {
    camera.distortion = Distortion::kRadialTangential;  // four terms may also be a fisheye's: then
  }                                                     // the recording already says so
  camera.distortion_coefficients = terms;
  if (SeenBy(name)) WarnOfTips(name);
}

}  // namespace flextip
