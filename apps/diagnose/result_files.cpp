#include "apps/diagnose/result_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "diagnosis/model/catalogue.h"
#include "diagnosis/model/extended_model.h"
#include "diagnosis/planning/motion_file.h"
#include "diagnosis/replay/sample_input.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

using namespace diagnosis;
using Json = nlohmann::ordered_json;

/// A number, or a list where there are several.
Json Value(const std::vector<double>& values) {
  return values.size() == 1 ? Json(values[0]) : Json(values);
}

Json Fits(const std::vector<EffectFit>& fits) {
  Json json = Json::object();
  for (const EffectFit& fit : fits)
    for (const ReportedParameter& p : fit.parameters)
      json[fit.effect][p.name] = {{"value", Value(p.value)}, {"sd", Value(p.sd)}};
  return json;
}

Json Score(const ModelScore& score) {
  return {{"heldout_rms", score.heldout_rms},
          {"tip_prediction_rms_m", score.tip_prediction_rms_m},
          {"weighted_rms", score.weighted_rms},
          {"chi2_per_dof", score.chi2_per_dof}};
}

/// Hypotheses that could matter to anybody, and always none and unknown.
Json ProbabilitiesOf(const DiagnosisResult& result) {
  Json json = Json::object();
  for (const auto& h : result.probabilities) {
    const bool always = h.verdict.size() == 1;
    if (always || h.probability > 1e-4) json[Joined(h.verdict)] = h.probability;
  }
  return json;
}

Json Signatures(const std::vector<Signature>& signatures) {
  Json json = Json::array();
  for (const Signature& s : signatures)
    json.push_back({{"channel", s.channel}, {"against", s.against}, {"score", s.score}});
  return json;
}

/// A number for each channel that was measured.
Json ByChannel(const DiagnosisResult& result, const std::array<double, kChannelCount>& values) {
  Json json = Json::object();
  for (int c = 0; c < kChannelCount; ++c) {
    const bool measured = result.base.heldout_rms.contains(kChannels[c].name);
    if (measured) json[kChannels[c].name] = values[c];
  }
  return json;
}

/// Of the base simulation: its parameters' values, or their tolerances.
Json Nominal(const DiagnosisResult& result, bool tolerances) {
  Json json = Json::object();
  for (const EffectFit& fit : result.nominal)
    for (const ReportedParameter& p : fit.parameters)
      json[fit.effect][p.name] = Value(tolerances ? p.sd : p.value);
  return json;
}

Json Summaries(const DiagnosisResult& result) {
  Json json = Json::object();
  for (const auto& name : result.catalogue) json[name] = result.summaries.at(name);
  return json;
}

/// A number, or null where there is none.
Json OrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json PlanOf(const NextMotion& plan) {
  Json json = {
      {"needed", plan.needed},           {"rivals", plan.rivals},
      {"text", Sentence(plan)},          {"file", plan.places_m.empty() ? "" : "motion.yaml"},
      {"seconds", plan.seconds},         {"seconds_to_certain", OrNull(plan.seconds_to_certain)},
      {"probability", plan.probability}, {"least_sure", plan.least_sure},
      {"tip_speed_m_s", plan.speed_m_s}, {"hung_weight_N", plan.load_N}};
  json["library"] = {{"motion", plan.library_motion},
                     {"seconds_to_certain", OrNull(plan.library_seconds_to_certain)},
                     {"probability", plan.library_probability}};
  return json;
}

Json TermNameJson(const TermName& name) {
  return {{"channel", name.channel}, {"depends_on", name.depends_on}, {"form", name.form}};
}

/// A list, not an object of pairs, where there are two numbers.
Json List(const Eigen::VectorXd& values) {
  Json json = Json::array();
  for (const double value : values) json.push_back(value);
  return json;
}

/// What was found that has no name.
Json DiscoveredJson(const std::vector<Discovered>& terms) {
  Json json = Json::array();
  for (const Discovered& one : terms) {
    Json term = {
        {"channel", one.name.channel}, {"direction", List(one.direction)}, {"frame", one.frame}};
    term["depends_on"] = one.name.depends_on;
    term["form"] = one.name.form;
    term["parameters"] = Json::object();
    for (const ReportedParameter& p : one.parameters)
      term["parameters"][p.name] = {{"value", Value(p.value)}, {"sd", Value(p.sd)}};
    term["text"] = one.text;
    term["false_discovery"] = one.false_discovery;
    term["stability"] = one.stability;
    if (one.gain.measured)
      term["gain"] = {{"heldout_error_ratio", one.gain.heldout_error_ratio},
                      {"tip_error_ratio", one.gain.tip_error_ratio}};
    term["region"] = {{"largest", one.region.largest},
                      {"part_of_samples", one.region.part},
                      {"insertion_depth_m", {one.region.depth_low_m, one.region.depth_high_m}},
                      {"p_RE_low_m", List(one.region.p_RE_low)},
                      {"p_RE_high_m", List(one.region.p_RE_high)}};
    term["could_be"] = Json::array();
    for (const TermName& other : one.could_be) term["could_be"].push_back(TermNameJson(other));
    json.push_back(std::move(term));
  }
  return json;
}

nlohmann::json Deviations(double max_m, double rms_m) {
  return {{"max_deviation_m", max_m}, {"rms_deviation_m", rms_m}};
}

nlohmann::json Compared(const simulation::ControllerGain& gain) {
  return {{"controller", Name(gain.kind)},
          {"before", Deviations(gain.base.max_m, gain.base.rms_m)},
          {"after", Deviations(gain.extended.max_m, gain.extended.rms_m)}};
}

