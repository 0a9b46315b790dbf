// flextip calibrate stiffness: how stiff the shaft is, from known loads on the tip.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/calibrate/calibrate.h"
#include "apps/calibrate/shaft/run.h"
#include "apps/common/input/command_uses.h"
#include "calibration/shaft/stiffness_calibration.h"
#include "calibration/verdict/shaft.h"
#include "recording/text/csv.h"
#include "report/figure.h"

namespace flextip {
namespace {

struct Options {
  RecordingInput input;
  StiffnessCalibrationOptions stiffness;
  std::string model = "auto";
  bool force = false;
};

nlohmann::json ModelJson(const StiffnessModel& m) {
  return {{"converged", m.converged},
          {"bending_stiffness_Nm2", m.stiffness_Nm2},
          {"bending_stiffness_sd_Nm2", m.stiffness_sd_Nm2},
          {"taper", m.taper},
          {"taper_sd", m.taper_sd},
          {"chi2_per_dof", m.chi2_per_dof},
          {"tip_rms_m", m.tip_rms_m},
          {"heldout_tip_rms_m", m.heldout_tip_rms_m},
          {"heldout_chi2_per_measurement", m.heldout_chi2}};
}

nlohmann::json Summary(const StiffnessCalibration& result) {
  nlohmann::json bins = nlohmann::json::array();
  for (const auto& bin : result.by_insertion) {
    bins.push_back({{"inserted_m", bin.inserted_m},
                    {"holds", bin.holds},
                    {"tip_rms_m", bin.tip_rms_m},
                    {"along_load_m_N", bin.along_load_m_N}});
  }
  const auto& port = result.port_shift_m;
  nlohmann::json models = nlohmann::json::object();
  if (result.constant) models["constant"] = ModelJson(*result.constant);
  if (result.tapered) models["taper"] = ModelJson(*result.tapered);
  nlohmann::json summary = {{"status", Name(result.status)},
                            {"model", result.taper_chosen ? "taper" : "constant"},
                            {"models", models},
                            {"largest_bend_m", result.bend_m},
                            {"port_shift_m", {port.x(), port.y(), port.z()}},
                            {"by_insertion", bins},
                            {"advice", result.advice}};
  summary.update(HoldsJson(result.holds));
  return summary;
}

std::string ResidualsText(const StiffnessCalibration& result) {
  const TimeNs start_ns = result.holds.front().hold.first_ns;
  CsvWriter csv({"t_s", "samples []", "f_x [N]", "f_y [N]", "f_z [N]", "s_port [m]", "e_x [m]",
                 "e_y [m]", "e_z [m]", "chi2 []", "measurements []", "used []", "reason"});
  for (const auto& h : result.holds) {
    csv.Add(SecondsAfter(start_ns, h.hold));
    csv.Add(static_cast<double>(h.hold.samples));
    for (const double f : h.hold.f_tip_N) csv.Add(f);
    csv.Add(h.s_port_m);
    for (const double e : h.place_residual_m) csv.Add(e);
    csv.Add(h.chi2).Add(static_cast<double>(h.measurements)).Add(h.used ? 1.0 : 0.0);
    csv.Add("\"" + h.reason + "\"");
    csv.EndRow();
  }
  return csv.text();
}

report::Figure InsertionFigure(const StiffnessCalibration& result) {
  report::Figure figure;
  figure.name = "by-insertion";
  figure.title = "What is left, by insertion";
  figure.caption =
      "Tip measured less predicted: RMS, and per newton along the load. A level line per newton is "
      "a compliance that does not depend on depth, one that rises is stiffness or the port.";
  figure.x_label = "inserted (mm)";
  figure.y_label = "residual (mm, mm/N)";
  report::FigureTrace rms{.name = "RMS (mm)"}, along{.name = "along the load (mm/N)"};
  for (const auto& bin : result.by_insertion) {
    rms.x.push_back(1e3 * bin.inserted_m);
    rms.y.push_back(1e3 * bin.tip_rms_m);
    along.x.push_back(1e3 * bin.inserted_m);
    along.y.push_back(1e3 * bin.along_load_m_N);
  }
  figure.traces = {rms, along};
  return figure;
}

/// The load's part of each hold's residual, over the load.
report::Figure LoadFigure(const StiffnessCalibration& result) {
  report::Figure figure;
  figure.name = "by-load";
  figure.title = "What is left, by load";
  figure.caption = "Tip measured less predicted along the load, of each hold used.";
  figure.x_label = "load (N)";
  figure.y_label = "residual along the load (mm)";
  report::FigureTrace trace{.kind = report::FigureTrace::Kind::kPoints};
  for (const auto& h : result.holds) {
    const double force_N = h.hold.f_tip_N.norm();
    if (!h.used || force_N == 0) continue;
    trace.x.push_back(force_N);
    trace.y.push_back(1e3 * h.place_residual_m.dot(h.hold.f_tip_N) / force_N);
  }
  figure.traces = {trace};
  return figure;
}

void Warn(const StiffnessCalibration& result, OutputFolder& output) {
  WarnOfHolds(result.holds, output);
  for (const auto& u : result.found.unobservable) output.Warn(u.parameter + ": " + u.reason);
  output.Warn(StiffnessDoubts(result));
}

void Print(const StiffnessCalibration& result) {
  const auto& m = result.chosen();
  fmt::print("{}: E I {:.5g} +- {:.2g} Nm2", Name(result.status), m.stiffness_Nm2,
             m.stiffness_sd_Nm2);
  if (result.taper_chosen) fmt::print(", taper {:.3f} +- {:.3f}", m.taper, m.taper_sd);
  fmt::print("; tip {:.3f} mm RMS ({:.3f} mm held out)\n", 1e3 * m.tip_rms_m,
             1e3 * m.heldout_tip_rms_m);
}

void Run(Options options, bool quiet) {
  static const std::map<std::string, StiffnessChoice> choices{
      {"auto", StiffnessChoice::kByHeldoutError},
      {"constant", StiffnessChoice::kConstant},
      {"taper", StiffnessChoice::kTaper}};
  options.stiffness.choice = choices.at(options.model);
  ShaftRun run(options.input, UseOfStiffness(), options.force, quiet);
  const StiffnessCalibration result =
      CalibrateStiffness(run.read.recording, options.input.recording.string(), options.stiffness);
  Warn(result, run.output);
  run.Write({result.found,
             ResidualsText(result),
             {InsertionFigure(result), LoadFigure(result)},
             Summary(result),
             JudgeStiffness(result)});
  if (quiet) return;
  Print(result);
  for (const std::string& warning : run.output.warnings()) fmt::print("beware: {}\n", warning);
  run.PrintNext(result.advice);
}

}  // namespace

void AddCalibrateStiffness(CLI::App& calibrate, AppContext& context) {
  auto* command = calibrate.add_subcommand(
      "stiffness", "The shaft's bending stiffness and its taper from known loads");
  auto options = std::make_shared<Options>();
  AddRecordingInput(*command, options->input);
  command
      ->add_option("--model", options->model,
                   "constant, taper, or auto: whichever predicts better what it was not fitted to")
      ->check(CLI::IsMember({"auto", "constant", "taper"}))
      ->capture_default_str();
  command
      ->add_option("--port-noise", options->stiffness.port_noise_m,
                   "How well the port is registered: standard deviation per axis (m)")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--most-holds", options->stiffness.most_holds,
                   "Of longer recordings every n-th load is taken")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "RECORDING has the loads in load0, wrist0, and the tip in vision0 or em0.\n"
      "Example:\n  flextip calibrate stiffness masses -o stiffness\n"
      "  flextip estimate recording --calibration stiffness/calibration.yaml -o estimate\n");
  OnRun(*command, context, [options, &context] { Run(*options, context.quiet); });
}

}  // namespace flextip
