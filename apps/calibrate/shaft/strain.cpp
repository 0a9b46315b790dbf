// flextip calibrate strain: the matrix of the gages, from masses hung on the tip.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "apps/calibrate/calibrate.h"
#include "apps/calibrate/shaft/run.h"
#include "apps/common/input/command_uses.h"
#include "calibration/shaft/strain_calibration.h"
#include "calibration/verdict/shaft.h"
#include "recording/text/csv.h"
#include "report/figure.h"

namespace flextip {
namespace {

struct Options {
  RecordingInput input;
  StrainCalibrationOptions strain;
  bool force = false;
};

constexpr const char* kChannels[] = {"m1_y", "m1_z", "m2_y", "m2_z"};

TimeNs StartOf(const StrainCalibration& result) { return result.holds.front().hold.first_ns; }

nlohmann::json Rows(const Eigen::Matrix4d& m) {
  nlohmann::json rows = nlohmann::json::array();
  for (int r = 0; r < 4; ++r) rows.push_back({m(r, 0), m(r, 1), m(r, 2), m(r, 3)});
  return rows;
}

/// What a channel reads of the others' moments, as shares of what it reads of its own.
nlohmann::json CrossTalk(const StrainCalibration& result) {
  nlohmann::json talk = nlohmann::json::object();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      if (row == column) continue;
      talk[fmt::format("{} of {}", kChannels[row], kChannels[column])] = {
          {"share", result.gains(row, column) / result.gains(row, row)},
          {"sd", result.gain_sd(row, column) / std::abs(result.gains(row, row))}};
    }
  }
  return talk;
}

nlohmann::json Summary(const StrainCalibration& result) {
  const auto& noise = result.reading_noise;
  nlohmann::json summary = {{"status", result.found.unobservable.empty() ? "ok" : "unobservable"},
                            {"chi2_per_dof", result.chi2_per_dof},
                            {"reading_noise", {noise[0], noise[1], noise[2], noise[3]}},
                            {"largest_moment_Nm", result.largest_moment_Nm},
                            {"advice", result.advice}};
  summary.update(HoldsJson(result.holds));
  if (result.gages_known) {
    summary["gage_matrix"] = Rows(result.gage_matrix);
    summary["gains_per_Nm"] = Rows(result.gains);
    summary["gains_sd_per_Nm"] = Rows(result.gain_sd);
    summary["cross_talk"] = CrossTalk(result);
    summary["moment_noise_Nm"] = result.moment_noise_Nm;
    summary["rms_Nm"] = result.rms_Nm;
    summary["heldout_rms_Nm"] = result.heldout_rms_Nm;
  }
  return summary;
}

std::string ResidualsText(const StrainCalibration& result) {
  std::vector<std::string> columns = {"t_s",     "samples []", "f_x [N]", "f_y [N]",
                                      "f_z [N]", "s_port [m]", "chi2 []", "used []"};
  for (const char* kind : {"stated", "residual"}) {
    for (const char* channel : kChannels)
      columns.push_back(fmt::format("{}_{} [Nm]", kind, channel));
  }
  columns.emplace_back("reason");
  CsvWriter csv(columns);
  for (const auto& h : result.holds) {
    csv.Add(SecondsAfter(StartOf(result), h.hold)).Add(static_cast<double>(h.hold.samples));
    for (const double f : h.hold.f_tip_N) csv.Add(f);
    csv.Add(h.s_port_m).Add(h.chi2).Add(h.used ? 1.0 : 0.0);
    for (const double m : h.m_stated_Nm) csv.Add(m);
    if (result.gages_known) {
      for (int i = 0; i < 4; ++i) csv.Add(h.m_measured_Nm[i] - h.m_stated_Nm[i]);
    } else {
      csv.AddEmpty(4);
    }
    csv.Add("\"" + h.reason + "\"");
    csv.EndRow();
  }
  return csv.text();
}

report::FigureTrace LeftOut() {
  return {.name = "left out",
          .kind = report::FigureTrace::Kind::kPoints,
          .color = "#1d2733",
          .symbol = "x"};
}

// A trace a channel with a point a hold, those left out crossed. `Point`: (hold, channel) to (x,
// y).
template <class Point>
std::vector<report::FigureTrace> ChannelTraces(const StrainCalibration& result,
                                               const Point& point) {
  std::vector<report::FigureTrace> traces;
  report::FigureTrace out = LeftOut();
  for (int c = 0; c < 4; ++c) {
    report::FigureTrace trace{.name = kChannels[c], .kind = report::FigureTrace::Kind::kPoints};
    for (const auto& h : result.holds) {
      const auto [x, y] = point(h, c);
      report::FigureTrace& to = h.used ? trace : out;
      to.x.push_back(x);
      to.y.push_back(y);
    }
    traces.push_back(trace);
  }
  if (!out.y.empty()) traces.push_back(out);
  return traces;
}

