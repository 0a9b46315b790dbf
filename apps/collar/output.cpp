#include "apps/collar/output.h"

#include <fmt/format.h>

#include <numbers>

#include "apps/calibrate/verdict_json.h"
#include "recording/text/csv.h"
#include "targets/collar/verdict.h"

namespace flextip {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

report::FigureTrace Trace(const std::vector<AccuracyAtDistance>& accuracy, const std::string& name,
                          const std::string& color, bool dashed,
                          double (*value)(const AccuracyAtDistance&)) {
  report::FigureTrace trace{.name = name, .color = color, .dashed = dashed};
  for (const AccuracyAtDistance& at : accuracy) {
    trace.x.push_back(1e3 * at.distance_m);
    trace.y.push_back(value(at));
  }
  return trace;
}

}  // namespace

nlohmann::json CollarSummary(const CollarDesign& d, const ViewingConditions& conditions,
                             const std::vector<AccuracyAtDistance>& accuracy) {
  nlohmann::json ids = nlohmann::json::array(), rows = nlohmann::json::array();
  for (const CollarTag& tag : d.collar.tags) ids.push_back(tag.id);
  for (const AccuracyAtDistance& at : accuracy) {
    rows.push_back({{"distance_m", at.distance_m},
                    {"tag_px", at.tag_px},
                    {"tip_rms_m", at.expected.tip_m},
                    {"tip_worst_roll_m", at.expected.worst_tip_m},
                    {"direction_deg", kDegrees * at.expected.direction_rad},
                    {"least_tip_m", at.least.tip_m},
                    {"least_direction_deg", kDegrees * at.least.direction_rad}});
  }
  return {{"verdict", VerdictJson(JudgeCollar(d, conditions, accuracy))},
          {"family", d.collar.family},
          {"ids", ids},
          {"faces", d.wishes.faces},
          {"shaft_diameter_m", d.wishes.shaft_diameter_m},
          {"tag_size_m", d.tag_size_m},
          {"tag_with_rim_m", d.plate_m},
          {"face_width_m", d.face_m},
          {"bore_m", d.bore_m},
          {"across_faces_m", d.across_m},
          {"outer_diameter_m", d.outer_m},
          {"length_m", d.length_m},
          {"from_tip_m", d.wishes.from_tip_m},
          {"paper_m", d.wishes.paper_m},
          {"readable_to_m", ReadableTo(d.cell_m, conditions.camera)},
          {"focal_length_px", conditions.camera.fu_px},
          {"noise_grey", conditions.noise_grey},
          {"blur_px", conditions.blur_px},
          {"accuracy", rows}};
}

std::string AccuracyTable(const std::vector<AccuracyAtDistance>& accuracy) {
  CsvWriter csv({"distance [m]", "tag [px]", "tip [m]", "across [m]", "depth [m]",
                 "direction [rad]", "tip_worst_roll [m]", "least_tip [m]", "least_across [m]",
                 "least_depth [m]", "least_direction [rad]", "least_tip_worst_roll [m]"});
  for (const AccuracyAtDistance& at : accuracy) {
    csv.Add(at.distance_m).Add(at.tag_px);
    for (const TipError* e : {&at.expected, &at.least}) {
      csv.Add(e->tip_m).Add(e->across_m).Add(e->depth_m).Add(e->direction_rad).Add(e->worst_tip_m);
    }
    csv.EndRow();
  }
  return csv.text();
}

std::vector<report::Figure> AccuracyFigures(const std::vector<AccuracyAtDistance>& accuracy) {
  using At = AccuracyAtDistance;
  constexpr const char *kExpected = "#0072b2", *kDepth = "#d55e00", *kLeast = "#56606b";
  report::Figure tip{.name = "tip",
                     .title = "Tip error to expect",
                     .caption =
                         "RMS over the collar's rolls, of a single picture. Dashed: what the "
                         "pixels' noise alone leaves; no method is better.",
                     .x_label = "camera to collar (mm)",
                     .y_label = "error (mm)",
                     .log_y = true};
  tip.traces = {
      Trace(accuracy, "tip", kExpected, false, [](const At& a) { return 1e3 * a.expected.tip_m; }),
      Trace(accuracy, "its depth", kDepth, false,
            [](const At& a) { return 1e3 * a.expected.depth_m; }),
      Trace(accuracy, "least possible", kLeast, true,
            [](const At& a) { return 1e3 * a.least.tip_m; })};
  report::Figure direction{.name = "direction",
                           .title = "Direction error to expect",
                           .caption = "Angle between the shaft's direction and the one found, RMS.",
                           .x_label = "camera to collar (mm)",
                           .y_label = "error (°)",
                           .log_y = true};
  direction.traces = {Trace(accuracy, "direction", kExpected, false,
                            [](const At& a) { return kDegrees * a.expected.direction_rad; }),
                      Trace(accuracy, "least possible", kLeast, true,
                            [](const At& a) { return kDegrees * a.least.direction_rad; })};
  return {tip, direction};
}

}  // namespace flextip
