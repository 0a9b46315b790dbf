#include "recording/calibrations/apply.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/error.h"
#include "core/rotation.h"
#include "recording/calibrations/em_field.h"
#include "recording/cameras/yaml.h"

namespace flextip {
namespace {

constexpr double kMostTilt_deg = 2.0;  // of the tip from the wrist's x axis

/// One file's work on one recording.
class Application {
 public:
  Application(const std::filesystem::path& file, const Calibration& calibration,
              Recording& recording)
      : file_(file), found_(calibration), recording_(recording) {}

  AppliedCalibration Run();

 private:
  [[noreturn]] void Refuse(const std::string& name, const std::string& what) const {
    throw InputError::At(file_.string(), 0, fmt::format("{}: {}", name, what));
  }
  template <class Stream>
  Stream& Need(std::optional<Stream>& stream, const std::string& name) const {
    if (!stream)
      Refuse(name, fmt::format("the recording has no {}", name.substr(0, name.find('.'))));
    return *stream;
  }
  const std::vector<double>& Numbers(const std::string& name, std::size_t count) const;
  double Positive(const std::string& name) const;
  bool Finds(const std::string& name) const {
    return found_.poses.contains(name) || found_.numbers.contains(name) ||
           found_.texts.contains(name);
  }

  void ApplyPose(const std::string& name, const Pose& pose);
  void ApplyNumbers(const std::string& name);
  void ApplyText(const std::string& name);
  void PlaceCamera(const std::string& camera, const Pose& T_RC);
  void PlaceCameras(const std::string& name, const Pose& T_RC);
  void PlaceSecondCamera(const Pose& T_C0C1);
  void SetIntrinsics(const std::string& name);
  void SetDistortion(const std::string& name);
  void ShiftFrames(const std::string& name);
  void MoveTip();
  void MoveTipOnCollar();
  void RegisterEm(const Pose& T_RF);
  void SetEmDistance();
  void SetGages();
  void SetStiffness(const std::string& name);
  void CorrectField();

  CameraStream& Camera(const std::string& name) const {
    return Need(name.starts_with("cam0.") ? recording_.cam0 : recording_.cam1, name);
  }
  /// Whether the recording's tips are those that this camera saw.
  bool SeenBy(const std::string& name) const {
    return recording_.vision0 && name.starts_with(recording_.vision0->camera + ".");
  }
  void WarnOfTips(const std::string& name) {
    if (!recording_.vision0) return;
    applied_.warnings.push_back(fmt::format(
        "{}: the tips of vision0 were found without it; run flextip track with it", name));
  }

