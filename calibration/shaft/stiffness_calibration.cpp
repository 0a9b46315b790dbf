#include "calibration/shaft/stiffness_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/shaft/stiffness_model_fit.h"
#include "core/error.h"

namespace flextip {
namespace {

constexpr double kTaperPrior = 1.0;
constexpr double kKnownStiffness = 0.1, kKnownTaper = 0.3;  // standard deviations, of one
constexpr int kBins = 10;

LoadClock ClockOf(const Recording& recording, const std::string& source) {
  const auto need = [&](bool is, const char* what) {
    if (!is) throw InputError::At(source, 0, fmt::format("no {}, which a stiffness needs", what));
  };
  need(recording.load0.has_value(), "load0 (known loads)");
  need(recording.wrist0.has_value(), "wrist0");
  need(recording.vision0 || recording.em0, "vision0 and no em0");
  return recording.vision0 ? LoadClock::kVision : LoadClock::kEm;
}

StiffnessSetup SetupOf(const Recording& recording, const std::vector<LoadHold>& holds,
                       const StiffnessCalibrationOptions& options) {
  StiffnessSetup setup;
  setup.instrument = recording.instrument;
  setup.p_RP = recording.p_RP;
  setup.gravity_m_s2 = recording.gravity_m_s2;
  setup.port_noise_m = options.port_noise_m;
  setup.stations_m[0] = setup.stations_m[1] = recording.instrument.length_m / 2;
  if (recording.strain0) {
    setup.stations_m[0] = recording.strain0->station_from_wrist_m[0];
    setup.stations_m[1] = recording.strain0->station_from_wrist_m[1];
    setup.moment_noise_Nm = recording.strain0->moment_noise_Nm;
  }
  if (recording.vision0) {
    setup.vision_turn_rad = recording.vision0->registration_noise_rad;
    setup.vision_shift_m = recording.vision0->registration_noise_m;
  }
  if (recording.em0) {
    setup.em_from_tip_m = recording.em0->distance_from_tip_m;
    setup.em_turn_rad = recording.em0->registration_noise_rad;
    setup.em_shift_m = recording.em0->registration_noise_m;
  }
  double n = 0;
  for (const LoadHold& hold : holds) {
    if (!hold.p_RE && !hold.T_RS) continue;
    setup.centre += hold.p_RE ? *hold.p_RE : hold.T_RS->p;
    ++n;
  }
  setup.centre /= std::max(n, 1.0);
  return setup;
}

/// The taper is believed where it predicts better and is no chance.
bool IsTaperBetter(const StiffnessModel& constant, const StiffnessModel& tapered) {
  return tapered.converged && tapered.taper_sd < kKnownTaper &&
         std::abs(tapered.taper) > 3 * tapered.taper_sd &&
         tapered.heldout_chi2 < constant.heldout_chi2 &&
         tapered.heldout_tip_rms_m < constant.heldout_tip_rms_m;
}

std::string WhyFar(const StiffnessHoldResult& hold) {
  return fmt::format("the tip is {:.2f} mm from where the load should bend it, chi2 {:.0f} of {}",
                     1e3 * hold.place_residual_m.norm(), hold.chi2, hold.measurements);
}

void FillHolds(const std::vector<LoadHold>& holds, const StiffnessModelFit& chosen,
               StiffnessCalibration& result) {
  for (std::size_t i = 0; i < holds.size(); ++i) {
    const StiffnessRows& rows = chosen.fit().rows[i];
    StiffnessHoldResult out;
    out.hold = holds[i];
    if (!rows.usable) {
      out.reason = "no sensor saw the shaft, or the rod has no equilibrium under this load";
    } else {
      out.s_port_m = rows.s_port_m;
      if (rows.has_place) out.place_residual_m = rows.residual.head<3>();
      out.chi2 = rows.Chi2();
      out.measurements = static_cast<int>(rows.residual.size());
      out.used = chosen.weights()[i] > 0;
      if (!out.used) out.reason = WhyFar(out);
      if (rows.has_place) {
        result.bend_m = std::max(result.bend_m, rows.by_unknowns.block<3, 1>(0, 0).norm());
      }
    }
    result.holds.push_back(out);
  }
}

void FillInsertions(double length_m, StiffnessCalibration& result) {
  double least = 1e300, most = -1e300;
  for (const auto& h : result.holds) {
    if (!h.used) continue;
    least = std::min(least, length_m - h.s_port_m);
    most = std::max(most, length_m - h.s_port_m);
  }
  std::vector<InsertionResidual> bins(most - least < 2e-3 ? 1 : kBins);
  std::vector<double> load_squares(bins.size());
  for (const auto& h : result.holds) {
    if (!h.used) continue;
    const double inserted = length_m - h.s_port_m;
    const auto bins_n = static_cast<double>(bins.size());
    const auto b = static_cast<std::size_t>(
        std::clamp((inserted - least) / std::max(most - least, 1e-9) * bins_n, 0.0, bins_n - 1));
    InsertionResidual& bin = bins[b];
    bin.inserted_m += inserted;
    bin.tip_rms_m += h.place_residual_m.squaredNorm();
    bin.along_load_m_N += h.place_residual_m.dot(h.hold.f_tip_N);
    load_squares[b] += h.hold.f_tip_N.squaredNorm();
    ++bin.holds;
  }
  for (std::size_t b = 0; b < bins.size(); ++b) {
    InsertionResidual& bin = bins[b];
    if (bin.holds == 0) continue;
    bin.inserted_m /= bin.holds;
    bin.tip_rms_m = std::sqrt(bin.tip_rms_m / bin.holds);
    bin.along_load_m_N = load_squares[b] > 0 ? bin.along_load_m_N / load_squares[b] : 0;
    result.by_insertion.push_back(bin);
  }
}

void FillFound(const StiffnessModelFit& chosen, StiffnessCalibration& result) {
  const StiffnessModel& model = chosen.model();
  Calibration& found = result.found;
  found.kind = "stiffness";
  if (result.status == StiffnessStatus::kUnobservable) {
    found.unobservable.push_back(
        {"instrument.bending_stiffness_Nm2",
         fmt::format("the loads bend the tip by {:.3g} mm at most, which leaves the stiffness "
                     "unknown by {:.0f} %; hang more, or insert further",
                     1e3 * result.bend_m, 100 * model.stiffness_sd_Nm2 / model.stiffness_Nm2)});
  } else {
    found.numbers["instrument.bending_stiffness_Nm2"] = {model.stiffness_Nm2};
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(result.taper_chosen ? 2 : 1, 2);
    J(0, 0) = model.stiffness_Nm2;
    if (result.taper_chosen) {
      found.numbers["instrument.stiffness_taper"] = {model.taper};
      J(1, 1) = 1;
    }
    found.covariance = J * chosen.covariance().topLeftCorner<2, 2>() * J.transpose();
  }
  const auto& tapered = result.tapered;
  if (tapered && !(tapered->converged && tapered->taper_sd < kKnownTaper)) {
    found.unobservable.push_back(
        {"instrument.stiffness_taper",
         fmt::format("a stiffer wrist end and a stiffer tip end look alike here (standard "
                     "deviation {:.2g}); load at more insertions",
                     tapered->taper_sd)});
  }
}

}  // namespace

const char* Name(StiffnessStatus status) {
  switch (status) {
    case StiffnessStatus::kOk:
      return "ok";
    case StiffnessStatus::kModelIncomplete:
      return "model incomplete";
    case StiffnessStatus::kUnobservable:
      return "unobservable";
  }
  return "";
}

StiffnessCalibration CalibrateStiffness(const Recording& recording, const std::string& source,
                                        const StiffnessCalibrationOptions& options) {
  const LoadClock clock = ClockOf(recording, source);
  const std::vector<LoadHold> holds = LoadHolds(recording, clock, options.most_holds);
  const auto usable =
      std::count_if(holds.begin(), holds.end(), [](const LoadHold& h) { return h.p_RE || h.T_RS; });
  if (usable < 5) {
    throw InputError::At(
        source, 0, fmt::format("found {} loads with wrist and tip, expected at least 5", usable));
  }
  StiffnessSetup setup = SetupOf(recording, holds, options);
  std::optional<StiffnessModelFit> constant, tapered;
  if (options.choice != StiffnessChoice::kTaper) constant.emplace(setup, holds);
  setup.taper_prior = kTaperPrior;
  if (options.choice != StiffnessChoice::kConstant) tapered.emplace(setup, holds);
  StiffnessCalibration result;
  if (constant) result.constant = constant->model();
  if (tapered) result.tapered = tapered->model();
  result.taper_chosen = !constant || (tapered && IsTaperBetter(*result.constant, *result.tapered));
  StiffnessModelFit& chosen = result.taper_chosen ? *tapered : *constant;
  result.port_noise_m = options.port_noise_m;
  FillHolds(holds, chosen, result);
  FillInsertions(recording.instrument.length_m, result);
  result.port_shift_m = chosen.fit().x.segment<3>(kStiffnessPort);
  const double sd = result.chosen().stiffness_sd_Nm2 / result.chosen().stiffness_Nm2;
  result.status = !result.chosen().converged || !(sd < kKnownStiffness)
                      ? StiffnessStatus::kUnobservable
                  : chosen.IsIncomplete() ? StiffnessStatus::kModelIncomplete
                                          : StiffnessStatus::kOk;
  FillFound(chosen, result);
  result.advice = AdviseLoad(chosen, result.taper_chosen, recording.p_RP, result);
  return result;
}

}  // namespace flextip
