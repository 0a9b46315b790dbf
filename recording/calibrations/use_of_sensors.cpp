// The instrument, the EM sensors and the strain gages by what a calibration found.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "recording/calibrations/calibration_use.h"
#include "recording/calibrations/em_field.h"

namespace flextip {
namespace {

constexpr double kMostTilt_deg = 2.0;  // of the tip from the wrist's x axis

}  // namespace

/// The shaft models have the tip on the wrist's x axis.
void CalibrationUse::MoveTip() {
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

void CalibrationUse::MoveTipOnCollar() {
  const auto& p = Numbers("tags0.p_E", 3);
  TagCollar& collar = Need(recording_.tags0, "tags0.p_E");
  for (CollarTag& tag : collar.tags) tag.T_EG.p -= Eigen::Vector3d(p[0], p[1], p[2]);
  WarnOfTips("tags0.p_E");
}

void CalibrationUse::RegisterEm(const Pose& T_RF) {
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

void CalibrationUse::SetEmDistance() {
  EmStream& em = Need(recording_.em0, "em0.distance_from_tip_m");
  const double distance_m = Numbers("em0.distance_from_tip_m", 1)[0];
  if (!(distance_m >= 0 && distance_m <= recording_.instrument.length_m)) {
    Refuse("em0.distance_from_tip_m", fmt::format("found {}, expected 0 to the shaft's length {}",
                                                  distance_m, recording_.instrument.length_m));
  }
  em.distance_from_tip_m = distance_m;
}

void CalibrationUse::SetGages() {
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

void CalibrationUse::SetStiffness(const std::string& name) {
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

/// Takes the field's distortion out of em0's places, which are in R already.
void CalibrationUse::CorrectField() {
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

}  // namespace flextip
