#include "calibration/verdict/shaft.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace flextip {
namespace {

constexpr double kManyRejected = 0.1;  // of the holds
constexpr double kTooMuchChi2 = 2.0;   // a degree of freedom
constexpr double kMuchWorse = 1.5;     // held-out error over the one in sample

constexpr const char* kUsers = "the commands on what this instrument records";
constexpr const char* kUse =
    "flextip estimate RECORDING --calibration RESULT/calibration.yaml -o RESULT-estimate";

template <typename Hold>
void JudgeHolds(const std::vector<Hold>& holds, CalibrationVerdict& verdict) {
  const auto rejected = static_cast<std::size_t>(
      std::count_if(holds.begin(), holds.end(), [](const Hold& h) { return !h.used; }));
  verdict.Add("loads used", fmt::format("{} of {}", holds.size() - rejected, holds.size()));
  verdict.MentionCount(rejected, static_cast<double>(holds.size()), kManyRejected,
                       Counted(rejected, "load") + " did not fit and do not count, see below");
}

}  // namespace

CalibrationVerdict JudgeStrain(const StrainCalibration& r) {
  CalibrationVerdict verdict;
  verdict.next = r.advice;
  verdict.not_found = r.found.unobservable;
  if (!r.gages_known) {
    verdict.grade = Grade::kNotFound;
    verdict.says = "These loads do not tell what the gages read of a moment.";
    JudgeHolds(r.holds, verdict);
    return verdict;
  }
  constexpr const char* kChannels[] = {"m1_y", "m1_z", "m2_y", "m2_z"};
  for (int i = 0; i < 4; ++i) {
    verdict.Add(fmt::format("gain of {}", kChannels[i]),
                fmt::format("{:.5g} per Nm", r.gains(i, i)),
                fmt::format("{:.2g} per Nm", r.gain_sd(i, i)));
  }
  double talk = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      if (i != j) talk = std::max(talk, std::abs(r.gains(i, j) / r.gains(i, i)));
    }
  }
  verdict.Add("most cross-talk", fmt::format("{:.2f} %", 100 * talk));
  verdict.Add("noise of a moment", fmt::format("{:.3g} mNm", 1e3 * r.moment_noise_Nm));
  verdict.Add("moments off by", fmt::format("{:.3g} mNm RMS", 1e3 * r.rms_Nm));
  if (r.heldout_rms_Nm > 0) {
    verdict.Add("loads held out", fmt::format("{:.3g} mNm RMS", 1e3 * r.heldout_rms_Nm));
  }
  verdict.Add("chi2 a degree of freedom", fmt::format("{:.2f}", r.chi2_per_dof));
  JudgeHolds(r.holds, verdict);
  if (r.chi2_per_dof > kTooMuchChi2) {
    verdict.Beware(
        fmt::format("loads scatter {:.1f} times as much as noise and their statement "
                    "explain; the uncertainties are wider by that",
                    std::sqrt(r.chi2_per_dof)));
  }
  const double error = r.heldout_rms_Nm > 0 ? r.heldout_rms_Nm : r.rms_Nm;
  if (r.heldout_rms_Nm > kMuchWorse * r.rms_Nm) {
    verdict.Beware("loads that were held out are predicted far worse than those fitted: too few");
  }
  verdict.says = fmt::format("{} Moments are measured to {:.3g} mNm, {:.1f} % of the largest.",
                             verdict.Judged(), 1e3 * error, 100 * error / r.largest_moment_Nm);
  verdict.AdviseUse(kUsers, kUse);
  return verdict;
}

std::vector<std::string> StiffnessDoubts(const StiffnessCalibration& r) {
  std::vector<std::string> doubts;
  if (r.status == StiffnessStatus::kModelIncomplete) {
    doubts.push_back(fmt::format(
        "no stiffness explains these shapes to their noise (chi2 {:.1f} a degree of freedom): "
        "something else gives way too, and the stiffness found makes up for it; a diagnosis of "
        "the recording says what it may be. The uncertainty stated is wider by that",
        r.chosen().chi2_per_dof));
  }
  if (r.port_shift_m.norm() > 4 * r.port_noise_m) {
    doubts.push_back(
        fmt::format("the port would have to be {:.2f} mm from where it is registered, which "
                    "is said to be good to {:.2f} mm",
                    1e3 * r.port_shift_m.norm(), 1e3 * r.port_noise_m));
  }
  return doubts;
}

CalibrationVerdict JudgeStiffness(const StiffnessCalibration& r) {
  CalibrationVerdict verdict;
  verdict.next = r.advice;
  verdict.not_found = r.found.unobservable;
  const StiffnessModel& m = r.chosen();
  verdict.Add("bending stiffness E I", fmt::format("{:.5g} Nm²", m.stiffness_Nm2),
              fmt::format("{:.2g} Nm²", m.stiffness_sd_Nm2));
  if (r.taper_chosen) {
    verdict.Add("taper", fmt::format("{:.3f}", m.taper), fmt::format("{:.3f}", m.taper_sd));
  }
  verdict.Add("tip off by", fmt::format("{:.3f} mm RMS", 1e3 * m.tip_rms_m));
  verdict.Add("eighths held out", fmt::format("{:.3f} mm RMS", 1e3 * m.heldout_tip_rms_m));
  verdict.Add("most bent by", fmt::format("{:.1f} mm", 1e3 * r.bend_m));
  verdict.Add("chi2 a degree of freedom", fmt::format("{:.2f}", m.chi2_per_dof));
  verdict.Add("port shifted by", fmt::format("{:.2f} mm", 1e3 * r.port_shift_m.norm()));
  JudgeHolds(r.holds, verdict);
  if (r.status == StiffnessStatus::kUnobservable) {
    verdict.grade = Grade::kNotFound;
    verdict.says = "These loads bend the shaft too little to tell its stiffness.";
    return verdict;
  }
  for (const std::string& doubt : StiffnessDoubts(r)) verdict.Beware(doubt);
  if (r.status == StiffnessStatus::kModelIncomplete) {
    verdict.next = "let a diagnosis say what else gives way";
    verdict.command = "flextip diagnose RECORDING -o RESULT-cause";
  }
  verdict.says = fmt::format(
      "{} The stiffness is known to {:.2g} %; loads held out put the tip {:.2f} mm off, of {:.1f} "
      "mm "
      "that it bends.",
      verdict.Judged(), 100 * m.stiffness_sd_Nm2 / m.stiffness_Nm2, 1e3 * m.heldout_tip_rms_m,
      1e3 * r.bend_m);
  verdict.AdviseUse(kUsers, kUse);
  return verdict;
}

}  // namespace flextip