report::Figure MomentsFigure(const StrainCalibration& result) {
  report::Figure figure;
  figure.name = "moments";
  figure.title = "Measured against stated moments";
  figure.caption = "Each hold, as the calibrated gages measure it; crosses were left out.";
  figure.x_label = "stated by load and rod (Nm)";
  figure.y_label = "measured (Nm)";
  double most = 0;
  figure.traces = ChannelTraces(result, [&](const auto& h, int c) {
    most = std::max(most, std::abs(h.m_stated_Nm[c]));
    return std::pair(h.m_stated_Nm[c], h.m_measured_Nm[c]);
  });
  figure.traces.push_back(
      {.name = "equal", .x = {-most, most}, .y = {-most, most}, .dashed = true});
  return figure;
}

report::Figure ResidualFigure(const StrainCalibration& result) {
  report::Figure figure;
  figure.name = "residuals";
  figure.title = "What is left";
  figure.caption = "Measured less stated moment of each load over time; crosses were left out.";
  figure.x_label = "time (s)";
  figure.y_label = "residual (mNm)";
  figure.traces = ChannelTraces(result, [&](const auto& h, int c) {
    return std::pair(SecondsAfter(StartOf(result), h.hold),
                     1e3 * (h.m_measured_Nm[c] - h.m_stated_Nm[c]));
  });
  return figure;
}

/// The reason with the option that helps, where there is one.
std::string ReasonOf(const Calibration::Unobservable& u, const StrainCalibration& result) {
  const bool gages = u.parameter == "strain0.gage_matrix" && result.insertions_alike;
  return u.reason + (gages ? " (--stations-apart)" : "");
}

void Warn(const StrainCalibration& result, OutputFolder& output) {
  WarnOfHolds(result.holds, output);
  for (const auto& u : result.found.unobservable) {
    output.Warn(u.parameter + ": " + ReasonOf(u, result));
  }
  if (result.chi2_per_dof > 2) {
    output.Warn(
        fmt::format("the holds scatter more than noise and loads explain (chi2 {:.1f} a "
                    "degree of freedom); the uncertainty stated is wider by that",
                    result.chi2_per_dof));
  }
}

void Run(const Options& options, bool quiet) {
  ShaftRun run(options.input, UseOfStrain(), options.force, quiet);
  const StrainCalibration result =
      CalibrateStrain(run.read.recording, options.input.recording.string(), options.strain);
  Warn(result, run.output);
  CalibrationVerdict verdict = JudgeStrain(result);
  for (auto& u : verdict.not_found) u.reason = ReasonOf(u, result);
  std::vector<report::Figure> figures;
  if (result.gages_known) figures = {MomentsFigure(result), ResidualFigure(result)};
  run.Write({result.found, ResidualsText(result), figures, Summary(result), verdict});
  if (quiet) return;
  if (result.gages_known) {
    fmt::print("moments to {:.3g} mNm RMS ({:.3g} mNm held out) of {:.3g} mNm\n",
               1e3 * result.rms_Nm, 1e3 * result.heldout_rms_Nm, 1e3 * result.largest_moment_Nm);
  }
  for (const auto& u : result.found.unobservable) {
    fmt::print("{}: {}\n", u.parameter, ReasonOf(u, result));
  }
  run.PrintNext(result.advice);
}

}  // namespace

void AddCalibrateStrain(CLI::App& calibrate, AppContext& context) {
  auto* command =
      calibrate.add_subcommand("strain", "The strain gages' matrix and offset from known loads");
  auto options = std::make_shared<Options>();
  AddRecordingInput(*command, options->input);
  command
      ->add_option("--port-noise", options->strain.fit.port_noise_m,
                   "How well the port is registered: standard deviation per axis (m)")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--stations-apart", options->strain.fit.stations_apart,
                    "The gages of one station do not feel the other's moment: one insertion depth "
                    "is then enough");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "RECORDING has the gages' readings in strain0 (in any unit), the masses in load0, and "
      "wrist0.\n"
      "Example:\n  flextip calibrate strain masses -o strain\n"
      "  flextip estimate recording --calibration strain/calibration.yaml -o estimate\n");
  OnRun(*command, context, [options, &context] { Run(*options, context.quiet); });
}

}  // namespace flextip
