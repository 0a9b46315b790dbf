#include "diagnosis/samples/sample_set.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/median.h"
#include "core/rotation.h"
#include "diagnosis/samples/load_smoothing.h"
#include "diagnosis/samples/outliers.h"
#include "diagnosis/samples/smoothing.h"
#include "diagnosis/samples/streams.h"

namespace flextip::diagnosis {
namespace {

constexpr int kMinSamples = 40;
constexpr double kMaxRate_hz = 60.0;
constexpr double kMinResolvedRate_hz = 5.0;
constexpr double kLongestDelay_s = 0.25;
constexpr double kStart_s = 0.3;
constexpr const char* kMoments[] = {"m1_y", "m1_z", "m2_y", "m2_z"};

class Builder {
 public:
  Builder(const Recording& recording, std::string name)
      : recording_(WithoutOutliers(recording, set_.warnings)), name_(std::move(name)) {}

  SampleSet Build() {
    if (!recording_.wrist0) {
      throw InputError(name_ + ": no wrist0, without which nothing can be replayed");
    }
    CopyConstants();
    AddWrist();
    AddEm();
    AddStrain();
    AddVision();
    AddLoad();
    DropEnds();
    FindCentre();
    CheckRedundancy();
    return std::move(set_);
  }

 private:
  void Warn(const std::string& text) { set_.warnings.push_back(text); }

  void CopyConstants() {
    set_.instrument = recording_.instrument;
    set_.p_RP = recording_.p_RP;
    set_.gravity_m_s2 = recording_.gravity_m_s2;
    set_.tolerances = recording_.tolerances;
    if (recording_.cam0 && recording_.cam0->has_T_RC) {
      set_.has_camera = true;
      set_.T_RC = recording_.cam0->calibration.T_RC;
    }
  }

  void AddWrist() {
    const WristStream& stream = *recording_.wrist0;
    const auto kept = Thinned(stream.samples, kMaxRate_hz);
    if (int(kept.size()) < kMinSamples) {
      throw InputError(fmt::format("{}: {} samples of the wrist, at least {} are needed to judge",
                                   name_, kept.size(), kMinSamples));
    }
    std::vector<double> t_s;
    std::vector<Eigen::Vector3d> p_RW;
    for (const auto& sample : kept) {
      times_.push_back(sample.t_ns);
      t_s.push_back(double(sample.t_ns - kept.front().t_ns) * 1e-9);
      p_RW.push_back(sample.value.p_RW);
    }
    std::vector<double> periods;
    for (std::size_t k = 1; k < t_s.size(); ++k) periods.push_back(t_s[k] - t_s[k - 1]);
    set_.period_s = Median(periods);
    set_.resolved_in_time = set_.period_s * kMinResolvedRate_hz < 1.0;
    set_.noise.wrist_position_m = stream.position_noise_m;
    set_.noise.wrist_direction_rad = stream.orientation_noise_rad;
    Smoothed smoothed{p_RW, std::vector<double>(p_RW.size(), stream.position_noise_m)};
    if (set_.resolved_in_time) smoothed = Smooth(t_s, p_RW, stream.position_noise_m);
    for (std::size_t k = 0; k < kept.size(); ++k) {
      DiagnosisSample sample;
      sample.t_s = t_s[k];
      sample.p_RW = smoothed.value[k];
      // Smoothing takes out fast noise only: against slow patterns there is as much as before.
      sample.p_RW_noise_m = stream.position_noise_m;
      AddWristOrientation(kept[k].value, sample);
      set_.samples.push_back(sample);
    }
  }

  void AddWristOrientation(const WristSample& wrist, DiagnosisSample& sample) {
    Eigen::Matrix3d R_RW = Eigen::Matrix3d::Identity();
    if (wrist.q_RW) {
      R_RW = wrist.q_RW->toRotationMatrix();
      if (set_.noise.wrist_direction_rad > 0.0) {
        sample.d_wrist = R_RW.col(0);
        SetPresent(sample, row::kWristDirection, 2);
        set_.has_wrist_direction = true;
      }
    } else {  // the axes of R, turned without twist toward the port
      const Eigen::Vector3d to_port = (set_.p_RP - wrist.p_RW).normalized();
      R_RW = RotationWithoutTwist(Eigen::Vector3d::UnitX(), to_port);
    }
    sample.y_wrist = R_RW.col(1);
  }

  void AddEm() {
    if (recording_.em0 && !recording_.em0->samples.empty()) AddTipEm(*recording_.em0);
    if (recording_.em1 && !recording_.em1->samples.empty()) AddPortEm(*recording_.em1);
  }

