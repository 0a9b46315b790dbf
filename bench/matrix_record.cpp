#include "bench/matrix_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "recording/text.h"

namespace flextip {
namespace {

using nlohmann::json;

bool Holds(const EffectNames& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

json CaseJson(const MatrixCase& one) {
  return {{"part", one.part},
          {"effects", one.effects},
          {"drawn", one.drawn},
          {"size", one.size},
          {"load", one.load},
          {"left_out", one.left_out},
          {"without", one.without},
          {"family", one.family},
          {"index", one.index},
          {"seed", one.seed},
          {"duration_s", one.duration_s}};
}

MatrixCase CaseFrom(const json& from) {
  MatrixCase one;
  from.at("part").get_to(one.part);
  from.at("effects").get_to(one.effects);
  from.at("drawn").get_to(one.drawn);
  from.at("size").get_to(one.size);
  from.at("load").get_to(one.load);
  from.at("left_out").get_to(one.left_out);
  from.at("without").get_to(one.without);
  from.at("family").get_to(one.family);
  from.at("index").get_to(one.index);
  from.at("seed").get_to(one.seed);
  from.at("duration_s").get_to(one.duration_s);
  return one;
}

json ParametersJson(const std::vector<JudgedParameter>& parameters) {
  json all = json::array();
  for (const JudgedParameter& p : parameters) {
    all.push_back({{"effect", p.effect},
                   {"parameter", p.parameter},
                   {"entry", p.entry},
                   {"truth", p.truth},
                   {"value", p.value},
                   {"sd", p.sd}});
  }
  return all;
}

void ReadParameters(const json& from, std::vector<JudgedParameter>& parameters) {
  for (const json& p : from) {
    parameters.push_back({p.at("effect"), p.at("parameter"), p.at("entry"), p.at("truth"),
                          p.at("value"), p.at("sd")});
  }
}

MatrixRecord RecordFrom(const json& from) {
  MatrixRecord r;
  r.made = CaseFrom(from.at("case"));
  from.at("key").get_to(r.key);
  from.at("motion").get_to(r.motion);
  from.at("load_kind").get_to(r.load);
  from.at("attempt").get_to(r.attempt);
  from.at("label").get_to(r.label);
  from.at("form").get_to(r.form);
  from.at("error").get_to(r.error);
  from.at("verdict").get_to(r.verdict);
  from.at("probabilities").get_to(r.probabilities);
  from.at("p_verdict").get_to(r.p_verdict);
  from.at("p_truth").get_to(r.p_truth);
  from.at("truth_in_credible_set").get_to(r.truth_in_credible_set);
  from.at("credible_set_size").get_to(r.credible_set_size);
  from.at("indistinguishable").get_to(r.indistinguishable);
  from.at("full_verdict").get_to(r.full_verdict);
  from.at("full_indistinguishable").get_to(r.full_indistinguishable);
  ReadParameters(from.at("parameters"), r.parameters);
  from.at("gain_measured").get_to(r.gain_measured);
  from.at("heldout_error_ratio").get_to(r.heldout_error_ratio);
  from.at("tip_error_ratio").get_to(r.tip_error_ratio);
  from.at("extended_weighted_rms").get_to(r.extended_weighted_rms);
  from.at("base_chi2_per_dof").get_to(r.base_chi2_per_dof);
  from.at("extended_chi2_per_dof").get_to(r.extended_chi2_per_dof);
  from.at("rounds").get_to(r.rounds);
  from.at("converged").get_to(r.converged);
  from.at("seconds").get_to(r.seconds);
  from.at("warnings").get_to(r.warnings);
  return r;
}

}  // namespace

bool MatrixRecord::IsRightOrDeclared() const {
  if (IsRight()) return true;
  if (verdict.size() != label.size()) return false;
  return std::all_of(label.begin(), label.end(), [&](const std::string& truth) {
    return Holds(verdict, truth) ||
           std::any_of(indistinguishable.begin(), indistinguishable.end(),
                       [&](const EffectNames& group) { return Holds(group, truth); });
  });
}

std::string JoinedNames(const EffectNames& names) {
  return fmt::format("{}", fmt::join(names, "+"));
}

std::string JsonLine(const MatrixRecord& r) {
  const json line = {{"case", CaseJson(r.made)},
                     {"key", r.key},
                     {"motion", r.motion},
                     {"load_kind", r.load},
                     {"attempt", r.attempt},
                     {"label", r.label},
                     {"form", r.form},
                     {"error", r.error},
                     {"verdict", r.verdict},
                     {"probabilities", r.probabilities},
                     {"p_verdict", r.p_verdict},
                     {"p_truth", r.p_truth},
                     {"truth_in_credible_set", r.truth_in_credible_set},
                     {"credible_set_size", r.credible_set_size},
                     {"indistinguishable", r.indistinguishable},
                     {"full_verdict", r.full_verdict},
                     {"full_indistinguishable", r.full_indistinguishable},
                     {"parameters", ParametersJson(r.parameters)},
                     {"gain_measured", r.gain_measured},
                     {"heldout_error_ratio", r.heldout_error_ratio},
                     {"tip_error_ratio", r.tip_error_ratio},
                     {"extended_weighted_rms", r.extended_weighted_rms},
                     {"base_chi2_per_dof", r.base_chi2_per_dof},
                     {"extended_chi2_per_dof", r.extended_chi2_per_dof},
                     {"rounds", r.rounds},
                     {"converged", r.converged},
                     {"seconds", r.seconds},
                     {"warnings", r.warnings}};
  return line.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::vector<MatrixRecord> ReadRecords(const std::filesystem::path& file) {
  std::vector<MatrixRecord> records;
  if (!std::filesystem::exists(file)) return records;
  const std::string text = ReadTextFile(file);
  std::istringstream lines(text.substr(0, text.rfind('\n') + 1));
  std::string line;
  for (long number = 1; std::getline(lines, line); ++number) {
    try {
      records.push_back(RecordFrom(json::parse(line)));
    } catch (const json::exception&) {
      throw InputError::At(file.string(), number, "not a case of the matrix");
    }
  }
  return records;
}

}  // namespace flextip
