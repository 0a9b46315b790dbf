#include "report/diagnose/result.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "report/labels.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

using Json = nlohmann::ordered_json;

Json ReadObject(const std::filesystem::path& path) {
  auto json = Json::parse(ReadBytes(path), nullptr, false);
  if (!json.is_object()) throw InputError::At(path.string(), 0, "not an object");
  return json;
}

/// The member, or an empty object that has no members of its own.
const Json& Member(const Json& json, const char* key) {
  static const Json nothing = Json::object();
  const auto it = json.find(key);
  return it == json.end() || it->is_null() ? nothing : *it;
}

std::optional<double> NumberIn(const Json& json, const char* key) {
  const Json& value = Member(json, key);
  if (!value.is_number()) return std::nullopt;
  return value.get<double>();
}

/// Of an error: zero is what stands where nothing was measured.
std::optional<double> PositiveIn(const Json& json, const char* key) {
  const auto number = NumberIn(json, key);
  return number && *number > 0.0 ? number : std::nullopt;
}

std::string TextIn(const Json& json, const char* key) {
  const Json& value = Member(json, key);
  return value.is_string() ? value.get<std::string>() : "";
}

std::vector<double> NumberOrList(const Json& value) {
  if (value.is_number()) return {value.get<double>()};
  if (!value.is_array()) return {};
  std::vector<double> all;
  for (const auto& v : value) {  // a matrix may be a list of lists
    const auto part = NumberOrList(v);
    all.insert(all.end(), part.begin(), part.end());
  }
  return all;
}

template <class T>
std::map<std::string, T> MapIn(const Json& json, const char* key) {
  std::map<std::string, T> map;
  for (const auto& [name, value] : Member(json, key).items()) map[name] = value.template get<T>();
  return map;
}

std::vector<std::string> TextsIn(const Json& json, const char* key) {
  const Json& list = Member(json, key);
  return list.is_array() ? list.get<std::vector<std::string>>() : std::vector<std::string>{};
}

std::vector<std::pair<std::string, double>> RankedIn(const Json& json, const char* key) {
  std::vector<std::pair<std::string, double>> ranked;
  for (const auto& [name, p] : Member(json, key).items()) ranked.emplace_back(name, p);
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return ranked;
}