  void AddTipEm(const EmStream& em) {
    if (IsDead(em.samples, [](const EmSample& s) { return s.p_RS; })) {
      return Warn("em0 always says the same: left out");
    }
    if (em.position_noise_m <= 0.0) Warn("em0 states no noise of its places: left out");
    set_.has_em = true;
    set_.em_from_tip_m = em.distance_from_tip_m;
    set_.noise.em_position_m = em.position_noise_m;
    set_.noise.em_direction_rad = em.orientation_noise_rad;
    set_.noise.em_registration_m = em.registration_noise_m;
    set_.noise.em_registration_rad = em.registration_noise_rad;
    const auto nearest = Nearest(em.samples, times_, HalfPeriod());
    for (std::size_t k = 0; k < times_.size(); ++k) {
      if (nearest[k] < 0) continue;
      DiagnosisSample& sample = set_.samples[k];
      const auto& from = em.samples[nearest[k]];
      sample.dt_em_s = double(from.t_ns - times_[k]) * 1e-9;
      sample.p_RS = from.value.p_RS;
      sample.d_em = from.value.q_RS * Eigen::Vector3d::UnitX();
      if (em.position_noise_m > 0.0) SetPresent(sample, row::kEmPosition, 3);
      if (em.orientation_noise_rad > 0.0) SetPresent(sample, row::kEmDirection, 2);
    }
  }

  void AddPortEm(const EmStream& em) {
    if (IsDead(em.samples, [](const EmSample& s) { return s.q_RS.coeffs(); })) {
      return Warn("em1 always says the same: left out");
    }
    if (em.orientation_noise_rad <= 0.0) return;
    set_.has_port_direction = true;
    set_.noise.port_direction_rad = em.orientation_noise_rad;
    const auto nearest = Nearest(em.samples, times_, HalfPeriod());
    for (std::size_t k = 0; k < times_.size(); ++k) {
      if (nearest[k] < 0) continue;
      DiagnosisSample& sample = set_.samples[k];
      const auto& from = em.samples[nearest[k]];
      sample.dt_port_s = double(from.t_ns - times_[k]) * 1e-9;
      sample.d_port = from.value.q_RS * Eigen::Vector3d::UnitX();
      SetPresent(sample, row::kPortDirection, 2);
    }
  }

  void AddStrain() {
    if (!recording_.strain0 || recording_.strain0->moments_Nm.empty()) return;
    const StrainStream& strain = *recording_.strain0;
    if (strain.moment_noise_Nm <= 0.0) return Warn("strain0 states no noise: left out");
    const auto& wrist = recording_.wrist0->samples;
    if (std::none_of(wrist.begin(), wrist.end(), [](const auto& s) { return s.value.q_RW; })) {
      return Warn("strain0 is about the wrist's axes, whose orientation wrist0 lacks: left out");
    }
    std::bitset<4> dead;
    for (int i = 0; i < 4; ++i)
      dead[i] = IsDead(strain.moments_Nm, [i](const Eigen::Vector4d& m) { return m[i]; });
    if (dead.any()) {
      Warn(fmt::format("strain0: {} of 4 gages always say the same: left out", dead.count()));
    }
    if (dead.all()) return;
    for (int i = 0; i < 4; ++i) {
      const double part =
          PartAtLimit(strain.moments_Nm, [i](const Eigen::Vector4d& m) { return m[i]; });
      if (part > 0.0 && !dead[i])
        Warn(fmt::format("strain0: {} is at its limit in {:.0f} % of its readings", kMoments[i],
                         100.0 * part));
    }
    set_.has_strain = true;
    set_.noise.moment_Nm = strain.moment_noise_Nm;
    set_.strain_from_wrist_m = {strain.station_from_wrist_m[0], strain.station_from_wrist_m[1]};
    const auto nearest = Nearest(strain.moments_Nm, times_, HalfPeriod());
    for (std::size_t k = 0; k < times_.size(); ++k) {
      if (nearest[k] < 0) continue;
      DiagnosisSample& sample = set_.samples[k];
      sample.dt_strain_s = double(strain.moments_Nm[nearest[k]].t_ns - times_[k]) * 1e-9;
      sample.moments_Nm = strain.moments_Nm[nearest[k]].value;
      for (int i = 0; i < 4; ++i)
        if (!dead[i]) SetPresent(sample, row::kStrain + i, 1);
    }
  }

