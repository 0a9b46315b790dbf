#include "diagnosis/planning/imagined_samples.h"

#include "core/rotation.h"
#include "diagnosis/model/geometry.h"
#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {
namespace {

/// Any of the recorded samples, with every sensor that spoke in one of them.
DiagnosisSample Pattern(const SampleSet& recorded) {
  DiagnosisSample sample = recorded.samples[recorded.samples.size() / 2];
  for (const auto& other : recorded.samples) sample.present |= other.present;
  sample.dt_em_s = sample.dt_strain_s = sample.dt_tip_s = sample.dt_port_s = 0.0;
  if (recorded.has_tip && !sample.p_RE_covariance_m2.diagonal().all()) {
    for (const auto& other : recorded.samples)
      if (other.Has(row::kTipPosition)) sample.p_RE_covariance_m2 = other.p_RE_covariance_m2;
  }
  return sample;
}

Eigen::Vector3d Down(const SampleSet& recorded, const Eigen::Matrix3d& R_mean) {
  if (recorded.gravity_m_s2.norm() > 0.0) return recorded.gravity_m_s2.normalized();
  return R_mean.col(2);
}

}  // namespace

Eigen::Matrix3d MeanShaftFrame(const SampleSet& recorded) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& sample : recorded.samples) mean += (recorded.p_RP - sample.p_RW).normalized();
  mean.normalize();
  Eigen::Matrix3d R_mean;
  R_mean.col(0) = mean;
  R_mean.rightCols<2>() = NormalBasis(mean);
  return R_mean;
}

SampleSet ImagineSamples(const SampleSet& recorded, const ImaginedMotion& motion) {
  const Eigen::Matrix3d R_mean = MeanShaftFrame(recorded);
  DiagnosisSample sample = Pattern(recorded);
  sample.f_tip_N = motion.load_N * Down(recorded, R_mean);
  SampleSet samples = recorded;
  samples.samples.clear();
  samples.period_s = 1.0 / motion.rate_hz;
  samples.resolved_in_time = true;
  samples.has_load = recorded.has_load || motion.load_N > 0.0;
  for (int k = 0; k < int(motion.seconds * motion.rate_hz); ++k) {
    sample.t_s = k / motion.rate_hz;
    const ImaginedInstant now = motion.at(sample.t_s);
    sample.p_RW = now.p_RW;
    const Eigen::Vector3d d = (recorded.p_RP - now.p_RW).normalized();
    sample.y_wrist = ExpRotation(now.roll_rad * d) * R_mean.col(1);
    samples.samples.push_back(sample);
  }
  return samples;
}

bool MeasureByModel(SampleSet& samples, const ParameterLayout& layout,
                    const Eigen::VectorXd& theta) {
  if (samples.has_load) return true;
  SampleSet unloaded = samples;
  unloaded.has_load = true;
  for (DiagnosisSample& sample : unloaded.samples) sample.f_tip_N = Eigen::Vector3d::Zero();
  Replay replay(unloaded, layout);
  if (!replay.Evaluate(theta) || replay.FailedSamples() > 0) return false;
  for (std::size_t k = 0; k < samples.samples.size(); ++k) {
    const Geometry& at = replay.Samples()[k].solved.at;
    DiagnosisSample& sample = samples.samples[k];
    sample.f_tip_N = Eigen::Vector3d::Zero();
    sample.d_wrist = at.segment<3>(place::kWristTangent);
    sample.p_RS = at.segment<3>(place::kEm);
    sample.d_em = at.segment<3>(place::kEmTangent);
    sample.moments_Nm = at.segment<4>(place::kMoments);
    sample.p_RE = at.segment<3>(place::kTip);
    sample.d_tip = at.segment<3>(place::kTipTangent);
    sample.d_port = at.segment<3>(place::kPortTangent);
  }
  return true;
}

}  // namespace flextip::diagnosis
