#include "diagnosis/model/extended_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "diagnosis/model/discovered_terms.h"
#include "diagnosis/model/extended_effect.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip::diagnosis {
namespace {

constexpr const char* kFormat = "flextip-model";
constexpr int kVersion = 1;
constexpr const char* kSensorSection = "within_tolerance_covariance";

std::string Numbers(const std::vector<double>& values) {
  return values.size() == 1 ? YamlNumber(values[0]) : YamlNumbers(values);
}

/// A section's lines: an effect each, its parameters' values or standard deviations.
std::string Section(const std::string& name, const std::vector<EffectFit>& effects,
                    std::vector<double> ReportedParameter::*what) {
  if (effects.empty()) return name + ": {}\n";
  std::string text = name + ":\n";
  for (const EffectFit& fit : effects) {
    std::string parameters;
    for (const ReportedParameter& parameter : fit.parameters) {
      if (!parameters.empty()) parameters += ", ";
      parameters += parameter.name + ": " + Numbers(parameter.*what);
    }
    text += "  " + fit.effect + ": {" + parameters + "}\n";
  }
  return text;
}

std::string Covariance(const std::string& section, const std::vector<EffectFit>& effects,
                       const Eigen::MatrixXd& C) {
  std::string names;
  for (const std::string& name : NumberNames(effects)) {
    names += (names.empty() ? "" : ", ") + YamlText(name);
  }
  std::vector<double> data;
  for (Eigen::Index i = 0; i < C.rows(); ++i)
    for (Eigen::Index j = 0; j < C.cols(); ++j) data.push_back(C(i, j));
  return fmt::format("{}:\n  parameters: [{}]\n  data: {}\n", section, names, YamlNumbers(data));
}

/// The effects within tolerance of which the model has a joint covariance, in its order.
std::vector<EffectFit> SensorsOf(const ExtendedModel& model) {
  std::vector<EffectFit> sensors;
  for (const std::string& name : model.sensor_tolerance.effects)
    for (const EffectFit& fit : model.within_tolerance)
      if (fit.effect == name) sensors.push_back(fit);
  return sensors;
}

std::vector<double> ReadValues(const YamlMap& map, const std::string& key, std::size_t count) {
  if (count == 1 && !map.IsList(key)) return {map.Number(key)};
  return map.Numbers(key, count);
}

/// One effect's mapping; standard deviations are read later.
EffectFit ReadEffect(const YamlMap& section, const std::string& name, const EffectMakers& own) {
  const auto effect = MakeEffectOfModel(name, own);
  if (!effect) throw section.Error(name, fmt::format("found effect '{}', which is unknown", name));
  const YamlMap map = section.Map(name);
  EffectFit fit{name, ParametersOf(*effect)};
  std::vector<std::vector<double>> values;
  for (ReportedParameter& parameter : fit.parameters) {
    if (map.Has(parameter.name) || !parameter.may_be_missing) {
      parameter.value = ReadValues(map, parameter.name, parameter.value.size());
    }
    values.push_back(parameter.value);
  }
  map.RefuseUnknown();
  const std::string wrong = effect->WhatIsWrong(values);
  if (!wrong.empty()) throw section.Error(name, wrong);
  return fit;
}

std::vector<EffectFit> ReadEffects(const YamlMap& top, const std::string& key,
                                   const EffectMakers& own) {
  const YamlMap section = top.Map(key);
  std::vector<EffectFit> effects;
  for (const std::string& name : section.Keys()) effects.push_back(ReadEffect(section, name, own));
  return effects;
}

void ReadDeviations(const YamlMap& section, std::vector<EffectFit>& effects) {
  for (EffectFit& fit : effects) {
    if (!section.Has(fit.effect)) continue;
    const YamlMap map = section.Map(fit.effect);
    for (ReportedParameter& parameter : fit.parameters) {
      if (!map.Has(parameter.name) && parameter.may_be_missing) {
        parameter.sd.assign(parameter.value.size(), 0.0);
        continue;
      }
      parameter.sd = ReadValues(map, parameter.name, parameter.value.size());
      for (const double sd : parameter.sd) {
        if (sd < 0) throw map.Error(parameter.name, fmt::format("found {}, expected >= 0", sd));
      }
    }
    map.RefuseUnknown();
  }
  section.RefuseUnknown();
}

/// Whether the covariance of `effects` may have rows of these names: all, or all but those of
/// parameters that may be missing.
bool AreRows(const std::vector<std::string>& found, const std::vector<EffectFit>& effects) {
  std::vector<EffectFit> least = effects;
  for (EffectFit& fit : least) {
    std::erase_if(fit.parameters,
                  [](const ReportedParameter& parameter) { return parameter.may_be_missing; });
  }
  const auto same = [&](const std::vector<std::string>& names) {
    return std::is_permutation(names.begin(), names.end(), found.begin(), found.end());
  };
  return same(NumberNames(effects)) || same(NumberNames(least));
}

/// In the order of `effects`, whatever the file's; rows that are missing are zero.
Eigen::MatrixXd ReadCovariance(const YamlMap& map, const std::vector<EffectFit>& effects) {
  const auto names = NumberNames(effects), found = map.Texts("parameters");
  if (!AreRows(found, effects)) {
    throw map.Error("parameters", fmt::format("found [{}], expected [{}]", fmt::join(found, ", "),
                                              fmt::join(names, ", ")));
  }
  const std::size_t n = found.size();
  const std::vector<double> data = map.Numbers("data");
  map.RefuseUnknown();
  if (data.empty()) return {};
  if (data.size() != n * n) {
    throw map.Error("data",
                    fmt::format("found {} numbers, expected {} (or none)", data.size(), n * n));
  }
  const auto place = [&](std::size_t i) {
    return std::find(names.begin(), names.end(), found[i]) - names.begin();
  };
  const auto size = static_cast<Eigen::Index>(names.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) covariance(place(i), place(j)) = data[n * i + j];
  return covariance;
}

/// The effects of "effect.parameter[i]", each once.
std::vector<std::string> EffectsNamed(const std::vector<std::string>& numbers) {
  std::vector<std::string> effects;
  for (const std::string& number : numbers) {
    const std::string effect = number.substr(0, number.find('.'));
    if (std::find(effects.begin(), effects.end(), effect) == effects.end())
      effects.push_back(effect);
  }
  return effects;
}

void CheckFormat(const YamlMap& top) {
  const std::string format = top.Text("format");
  if (format != kFormat) {
    throw top.Error("format", fmt::format("found '{}', expected {}", format, kFormat));
  }
  const auto version = top.Integer("version");
  if (version != kVersion) {
    throw top.Error("version", fmt::format("found {}, expected {}", version, kVersion));
  }
}

}  // namespace