  void AddVision() {
    if (!recording_.vision0) return;
    const VisionStream& vision = *recording_.vision0;
    Series<TipObservation> seen;
    for (const auto& tip : vision.tips)
      if (tip.value.status == TipStatus::kOk) seen.push_back(tip);
    if (seen.empty()) return;
    if (IsDead(seen, [](const TipObservation& t) { return t.p_RE; })) {
      return Warn("vision0 always says the same: left out");
    }
    set_.has_tip = true;
    set_.noise.tip_direction_rad = vision.direction_noise_rad;
    set_.noise.vision_registration_m = vision.registration_noise_m;
    set_.noise.vision_registration_rad = vision.registration_noise_rad;
    const auto nearest = Nearest(seen, times_, HalfPeriod());
    for (std::size_t k = 0; k < times_.size(); ++k)
      if (nearest[k] >= 0) AddTip(seen[nearest[k]], times_[k], set_.samples[k]);
  }

  void AddTip(const Sample<TipObservation>& from, TimeNs t_ns, DiagnosisSample& sample) {
    sample.dt_tip_s = double(from.t_ns - t_ns) * 1e-9;
    sample.p_RE = from.value.p_RE;
    sample.p_RE_covariance_m2 = from.value.covariance_m2;
    SetPresent(sample, row::kTipPosition, 3);
    if (from.value.d_RE && set_.noise.tip_direction_rad > 0.0) {
      sample.d_tip = *from.value.d_RE;
      SetPresent(sample, row::kTipDirection, 2);
      set_.has_tip_direction = true;
    }
  }

  void AddLoad() {
    if (!recording_.load0 || recording_.load0->f_tip_N.empty()) return;
    const LoadStream& load = *recording_.load0;
    set_.noise.force_N = load.force_noise_N;
    int known = 0;
    for (std::size_t k = 0; k < times_.size(); ++k) {
      const auto f = ValueAt(load.f_tip_N, times_[k]);
      if (!f) continue;
      set_.samples[k].f_tip_N = *f;
      ++known;
    }
    // Samples outside the load's time would need a load of their own: leave them out.
    set_.has_load = known > int(times_.size()) / 2;
    if (!set_.has_load) return Warn("load0 covers less than half of the recording: left out");
    SmoothLoad(set_);
    if (known == int(times_.size())) return;
    for (std::size_t k = 0; k < times_.size(); ++k)
      if (!ValueAt(load.f_tip_N, times_[k])) set_.samples[k].present.reset();
  }

  /// Play and friction remember what came before the recording, and what late sensors say of its
  /// end may have been stamped after it: neither is judged.
  void DropEnds() {
    if (!set_.resolved_in_time) return;
    const double last_s = set_.samples.back().t_s;
    for (auto& sample : set_.samples) {
      if (sample.t_s < kStart_s) sample.present.reset();
      if (sample.t_s < last_s - kLongestDelay_s) continue;
      for (int r = row::kEmPosition; r < row::kStrain; ++r) sample.present.reset(r);
      for (int r = row::kTipPosition; r < row::kPortDirection; ++r) sample.present.reset(r);
    }
  }

  void FindCentre() {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int n = 0;
    for (const auto& sample : set_.samples) {
      if (sample.Has(row::kEmPosition) || sample.Has(row::kTipPosition)) {
        sum += sample.Has(row::kEmPosition) ? sample.p_RS : sample.p_RE;
        ++n;
      }
    }
    set_.centre = n > 0 ? Eigen::Vector3d(sum / n) : set_.p_RP;
  }

  void CheckRedundancy() {
    const std::size_t latent = set_.has_load ? 0 : 3;
    double spare = 0.0;
    for (const auto& sample : set_.samples)
      if (sample.present.count() > latent) spare += double(sample.present.count() - latent);
    if (spare < 2 * kMinSamples) {
      throw InputError(fmt::format(
          "{}: the sensors measure no more than {} (beside wrist0 it takes a load0 and one of "
          "vision0, em0 and strain0, or two of them): there is nothing to judge the simulation "
          "by{}{}",
          name_, latent == 0 ? "a handful of values" : "the unknown load takes",
          set_.warnings.empty() ? "" : "; ", fmt::join(set_.warnings, "; ")));
    }
  }

  static void SetPresent(DiagnosisSample& sample, int first_row, int rows) {
    for (int i = 0; i < rows; ++i) {
      sample.present.set(first_row + i);
      sample.spoken.set(first_row + i);
    }
  }
  TimeNs HalfPeriod() const { return TimeNs(0.51e9 * set_.period_s); }

  SampleSet set_;
  const Recording recording_;  // without outliers
  std::string name_;
  std::vector<TimeNs> times_;
};

}  // namespace

SampleSet MakeSampleSet(const Recording& recording, const std::string& name) {
  return Builder(recording, name).Build();
}

}  // namespace flextip::diagnosis