Json ResultJson(const DiagnosisResult& result, const simulation::ClosedLoopGain* gain) {
  const bool known = NamesEffects(result.verdict);
  Json json;
  json["verdict"] = result.verdict.front();
  json["verdicts"] = result.verdict;
  json["probabilities"] = ProbabilitiesOf(result);
  json["presence"] = result.presence;
  json["credible_set_90"] = result.credible_set;
  json["indistinguishable"] = result.indistinguishable;
  json["separating_motion"] = result.separating_motion;
  json["separating_motion_score"] = result.separating_motion_score;
  if (result.plan) json["planned_motion"] = PlanOf(*result.plan);
  json["parameters"] = known ? Fits(result.parameters) : Json::object();
  json["within_tolerance"] = Fits(result.within_tolerance);
  json["discovered"] = DiscoveredJson(result.discovered);
  json["base"] = Score(result.base);
  json["extended"] = Score(result.extended);
  if (result.gain.measured)
    json["gain"] = {{"heldout_error_ratio", result.gain.heldout_error_ratio},
                    {"heldout_error_ratio_interval",
                     {result.gain.heldout_error_ratio_low, result.gain.heldout_error_ratio_high}},
                    {"tip_error_ratio", result.gain.tip_error_ratio}};
  json["residual_signature"] = Signatures(result.signatures);
  json["residual_memory"] = {{"channel", result.memory.channel},
                             {"correlation", result.memory.correlation},
                             {"samples_as_one", result.memory.SamplesAsOne()}};
  json["adequate"] = result.IsAdequate();
  json["noise_scale"] = ByChannel(result, result.noise_scale);
  json["noise_sd"] = ByChannel(result, result.noise_sd);
  json["nominals"] = Nominal(result, false);
  json["tolerances"] = Nominal(result, true);
  json["catalogue"] = result.catalogue;
  json["summaries"] = Summaries(result);
  json["samples"] = result.samples;
  json["failed_samples"] = result.failed_samples;
  json["fits"] = result.fits;
  json["converged"] = result.converged;
  json["has_load"] = result.has_load;
  json["warnings"] = result.warnings;
  const auto runs = gain ? gain->controllers : std::vector<simulation::ControllerGain>{};
  for (const simulation::ControllerGain& run : runs) {
    if (!run.ran) continue;
    json["closed_loop_runs"] += Json(Compared(run));
    if (run.kind == ControllerKind::kRodTrack) json["closed_loop"] = Compared(run);
  }
  return json;
}

/// How likely each effect is in each recording, in their order.
Json PresenceIn(const SeveralResult& several) {
  Json json = Json::object();
  for (const std::string& effect : several.common.catalogue) {
    for (const DiagnosisResult& own : several.own) {
      const auto found = own.presence.find(effect);
      json[effect] += found == own.presence.end() ? 0.0 : found->second;
    }
  }
  return json;
}

}  // namespace

std::string DiagnosisJson(const DiagnosisResult& result, const simulation::ClosedLoopGain* gain) {
  return ResultJson(result, gain).dump(2) + "\n";
}

std::string DiagnosisJson(const SeveralResult& several, const simulation::ClosedLoopGain* gain) {
  Json json = ResultJson(several.common, gain);
  json["recordings"] = several.names;
  json["presence_in"] = PresenceIn(several);
  json["changes"] = Json::array();
  for (const FoundChange& change : several.changes) {
    Json parameters = Json::object();
    for (const ReportedParameter& p : change.parameters)
      parameters[p.name] = {{"value", Value(p.value)}, {"sd", Value(p.sd)}};
    json["changes"].push_back({{"effect", change.effect},
                               {"first_in", several.names[change.first_in]},
                               {"probability", change.probability},
                               {"parameters", parameters}});
  }
  return json.dump(2) + "\n";
}

std::string ResidualsCsv(const ResidualTable& residuals) {
  CsvWriter csv(residuals.columns);
  for (std::size_t k = 0; k < residuals.rows.size(); ++k) {
    for (std::size_t c = 0; c < residuals.columns.size(); ++c) {
      if (residuals.present[k][c]) {
        csv.Add(residuals.rows[k][c], 6);
      } else {
        csv.AddEmpty();
      }
    }
    csv.EndRow();
  }
  return csv.TakeText();
}

std::string DiscoveredCsv(const std::vector<Discovered>& terms) {
  constexpr std::size_t kMostRows = 1000;
  if (terms.empty()) return "";
  std::vector<std::string> columns;
  std::size_t rows = 0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    for (const char* what : {"variable", "measured", "term"})
      columns.push_back(fmt::format("{}.{}", i + 1, what));
    rows = std::max(rows, terms[i].picture.variable.size());
  }
  CsvWriter csv(columns);
  const std::size_t stride = 1 + rows / kMostRows;
  for (std::size_t k = 0; k < rows; k += stride) {
    for (const Discovered& one : terms) {
      for (const auto* values : {&one.picture.variable, &one.picture.measured, &one.picture.term}) {
        if (k < values->size()) {
          csv.Add((*values)[k], 6);
        } else {
          csv.AddEmpty();
        }
      }
    }
    csv.EndRow();
  }
  return csv.TakeText();
}

void WriteDiagnosisFiles(const std::filesystem::path& folder, const std::string& json,
                         const DiagnosisResult& result) {
  WriteTextFile(folder / "diagnosis.json", json);
  WriteTextFile(folder / "residuals.csv", ResidualsCsv(result.residuals));
  WriteModel(folder / "model.yaml", FromResult(result));
  if (!result.discovered.empty())
    WriteTextFile(folder / "discovered.csv", DiscoveredCsv(result.discovered));
  if (result.plan && !result.plan->places_m.empty())
    WriteMotion(folder / "motion.yaml", *result.plan);
}

}  // namespace flextip