  const std::filesystem::path& file_;
  const Calibration& found_;
  Recording& recording_;
  AppliedCalibration applied_;
  std::vector<std::string> field_names_;  // `em0.field` and its like
};

const std::vector<double>& Application::Numbers(const std::string& name, std::size_t count) const {
  const auto& values = found_.numbers.at(name);
  if (values.size() != count) {
    Refuse(name, fmt::format("found {} numbers, expected {}", values.size(), count));
  }
  return values;
}

double Application::Positive(const std::string& name) const {
  const double value = Numbers(name, 1)[0];
  if (!(value > 0)) Refuse(name, fmt::format("found {}, expected more than 0", value));
  return value;
}

/// How far a registered frame may be off, as a turn about `centre_R` and a shift there.
struct RegistrationNoise {
  double turn_rad = 0.0, shift_m = 0.0;
};
RegistrationNoise NoiseAt(const Eigen::MatrixXd& covariance, const Pose& T_RA,
                          const Eigen::Vector3d& centre_R) {
  if (covariance.size() == 0) return {};
  Eigen::Matrix<double, 3, 6> by_pose;
  by_pose << -Skew(centre_R - T_RA.p), Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d at_centre = by_pose * covariance * by_pose.transpose();
  return {std::sqrt(covariance.topLeftCorner<3, 3>().trace() / 3),
          std::sqrt(at_centre.trace() / 3)};
}

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

void Application::PlaceCamera(const std::string& camera, const Pose& T_RC) {
  Pose& T_RC_now = Camera(camera + ".").calibration.T_RC;
  const Pose T_NO = T_RC * T_RC_now.Inverse();
  T_RC_now = T_RC;
  if (!SeenBy(camera + ".")) return;
  MoveTips(T_NO, *recording_.vision0);
  StateRegistrationNoise(found_, *recording_.vision0);
}

/// Both are fixed to each other: cam1 goes with cam0 where it is not placed itself.
void Application::PlaceCameras(const std::string& name, const Pose& T_RC) {
  const Pose T_C0R = Camera(name).calibration.T_RC.Inverse();
  PlaceCamera(name.substr(0, 4), T_RC);
  if (name == "cam0.T_RC" && recording_.cam1 && !Finds("cam1.T_RC")) {
    PlaceCamera("cam1", T_RC * T_C0R * recording_.cam1->calibration.T_RC);
  }
}

/// Comes after cam0.T_RC, by the order of their names.
void Application::PlaceSecondCamera(const Pose& T_C0C1) {
  const char* name = "cam1.T_C0C1";
  Camera(name);  // refused where the recording has none
  if (!recording_.cam0) Refuse(name, "the recording has no cam0");
  if (Finds("cam1.T_RC")) Refuse(name, "the file has cam1.T_RC too, expected one of them");
  PlaceCamera("cam1", recording_.cam0->calibration.T_RC * T_C0C1);
  WarnOfTips(name);
}

void Application::SetIntrinsics(const std::string& name) {
  CameraCalibration& camera = Camera(name).calibration;
  const auto& k = Numbers(name, 4);
  if (!(k[0] > 0 && k[1] > 0)) {
    Refuse(name, fmt::format("found focal lengths {} and {}, expected more than 0", k[0], k[1]));
  }
  camera.fu_px = k[0], camera.fv_px = k[1], camera.cu_px = k[2], camera.cv_px = k[3];
  if (SeenBy(name)) WarnOfTips(name);
}

void Application::SetDistortion(const std::string& name) {
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

void Shift(TimeNs by_ns, auto& series) {
  for (auto& sample : series) sample.t_ns += by_ns;
}

void Application::ShiftFrames(const std::string& name) {
  const TimeNs by_ns = std::llround(1e9 * Numbers(name, 1)[0]);
  CameraStream& camera = Camera(name);
  const auto shift = [&](CameraStream& eye) {
    Shift(by_ns, eye.filenames);
    Shift(by_ns, eye.frame_numbers);
  };
  if (camera.filenames.empty() && camera.frame_numbers.empty() && !SeenBy(name)) {
    Refuse(name, "there are no frames with times of their own to be shifted");
  }
  shift(camera);
  if (name == "cam0.time_offset_s" && recording_.cam1 && !Finds("cam1.time_offset_s")) {
    shift(*recording_.cam1);  // both eyes have one clock
  }
  if (SeenBy(name)) Shift(by_ns, recording_.vision0->tips);
}

/// The shaft models have the tip on the wrist's x axis.
void Application::MoveTip() {
  const auto& p = Numbers("tip.p_WE", 3);
  const Eigen::Vector3d p_WE(p[0], p[1], p[2]);
  const double tilt_deg = 180 / std::numbers::pi * std::atan2(p_WE.tail<2>().norm(), p_WE.x());
  if (!(tilt_deg < kMostTilt_deg)) {
    Refuse("tip.p_WE",
           fmt::format("the tip lies {:.1f} deg off the wrist's x axis, along which the "
                       "shaft is expected within {} deg",
                       tilt_deg, kMostTilt_deg));
  }
  recording_.instrument.length_m = p_WE.norm();
}

void Application::MoveTipOnCollar() {
  const auto& p = Numbers("tags0.p_E", 3);
  TagCollar& collar = Need(recording_.tags0, "tags0.p_E");
  for (CollarTag& tag : collar.tags) tag.T_EG.p -= Eigen::Vector3d(p[0], p[1], p[2]);
  WarnOfTips("tags0.p_E");
}

void Application::RegisterEm(const Pose& T_RF) {
  EmStream& em = Need(recording_.em0, "em0.T_RF");
  const auto turn = [&](EmStream& stream) {
    for (auto& sample : stream.samples) {
      sample.value.p_RS = T_RF * sample.value.p_RS;
      sample.value.q_RS = (Eigen::Quaterniond(T_RF.R) * sample.value.q_RS).normalized();
    }
  };
  turn(em);
  if (recording_.em1) turn(*recording_.em1);
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const auto& sample : em.samples) {
    centre += sample.value.p_RS / static_cast<double>(em.samples.size());
  }
  const RegistrationNoise noise = NoiseAt(found_.CovarianceOf("em0.T_RF"), T_RF, centre);
  em.registration_noise_rad = noise.turn_rad;
  em.registration_noise_m = noise.shift_m;
  if (recording_.em1) recording_.em1->registration_noise_rad = noise.turn_rad;
}

void Application::SetEmDistance() {
  EmStream& em = Need(recording_.em0, "em0.distance_from_tip_m");
  const double distance_m = Numbers("em0.distance_from_tip_m", 1)[0];
  if (!(distance_m >= 0 && distance_m <= recording_.instrument.length_m)) {
    Refuse("em0.distance_from_tip_m", fmt::format("found {}, expected 0 to the shaft's length {}",
                                                  distance_m, recording_.instrument.length_m));
  }
  em.distance_from_tip_m = distance_m;
}

void Application::SetGages() {
  const char* matrix_name = "strain0.gage_matrix";
  const char* offset_name = "strain0.offset_Nm";
  for (const char* name : {matrix_name, offset_name}) {
    if (!Finds(name))
      Refuse("strain0", fmt::format("gage_matrix and offset_Nm go together, there is no {}", name));
  }
  StrainStream& strain = Need(recording_.strain0, matrix_name);
  const Eigen::Matrix4d gages = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(
      Numbers(matrix_name, 16).data());
  const Eigen::Vector4d offset(Numbers(offset_name, 4).data());
  for (auto& sample : strain.moments_Nm) sample.value = gages * (sample.value - offset);
  // Readings' noise as moments: the root mean square over the four.
  strain.moment_noise_Nm *= gages.norm() / 2;
  if (Finds("strain0.moment_noise_Nm"))
    strain.moment_noise_Nm = Positive("strain0.moment_noise_Nm");
}

void Application::SetStiffness(const std::string& name) {
  if (name == "instrument.bending_stiffness_Nm2") {
    recording_.instrument.bending_stiffness_Nm2 = Positive(name);
    return;
  }
  const double taper = Numbers(name, 1)[0];
  if (!(std::abs(taper) < 2)) {
    Refuse(name, fmt::format("found {}, expected above -2 and below 2", taper));
  }
  recording_.instrument.stiffness_taper = taper;
}

void Application::ApplyPose(const std::string& name, const Pose& pose) {
  if (name.starts_with("board.") || name == "tags0.T_WE") {
    applied_.not_used.push_back(name);
    return;
  }
  if (name == "cam0.T_RC" || name == "cam1.T_RC") {
    PlaceCameras(name, pose);
  } else if (name == "cam1.T_C0C1") {
    PlaceSecondCamera(pose);
  } else if (name == "em0.T_RF") {
    RegisterEm(pose);
  } else if (name.ends_with(".T_WC")) {
    Refuse(name,
           "the camera moves with the wrist, and only cameras that stand still are supported");
  } else {
    Refuse(name, "unknown name");
  }
  applied_.used.push_back(name);
}

void Application::ApplyNumbers(const std::string& name) {
  const std::string eye =
      name.starts_with("cam0.") || name.starts_with("cam1.") ? name.substr(5) : "";
  if (name == "pivot.p_R" || name == "tip.p_SE") {
    applied_.not_used.push_back(name);
    return;
  }
  if (name == "em0.field" || name == "em0.field_centre_m" || name == "em0.field_scale_m") {
    Need(recording_.em0, name);
    field_names_.push_back(name);
    return;
  }
  if (eye == "intrinsics") {
    SetIntrinsics(name);
  } else if (eye == "distortion_coefficients") {
    SetDistortion(name);
  } else if (eye == "time_offset_s") {
    ShiftFrames(name);
  } else if (name == "tip.p_WE") {
    MoveTip();
  } else if (name == "tags0.p_E") {
    MoveTipOnCollar();
  } else if (name == "em0.distance_from_tip_m") {
    SetEmDistance();
  } else if (name == "strain0.gage_matrix") {
    SetGages();
  } else if (name == "strain0.offset_Nm" || name == "strain0.moment_noise_Nm") {
    if (!Finds("strain0.gage_matrix")) SetGages();  // which says what is missing
  } else if (name == "instrument.bending_stiffness_Nm2" || name == "instrument.stiffness_taper") {
    SetStiffness(name);
  } else {
    Refuse(name, "unknown name");
  }
  applied_.used.push_back(name);
}

/// Its coefficients have taken it already.
void Application::ApplyText(const std::string& name) {
  const bool is_model = name == "cam0.distortion_model" || name == "cam1.distortion_model";
  if (!is_model) Refuse(name, "unknown name");
  if (!Finds(name.substr(0, 5) + "distortion_coefficients"))
    Refuse(name, "there are no distortion_coefficients with it");
  applied_.used.push_back(name);
}

/// Takes the field's distortion out of em0's places, which are in R already.
void Application::CorrectField() {
  if (!Finds("em0.field")) Refuse("em0.field", "missing beside its centre and scale");
  const auto three = [&](const std::string& name) -> Eigen::Vector3d {
    const auto found = found_.numbers.find(name);
    if (found == found_.numbers.end() || found->second.size() != 3) {
      Refuse(name, "expected three numbers with em0.field");
    }
    return Eigen::Vector3d(found->second.data());
  };
  const FieldCorrection field{found_.numbers.at("em0.field"), three("em0.field_centre_m"),
                              three("em0.field_scale_m")};
  if (!(field.scale_m.minCoeff() > 0)) Refuse("em0.field_scale_m", "expected more than 0");
  std::size_t outside = 0;
  auto& samples = recording_.em0->samples;
  for (auto& sample : samples) {
    outside += !FieldCovers(field, sample.value.p_RS);
    sample.value.p_RS = ApplyField(field, sample.value.p_RS);
  }
  applied_.used.insert(applied_.used.end(), field_names_.begin(), field_names_.end());
  if (outside == 0) return;
  applied_.warnings.insert(
      applied_.warnings.begin(),
      fmt::format("{}: {} of {} samples of em0 lie beyond where em0.field is known", file_.string(),
                  outside, samples.size()));
}

AppliedCalibration Application::Run() {
  for (const auto& [name, pose] : found_.poses) ApplyPose(name, pose);
  for (const auto& entry : found_.numbers) ApplyNumbers(entry.first);
  for (const auto& entry : found_.texts) ApplyText(entry.first);
  if (!field_names_.empty()) CorrectField();
  return std::move(applied_);
}

}  // namespace

AppliedCalibration ApplyCalibration(const std::filesystem::path& file,
                                    const Calibration& calibration, Recording& recording) {
  return Application(file, calibration, recording).Run();
}

std::vector<UsedCalibration> ApplyCalibrations(const std::vector<std::filesystem::path>& files,
                                               Recording& recording,
                                               std::vector<std::string>& warnings) {
  std::vector<UsedCalibration> used;
  for (const auto& file : files) {
    UsedCalibration one{file, ReadCalibration(file), {}};
    AppliedCalibration applied = ApplyCalibration(file, one.calibration, recording);
    one.names = std::move(applied.used);
    if (one.names.empty()) {
      warnings.push_back(fmt::format("{}: nothing in it is part of a recording", file.string()));
    }
    warnings.insert(warnings.end(), applied.warnings.begin(), applied.warnings.end());
    used.push_back(std::move(one));
  }
  return used;
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

}  // namespace flextip
