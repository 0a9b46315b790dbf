#include "apps/calibrate/em/output.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "recording/streams/series_file.h"
#include "recording/text/csv.h"

namespace flextip {
namespace {

std::vector<double> Numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

double Seconds(const std::vector<EmPair>& pairs, std::size_t i) {
  return 1e-9 * static_cast<double>(pairs[i].t_ns - pairs[0].t_ns);
}

bool HasField(const EmResult& result) { return result.design.basis.kind != FieldKind::kNone; }

nlohmann::json CandidateList(const EmResult& result) {
  nlohmann::json list = nlohmann::json::array();
  for (const EmCandidate& c : result.candidates) {
    nlohmann::json row = {{"field", c.name}, {"chosen", c.chosen}, {"reason", c.reason}};
    row["heldout_rms_m"] = c.tried ? nlohmann::json(c.heldout_rms_m) : nlohmann::json(nullptr);
    row["gain_sigmas"] = c.tried ? nlohmann::json(c.gain_sigmas) : nlohmann::json(nullptr);
    list.push_back(row);
  }
  return list;
}

nlohmann::json OutlierList(const std::vector<EmPair>& pairs, const EmResult& result) {
  constexpr std::size_t kMost = 50;
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < result.residuals.size() && list.size() < kMost; ++i) {
    const EmResidual& r = result.residuals[i];
    if (!r.used) list.push_back({{"seconds", Seconds(pairs, i)}, {"reason", r.reason}});
  }
  return list;
}

/// Error vectors in a plane as lines from the place, `enlarged` times.
report::FigureTrace ErrorLines(const EmResult& result, bool after, int right, int up,
                               double enlarged) {
  constexpr std::size_t kMost = 400;
  const double gap = std::numeric_limits<double>::quiet_NaN();
  report::FigureTrace trace{.name = after ? "with the field" : "registration alone",
                            .color = after ? "#0072b2" : "#d55e00"};
  const std::size_t every = 1 + result.residuals.size() / kMost;
  for (std::size_t i = 0; i < result.residuals.size(); i += every) {
    const EmResidual& r = result.residuals[i];
    if (!r.used) continue;
    const Eigen::Vector3d from = 1e3 * r.place_R;
    const Eigen::Vector3d to = from + 1e3 * enlarged * (after ? r.after_R : r.before_R);
    trace.x.insert(trace.x.end(), {from[right], to[right], gap});
    trace.y.insert(trace.y.end(), {from[up], to[up], gap});
  }
  return trace;
}

report::Figure TimeFigure(const std::vector<EmPair>& pairs, const EmResult& result) {
  report::Figure figure{.name = "residuals",
                        .title = "Sensor less reference over time",
                        .caption =
                            "Length of the error. One that comes and goes with the motion is no "
                            "noise: a bent field, a clock, or the reference.",
                        .x_label = "time (s)",
                        .y_label = "distance (mm)"};
  report::FigureTrace before{
      .name = "registration alone", .kind = report::FigureTrace::Kind::kPoints, .color = "#d55e00"};
  report::FigureTrace after{.name = HasField(result) ? "with the field" : "used",
                            .kind = report::FigureTrace::Kind::kPoints,
                            .color = "#0072b2"};
  report::FigureTrace out{.name = "outlier",
                          .kind = report::FigureTrace::Kind::kPoints,
                          .color = "#1d2733",
                          .symbol = "x"};
  for (std::size_t i = 0; i < result.residuals.size(); ++i) {
    const EmResidual& r = result.residuals[i];
    report::FigureTrace& trace = r.used ? after : out;
    trace.x.push_back(Seconds(pairs, i));
    trace.y.push_back(1e3 * r.after_R.norm());
    if (!r.used || !HasField(result)) continue;
    before.x.push_back(Seconds(pairs, i));
    before.y.push_back(1e3 * r.before_R.norm());
  }
  figure.traces = {after, out};
  if (HasField(result)) figure.traces.insert(figure.traces.begin(), before);
  return figure;
}

}  // namespace

nlohmann::json EmSummary(const std::vector<EmPair>& pairs, const EmResult& result) {
  nlohmann::json summary = {{"status", Name(result.status)}, {"samples", pairs.size()}};
  if (!result.message.empty()) summary["message"] = result.message;
  if (result.residuals.empty()) return summary;
  summary.update({{"samples_used", result.used},
                  {"outliers", OutlierList(pairs, result)},
                  {"rms_registration_alone_m", result.rms_before_m},
                  {"rms_residual_m", result.rms_after_m},
                  {"noise_found_over_stated", result.noise_scale},
                  {"samples_counted_as_one", result.correlation_time},
                  {"sensor_tilt_rad", result.tilt_rad},
                  {"rms_direction_residual_rad", result.angle_rms_rad},
                  {"sensor_late_s", result.lag.late_s},
                  {"sensor_late_standard_deviation_s", result.lag.sd_s},
                  {"fields", CandidateList(result)}});
  if (!result.IsUsable()) return summary;
  const Eigen::VectorXd sd = result.solution.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  summary["p_RF_m"] = Numbers(result.solution.T_RF.p);
  summary["p_RF_standard_deviation_m"] = Numbers(sd.segment<3>(3));
  summary["R_RF_standard_deviation_rad"] = Numbers(sd.head<3>());
  summary["distance_from_tip_m"] = result.solution.distance_m;
  if (result.design.free_distance) summary["distance_standard_deviation_m"] = sd[6];
  return summary;
}

std::string EmResidualTable(const std::vector<EmPair>& pairs, const EmResult& result) {
  CsvWriter csv(TimedColumns({"r_x [mm]", "r_y [mm]", "r_z [mm]", "length [mm]", "before [mm]",
                              "angle [deg]", "sigmas []", "used []", "reason []"}));
  for (std::size_t i = 0; i < result.residuals.size(); ++i) {
    const EmResidual& r = result.residuals[i];
    csv.Add(pairs[i].t_ns);
    AddVector3(csv, 1e3 * r.after_R);
    csv.Add(1e3 * r.after_R.norm()).Add(1e3 * r.before_R.norm());
    csv.Add(r.angle_rad * 180.0 / M_PI).Add(r.sigmas);
    csv.Add(TimeNs{r.used ? 1 : 0}).Add(r.reason);
    csv.EndRow();
  }
  return csv.text();
}

std::vector<report::Figure> EmFigures(const std::vector<EmPair>& pairs, const EmResult& result) {
  std::vector<report::Figure> figures{TimeFigure(pairs, result)};
  const double enlarged =
      std::pow(10.0, std::floor(std::log10(0.02 / std::max(1e-6, result.rms_before_m))));
  const std::string axes = "xyz";
  for (const auto& [right, up] : {std::pair{0, 1}, std::pair{0, 2}}) {
    report::Figure figure{
        .name = fmt::format("errors-{}{}", axes[right], axes[up]),
        .title = fmt::format("Errors where the sensor was, {}",
                             enlarged == 1.0 ? "to scale" : fmt::format("{:g} times", enlarged)),
        .caption =
            "From where the sensor is to where it seems to be; outliers are not "
            "shown.",
        .x_label = fmt::format("{} in R (mm)", axes[right]),
        .y_label = fmt::format("{} in R (mm)", axes[up]),
        .equal_axes = true};
    figure.traces.push_back(ErrorLines(result, false, right, up, enlarged));
    if (HasField(result)) figure.traces.push_back(ErrorLines(result, true, right, up, enlarged));
    figures.push_back(figure);
  }
  return figures;
}

}  // namespace flextip