std::vector<std::string> Split(const std::string& joined) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= joined.size();) {
    const auto end = std::min(joined.find('+', begin), joined.size());
    parts.push_back(joined.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// `list` as `size` numbers: one number stands for all; empty where it has another size.
std::vector<double> Stretched(std::vector<double> list, std::size_t size) {
  if (list.size() == 1) return std::vector<double>(size, list.front());
  return list.size() == size ? list : std::vector<double>{};
}

/// What the base simulation takes where the file does not say so: factors are one.
double UsualNominal(const std::string& name) {
  return name.ends_with("scale") || name.ends_with("gain") ? 1.0 : 0.0;
}

std::vector<bool> JointsThatTurn(const Json& json) {
  std::vector<bool> turns;
  for (const Json& joint : Member(Member(json, "arm"), "joints"))
    turns.push_back(joint.value("type", "") == "revolute");
  return turns;
}

std::vector<DiagnosedParameter> ParametersIn(const Json& json, const char* key) {
  std::vector<DiagnosedParameter> all;
  const std::vector<bool> turns = JointsThatTurn(json);
  for (const auto& [effect, parameters] : Member(json, key).items()) {
    const Json& tolerances = Member(Member(json, "tolerances"), effect.c_str());
    const Json& nominals = Member(Member(json, "nominals"), effect.c_str());
    for (const auto& [name, stated] : parameters.items()) {
      DiagnosedParameter p{.effect = effect, .name = name};
      p.joint_turns = turns;
      p.value = NumberOrList(Member(stated, "value"));
      p.is_list = Member(stated, "value").is_array();
      const std::size_t size = p.value.size();
      if (size == 0) continue;
      p.sd = Stretched(NumberOrList(Member(stated, "sd")), size);
      p.tolerance = Stretched(NumberOrList(Member(tolerances, name.c_str())), size);
      p.nominal = Stretched(NumberOrList(Member(nominals, name.c_str())), size);
      if (p.nominal.empty()) p.nominal.assign(size, UsualNominal(name));
      all.push_back(std::move(p));
    }
  }
  return all;
}

DiagnosedScore ScoreIn(const Json& json, const char* key) {
  const Json& score = Member(json, key);
  return {.heldout_rms = MapIn<double>(score, "heldout_rms"),
          .tip_prediction_rms_m = PositiveIn(score, "tip_prediction_rms_m"),
          .weighted_rms = PositiveIn(score, "weighted_rms"),
          .chi2_per_dof = PositiveIn(score, "chi2_per_dof")};
}

/// After the scores: without errors on held-out parts, a ratio of them means nothing.
void ReadGain(const Json& json, DiagnosedResult& result) {
  const bool measured = !result.base.heldout_rms.empty() && !result.extended.heldout_rms.empty();
  const Json& gain = Member(json, measured ? "gain" : "");
  result.heldout_error_ratio = NumberIn(gain, "heldout_error_ratio");
  result.tip_error_ratio = NumberIn(gain, "tip_error_ratio");
  const auto interval = NumberOrList(Member(gain, "heldout_error_ratio_interval"));
  if (interval.size() == 2) result.heldout_error_interval.emplace(interval[0], interval[1]);
  const Json& loop = Member(json, "closed_loop");
  if (loop.empty()) return;
  const Json &before = Member(loop, "before"), &after = Member(loop, "after");
  result.closed_loop = DiagnosedLoop{.controller = TextIn(loop, "controller"),
                                     .max_before_m = NumberIn(before, "max_deviation_m"),
                                     .max_after_m = NumberIn(after, "max_deviation_m"),
                                     .rms_before_m = NumberIn(before, "rms_deviation_m"),
                                     .rms_after_m = NumberIn(after, "rms_deviation_m"),
                                     .joints = {},
                                     .notes = TextsIn(loop, "notes")};
  for (const Json& joint : Member(loop, "joints")) {
    result.closed_loop->joints.push_back({.component = TextIn(joint, "component"),
                                          .rms_before = NumberIn(joint, "rms_before"),
                                          .rms_after = NumberIn(joint, "rms_after"),
                                          .max_before = NumberIn(joint, "max_before"),
                                          .max_after = NumberIn(joint, "max_after")});
  }
}

void ReadVerdict(const Json& json, DiagnosedResult& result) {
  result.verdicts = TextsIn(json, "verdicts");
  if (result.verdicts.empty()) result.verdicts = {json.at("verdict").get<std::string>()};
  result.probabilities = RankedIn(json, "probabilities");
  result.presence = RankedIn(json, "presence");
  for (const auto& hypothesis : Member(json, "credible_set_90")) {
    result.credible_set.push_back(hypothesis.is_string()
                                      ? hypothesis.get<std::string>()
                                      : JoinedEffects(hypothesis.get<std::vector<std::string>>()));
  }
  for (const auto& group : Member(json, "indistinguishable")) {
    result.indistinguishable.push_back(group.get<std::vector<std::string>>());
  }
  result.separating_motion = TextIn(json, "separating_motion");
  if (const auto score = json.find("separating_motion_score");
      score != json.end() && score->is_number())
    result.separating_score = score->get<double>();
  if (const auto plan = json.find("planned_motion"); plan != json.end())
    result.planned_motion = TextIn(*plan, "text");
}

DiagnosedTermName TermNameIn(const Json& json) {
  return {TextIn(json, "channel"), TextIn(json, "form"), TextsIn(json, "depends_on")};
}

std::vector<DiagnosedTerm> DiscoveredIn(const Json& json) {
  std::vector<DiagnosedTerm> terms;
  for (const auto& found : Member(json, "discovered")) {
    DiagnosedTerm term{.name = TermNameIn(found), .text = TextIn(found, "text")};
    for (const auto& [name, stated] : Member(found, "parameters").items())
      term.parameters.push_back({.name = name,
                                 .value = NumberOrList(Member(stated, "value")),
                                 .sd = NumberOrList(Member(stated, "sd"))});
    term.false_discovery = NumberIn(found, "false_discovery").value_or(1.0);
    term.heldout_error_ratio = NumberIn(Member(found, "gain"), "heldout_error_ratio");
    const Json& region = Member(found, "region");
    term.part_of_samples = NumberIn(region, "part_of_samples").value_or(0.0);
    term.depth_m = NumberOrList(Member(region, "insertion_depth_m"));
    for (const auto& other : Member(found, "could_be")) term.could_be.push_back(TermNameIn(other));
    terms.push_back(std::move(term));
  }
  return terms;
}

void ReadSignatures(const Json& json, DiagnosedResult& result) {
  for (const auto& s : Member(json, "residual_signature")) {
    result.signatures.push_back({s.at("channel"), s.at("against"), s.at("score")});
  }
  std::stable_sort(result.signatures.begin(), result.signatures.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
}

}  // namespace

std::string JoinedEffects(std::vector<std::string> parts) {
  std::sort(parts.begin(), parts.end());
  std::string joined;
  for (const auto& part : parts) joined += joined.empty() ? part : "+" + part;
  return joined;
}

std::optional<double> DiagnosedParameter::TolerancesOff(std::size_t i) const {
  if (tolerance.empty() || !(tolerance[i] > 0.0)) return std::nullopt;
  return std::abs(value[i] - nominal[i]) / tolerance[i];
}

bool DiagnosedResult::Is(const std::string& answer) const {
  return verdicts.size() == 1 && verdicts.front() == answer;
}

double DiagnosedResult::Probability(const std::vector<std::string>& effects) const {
  const std::string wanted = JoinedEffects(effects);
  for (const auto& [name, p] : probabilities) {
    if (JoinedEffects(Split(name)) == wanted) return p;
  }
  return 0.0;
}

std::vector<std::vector<std::string>> DiagnosedResult::Equivalents() const {
  std::vector<std::vector<std::string>> sets{{}};
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    std::vector<std::string> group{verdicts[i]};
    if (i < indistinguishable.size()) {
      for (const auto& name : indistinguishable[i]) {
        if (std::find(group.begin(), group.end(), name) == group.end()) group.push_back(name);
      }
    }
    std::vector<std::vector<std::string>> longer;
    for (const auto& set : sets) {
      for (const auto& name : group) {
        auto next = set;
        for (auto& part : Split(name)) next.push_back(std::move(part));
        longer.push_back(std::move(next));
      }
    }
    sets = std::move(longer);
  }
  return sets;
}

double DiagnosedResult::VerdictProbability() const {
  std::map<std::string, double> each;  // two combinations may be the same hypothesis
  for (const auto& set : Equivalents()) each[JoinedEffects(set)] = Probability(set);
  double sum = 0.0;
  for (const auto& [name, p] : each) sum += p;
  return std::min(sum, 1.0);
}

DiagnosedResult ReadDiagnosedResult(const std::filesystem::path& path) {
  try {
    const Json json = ReadObject(path);
    DiagnosedResult result;
    ReadVerdict(json, result);
    result.parameters = ParametersIn(json, "parameters");
    result.within_tolerance = ParametersIn(json, "within_tolerance");
    result.base = ScoreIn(json, "base");
    result.extended = ScoreIn(json, "extended");
    ReadGain(json, result);
    ReadSignatures(json, result);
    result.discovered = DiscoveredIn(json);
    result.adequate = json.value("adequate", true);
    result.noise_scale = MapIn<double>(json, "noise_scale");
    result.noise_sd = MapIn<double>(json, "noise_sd");
    result.summaries = MapIn<std::string>(json, "summaries");
    result.catalogue = TextsIn(json, "catalogue");
    for (const auto& [effect, summary] : result.summaries) {
      if (!json.contains("catalogue")) result.catalogue.push_back(effect);
    }
    result.warnings = TextsIn(json, "warnings");
    for (const char* key : {"samples", "failed_samples", "fits"}) {
      if (const auto count = NumberIn(json, key)) result.counts.emplace_back(key, *count);
    }
    return result;
  } catch (const Json::exception&) {
    throw InputError::At(path.string(), 0, "is damaged, expected a diagnosis.json");
  }
}

RunSummary ReadRunSummary(const std::filesystem::path& path) {
  try {
    const Json json = ReadObject(path);
    RunSummary summary{.command = TextIn(json, "command"), .version = TextIn(json, "version")};
    summary.warnings = TextsIn(json, "warnings");
    for (const auto& [key, value] : json.items()) {
      if (value.is_number())
        summary.figures.emplace_back(Label(key), SpokenValue(key, value.get<double>()));
      if (value.is_boolean())
        summary.figures.emplace_back(Label(key), value.get<bool>() ? "yes" : "no");
    }
    return summary;
  } catch (const Json::exception&) {
    throw InputError::At(path.string(), 0, "is damaged, expected the summary of a command");
  }
}

}  // namespace flextip::report