const EffectFit* ExtendedModel::Find(const std::string& effect) const {
  for (const auto* list : {&effects, &within_tolerance})
    for (const EffectFit& fit : *list)
      if (fit.effect == effect) return &fit;
  return nullptr;
}

ExtendedModel FromResult(const DiagnosisResult& result) {
  std::vector<Term> terms;
  for (const Discovered& found : result.discovered) terms.push_back(found.term);
  return {result.parameters,       result.within_tolerance, std::move(terms), result.covariance,
          result.sensor_tolerance, result.centre_m,         result.start_ns};
}

std::vector<std::string> NumberNames(const std::vector<EffectFit>& effects) {
  std::vector<std::string> names;
  for (const EffectFit& fit : effects)
    for (const ReportedParameter& parameter : fit.parameters)
      for (std::size_t i = 0; i < parameter.value.size(); ++i)
        names.push_back(fmt::format("{}.{}[{}]", fit.effect, parameter.name, i));
  return names;
}

std::string ModelYaml(const ExtendedModel& model) {
  std::vector<EffectFit> with_sd;
  for (const auto* list : {&model.effects, &model.within_tolerance})
    for (const EffectFit& fit : *list)
      if (!fit.parameters.empty() && !fit.parameters[0].sd.empty()) with_sd.push_back(fit);
  std::string text = fmt::format("format: {}\nversion: {}\n", kFormat, kVersion);
  text += "centre_m: " + YamlNumbers({model.centre_m.begin(), model.centre_m.end()}) + "\n";
  text += fmt::format("start_ns: {}\n", model.start_ns);
  text += Section("effects", model.effects, &ReportedParameter::value);
  text += Section("within_tolerance", model.within_tolerance, &ReportedParameter::value);
  text += TermsYaml(model.discovered);
  text += Section("sd", with_sd, &ReportedParameter::sd);
  text += Covariance("covariance", model.effects, model.covariance);
  const std::vector<EffectFit> sensors = SensorsOf(model);
  if (sensors.empty()) return text;
  return text + Covariance(kSensorSection, sensors, model.sensor_tolerance.covariance);
}

void WriteModel(const std::filesystem::path& file, const ExtendedModel& model) {
  WriteTextFile(file, ModelYaml(model));
}

ExtendedModel ReadModel(const std::filesystem::path& file, const EffectMakers& own) {
  const YamlMap top = YamlMap::Load(file);
  CheckFormat(top);
  ExtendedModel model;
  model.centre_m = top.Vector3("centre_m");
  model.start_ns = top.Integer("start_ns");
  model.effects = ReadEffects(top, "effects", own);
  if (top.Has("within_tolerance"))
    model.within_tolerance = ReadEffects(top, "within_tolerance", own);
  for (const EffectFit& fit : model.within_tolerance) {
    if (model.Find(fit.effect) != &fit) {
      throw top.Map("within_tolerance").Error(fit.effect, "is among the effects too");
    }
  }
  if (top.Has("discovered")) model.discovered = ReadTerms(top);
  if (top.Has("sd")) {
    const YamlMap section = top.Map("sd");
    std::vector<EffectFit> all = model.effects;
    all.insert(all.end(), model.within_tolerance.begin(), model.within_tolerance.end());
    ReadDeviations(section, all);
    const auto beyond = static_cast<std::ptrdiff_t>(model.effects.size());
    model.effects.assign(all.begin(), all.begin() + beyond);
    model.within_tolerance.assign(all.begin() + beyond, all.end());
  }
  if (top.Has("covariance"))
    model.covariance = ReadCovariance(top.Map("covariance"), model.effects);
  if (top.Has(kSensorSection)) {
    const YamlMap section = top.Map(kSensorSection);
    model.sensor_tolerance.effects = EffectsNamed(section.Texts("parameters"));
    model.sensor_tolerance.covariance = ReadCovariance(section, SensorsOf(model));
  }
  top.RefuseUnknown();
  return model;
}

}  // namespace flextip::diagnosis
