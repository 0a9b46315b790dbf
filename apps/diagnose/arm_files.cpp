#include "apps/diagnose/arm_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/diagnose/result_files.h"

namespace flextip {
namespace {

using Json = nlohmann::ordered_json;
using report::Figure;
using report::FigureTrace;

Json ListOrNumber(const std::vector<double>& values) {
  return values.size() == 1 ? Json(values[0]) : Json(values);
}

Json ParametersJson(const std::vector<diagnosis::ReportedParameter>& parameters) {
  Json json = Json::object();
  for (const auto& p : parameters)
    json[p.name] = {{"value", ListOrNumber(p.value)}, {"sd", ListOrNumber(p.sd)}};
  return json;
}

/// Errors in mrad, mm, Nm or N.
double Shown(const std::string& component, double value) {
  return component.ends_with("_rad") || component.ends_with("_m") ? 1e3 * value : value;
}
std::string ShownUnit(const std::string& component) {
  if (component.ends_with("_rad")) return "mrad";
  if (component.ends_with("_m")) return "mm";
  return component.substr(component.rfind('_') + 1);
}

Figure ErrorsByJoint(const arms::ArmResult& result) {
  Figure figure{.name = "errors-by-joint",
                .title = "Error by joint and sensor, before and after",
                .caption =
                    "Root mean square on stretches that were not fitted, in units of the "
                    "stated noise.",
                .y_label = "error / noise",
                .log_y = true};
  FigureTrace before{.name = "base", .kind = FigureTrace::Kind::kBars, .color = "#b0b7bf"};
  FigureTrace after{.name = "extended", .kind = FigureTrace::Kind::kBars, .color = "#1f6feb"};
  for (const arms::ComponentScore& c : result.components) {
    const std::string label = c.channel + " " + c.component.substr(0, c.component.rfind('_'));
    before.labels.push_back(label);
    after.labels.push_back(label);
    before.y.push_back(std::max(1e-3, c.base / c.noise));
    after.y.push_back(std::max(1e-3, c.extended / c.noise));
  }
  figure.traces = {before, after};
  return figure;
}

/// The arm as it stands, its joints coloured by how much of their error was wrong.
Figure JointDrawing(const arms::ArmResult& result) {
  std::string findings;
  for (std::size_t i = 0; i < result.joint_findings.size(); ++i)
    if (!result.joint_findings[i].empty())
      findings += fmt::format(" Joint {}: {}.", i + 1, result.joint_findings[i]);
  Figure figure{.name = "joints",
                .title = "The arm's joints, coloured by what is wrong",
                .caption =
                    "Grey: as its file says. Red: the joint's error falls by more than half "
                    "with the extended model. Orange: by more than a tenth. Seen from the side, "
                    "in the middle of the recording; joints at one place stand beside each other." +
                    findings,
                .x_label = "mm",
                .y_label = "mm",
                .equal_axes = true};
  FigureTrace links{.kind = FigureTrace::Kind::kLine, .color = "#8c959f", .width = 4};
  FigureTrace grey{.name = "as its file says",
                   .kind = FigureTrace::Kind::kPoints,
                   .color = "#8c959f",
                   .symbol = "circle"};
  FigureTrace orange = grey, red = grey;
  orange.name = "some is wrong";
  orange.color = "#d4820f";
  red.name = "wrong";
  red.color = "#c62828";
  links.x = {1e3 * result.side_view.front().x()};
  links.y = {1e3 * result.side_view.front().y()};
  for (std::size_t i = 0; i < result.joint_types.size(); ++i) {
    double least = 1.0;
    for (const arms::ComponentScore& c : result.components)
      if (c.joint == int(i) && c.base > 2.0 * c.noise) least = std::min(least, c.extended / c.base);
    FigureTrace& trace = least < 0.5 ? red : least < 0.9 ? orange : grey;
    const Eigen::Vector2d p_mm = 1e3 * result.side_view[i + 1];
    links.x.push_back(p_mm.x());
    links.y.push_back(p_mm.y());
    trace.x.push_back(p_mm.x());
    trace.y.push_back(p_mm.y());
    trace.texts.push_back(fmt::format("{}", i + 1));
  }
  figure.traces.push_back(links);
  for (const FigureTrace& trace : {grey, orange, red})
    if (!trace.x.empty()) figure.traces.push_back(trace);
  return figure;
}

FigureTrace Dots(const std::string& name, const std::string& color) {
  return {.name = name, .kind = FigureTrace::Kind::kPoints, .color = color};
}

Json TipJson(const simulation::JointLoopResult& run) {
  return {{"max_deviation_m", run.tip_max_m}, {"rms_deviation_m", run.tip_rms_m}};
}

Json LoopJson(const arms::ArmResult& result, const simulation::JointGain& gain) {
  Json json = {{"controller", "joint-feed-forward"}};
  for (Eigen::Index i = 0; gain.ran && i < gain.base.rms.size(); ++i) {
    const bool turns = result.joint_types[std::size_t(i)] == "revolute";
    json["joints"].push_back({{"component", fmt::format("q{}_{}", i + 1, turns ? "rad" : "m")},
                              {"rms_before", gain.base.rms[i]},
                              {"rms_after", gain.extended.rms[i]},
                              {"max_before", gain.base.max[i]},
                              {"max_after", gain.extended.max[i]}});
  }
  if (gain.ran) {
    json["before"] = TipJson(gain.base);
    json["after"] = TipJson(gain.extended);
    json["limited_cycles"] = gain.extended.rate_limited + gain.extended.correction_limited;
  }
  json["notes"] = gain.notes;
  return json;
}

/// The joints and the errors of each component, of the joints' own sensors.
Json ArmJson(const arms::ArmResult& result) {
  Json joints = Json::array();
  for (std::size_t i = 0; i < result.joint_types.size(); ++i)
    joints.push_back(
        {{"joint", i + 1}, {"type", result.joint_types[i]}, {"finding", result.joint_findings[i]}});
  Json components = Json::array();
  for (const arms::ComponentScore& c : result.components)
    components.push_back({{"channel", c.channel},
                          {"component", c.component},
                          {"noise", c.noise},
                          {"memory", c.memory},
                          {"base_rms", c.base},
                          {"extended_rms", c.extended}});
  return {{"joints", joints}, {"components", components}, {"not_told", result.not_told}};
}

}  // namespace

std::vector<Figure> CurveFigures(const std::vector<arms::ComponentCurve>& curves) {
  std::vector<Figure> figures;
  for (const arms::ComponentCurve& curve : curves) {
    if (curve.recording != 0 || figures.size() >= 12) continue;
    const bool torque = curve.channel == "torque0";
    const std::string unit = ShownUnit(curve.component);
    const std::string joint = curve.component.substr(0, curve.component.rfind('_'));
    Figure figure{
        .name = curve.channel + "-" + joint,
        .title = torque ? "Effort left of " + joint : "Seen less given, " + joint,
        .x_label =
            torque ? "time (s)" : fmt::format("given {} ({})", joint, unit == "mrad" ? "rad" : "m"),
        .y_label = fmt::format("{} ({})", torque ? "misfit" : "difference", unit)};
    FigureTrace measured = Dots(torque ? "base" : "measured", "#8c959f"),
                predicted = Dots("extended", "#1f6feb");
    for (std::size_t k = 0; k < curve.t_s.size(); ++k) {
      measured.x.push_back(torque ? curve.t_s[k] : curve.input[k]);
      predicted.x.push_back(measured.x.back());
      const double from = torque ? curve.base[k] : curve.input[k];
      measured.y.push_back(Shown(curve.component, curve.measured[k] - from));
      predicted.y.push_back(Shown(curve.component, torque ? curve.measured[k] - curve.extended[k]
                                                          : curve.extended[k] - from));
    }
    figure.traces = {measured, predicted};
    figures.push_back(std::move(figure));
  }
  return figures;
}

std::vector<Figure> ArmFigures(const arms::ArmResult& result) {
  std::vector<Figure> figures{JointDrawing(result), ErrorsByJoint(result)};
  for (Figure& figure : CurveFigures(result.curves)) figures.push_back(std::move(figure));
  return figures;
}

std::string HeldDiagnosisJson(const arms::HeldResult& result, const Arm& arm) {
  Json json = Json::parse(DiagnosisJson(result.answer));
  if (result.arm) {
    json["arm"] = ArmJson(*result.arm);
  } else {
    for (std::size_t i = 0; i < arm.joints.size(); ++i) {
      const bool turns = arm.joints[i].type == JointType::kRevolute;
      json["arm"]["joints"].push_back(
          {{"joint", i + 1}, {"type", turns ? "revolute" : "prismatic"}, {"finding", ""}});
    }
  }
  return json.dump(2) + "\n";
}

std::string ArmDiagnosisJson(const arms::ArmResult& result, const simulation::JointGain* gain) {
  Json json = Json::parse(DiagnosisJson(result.answer));
  json["arm"] = ArmJson(result);
  Json noise = Json::object();
  for (const arms::ComponentScore& c : result.components)
    noise[c.channel + "_" + c.component] = c.noise;
  json["noise_sd"] = noise;
  if (gain != nullptr) json["closed_loop"] = LoopJson(result, *gain);
  if (result.recordings.size() < 2) return json.dump(2) + "\n";
  json["recordings"] = result.recordings;
  Json changes = Json::array();
  for (const arms::Change& change : result.changes)
    changes.push_back({{"effect", change.effect},
                       {"first_in", result.recordings[change.first_in]},
                       {"probability", change.probability},
                       {"parameters", ParametersJson(change.parameters)}});
  json["changes"] = changes;
  json["presence_in"] = result.presence_in;
  return json.dump(2) + "\n";
}

std::string ArmRecordingJson(const arms::RecordingAnswer& recording) {
  return DiagnosisJson(recording.answer);
}

nlohmann::json ArmPredictionSummary(const arms::ArmPrediction& p) {
  nlohmann::json summary = {{"samples", p.samples},
                            {"base_rms", p.base_rms},
                            {"extended_rms", p.extended_rms},
                            {"ratio", p.ratio},
                            {"not_shown", p.not_shown}};
  if (p.base_tip_rms_m > 0.0) {
    summary["base_tip_rms_m"] = p.base_tip_rms_m;
    summary["extended_tip_rms_m"] = p.extended_tip_rms_m;
    summary["base_tip_mean_m"] = p.base_tip_mean_m;
    summary["extended_tip_mean_m"] = p.extended_tip_mean_m;
    summary["tip_ratio"] = p.tip_ratio;
  }
  return summary;
}

}  // namespace flextip
