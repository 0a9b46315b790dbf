#include "apps/calibrate/tip/output.h"

#include <fmt/format.h>

#include <cmath>

#include "calibration/verdict/tip.h"
#include "recording/streams/series_file.h"
#include "recording/text/csv.h"

namespace flextip {
namespace {

constexpr const char* kPivot = "pivot.p_R";

std::vector<double> Numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

double Seconds(const std::vector<PivotPose>& poses, std::size_t i) {
  return 1e-9 * static_cast<double>(poses[i].t_ns - poses[0].t_ns);
}

nlohmann::json OutlierList(const std::vector<PivotPose>& poses, const PivotResult& result) {
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < result.residuals.size(); ++i) {
    if (result.residuals[i].used) continue;
    list.push_back(
        {{"pose", i}, {"seconds", Seconds(poses, i)}, {"reason", result.residuals[i].reason}});
  }
  return list;
}

}  // namespace

nlohmann::json TipSummary(const std::vector<PivotPose>& poses, const PivotResult& result,
                          const std::string& tip_name, const std::string& body) {
  nlohmann::json summary = {{"status", Name(result.status)}, {"poses", poses.size()}};
  if (result.residuals.empty()) return summary;
  summary.update({{"poses_used", result.used},
                  {"outliers", OutlierList(poses, result)},
                  {"rms_residual_m", result.rms_m},
                  {"heldout_rms_residual_m", result.heldout_rms_m},
                  {"algebraic_rms_residual_m", result.algebraic_rms_m},
                  {"position_noise_found_over_stated", result.position_noise_scale},
                  {"orientation_noise_found_over_stated", result.orientation_noise_scale},
                  {"noises_found_apart", result.separate_noise},
                  {"poses_counted_as_one", result.correlation_time},
                  {"least_turn_rad", result.turn_rad[0]},
                  {"advice", AdviceText(result, body)}});
  if (!result.IsUsable()) return summary;
  const Vector6d sd = result.covariance.diagonal().cwiseSqrt();
  summary["tip"] = {{"name", tip_name},
                    {"value_m", Numbers(result.p_BE)},
                    {"standard_deviation_m", Numbers(sd.head<3>())}};
  summary["pivot"] = {{"name", kPivot},
                      {"value_m", Numbers(result.p_R)},
                      {"standard_deviation_m", Numbers(sd.tail<3>())}};
  return summary;
}

std::string TipResidualTable(const std::vector<PivotPose>& poses, const PivotResult& result) {
  CsvWriter csv(TimedColumns({"r_x [mm]", "r_y [mm]", "r_z [mm]", "length [mm]", "heldout [mm]",
                              "sigmas []", "used []", "reason []"}));
  for (std::size_t i = 0; i < result.residuals.size(); ++i) {
    const PivotResidual& r = result.residuals[i];
    csv.Add(poses[i].t_ns);
    AddVector3(csv, 1e3 * r.r_R);
    csv.Add(1e3 * r.r_R.norm()).Add(1e3 * r.heldout_R.norm()).Add(r.sigmas);
    csv.Add(TimeNs{r.used ? 1 : 0}).Add(r.reason);
    csv.EndRow();
  }
  return csv.text();
}

std::vector<report::Figure> TipFigures(const std::vector<PivotPose>& poses,
                                       const PivotResult& result) {
  report::Figure time{.name = "residuals",
                      .title = "How far from the pivot each pose puts the tip",
                      .caption = "Held out: with that pose left out of the fit.",
                      .x_label = "time (s)",
                      .y_label = "distance (mm)"};
  report::FigureTrace used{
      .name = "used", .kind = report::FigureTrace::Kind::kPoints, .color = "#0072b2"};
  report::FigureTrace held{.name = "held out",
                           .kind = report::FigureTrace::Kind::kPoints,
                           .color = "#009e73",
                           .symbol = "circle-open"};
  report::FigureTrace out{.name = "outlier",
                          .kind = report::FigureTrace::Kind::kPoints,
                          .color = "#d55e00",
                          .symbol = "x"};
  report::Figure across{.name = "across",
                        .title = "The tips by each pose around the pivot",
                        .x_label = "x in R (mm)",
                        .y_label = "y in R (mm)",
                        .equal_axes = true};
  report::FigureTrace tips = used, far = out;
  for (std::size_t i = 0; i < result.residuals.size(); ++i) {
    const PivotResidual& r = result.residuals[i];
    const Eigen::Vector3d r_mm = 1e3 * r.r_R;
    report::FigureTrace& over_time = r.used ? used : out;
    over_time.x.push_back(Seconds(poses, i));
    over_time.y.push_back(r_mm.norm());
    report::FigureTrace& in_plane = r.used ? tips : far;
    in_plane.x.push_back(r_mm.x());
    in_plane.y.push_back(r_mm.y());
    if (!r.used) continue;
    held.x.push_back(Seconds(poses, i));
    held.y.push_back(1e3 * r.heldout_R.norm());
  }
  time.traces = {used, held, out};
  across.traces = {tips, far};
  return {time, across};
}

}  // namespace flextip
