#include "arms/diagnose/model_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "arms/effects/effects.h"
#include "core/error.h"
#include "recording/text/text.h"
#include "recording/text/yaml_map.h"

namespace flextip::arms {
namespace {

using diagnosis::EffectFit;
using diagnosis::ReportedParameter;

constexpr int kArmModelVersion = 1;

std::string ListText(const std::vector<double>& values) {
  return values.size() == 1 ? YamlNumber(values[0]) : YamlNumbers(values);
}

std::string SectionText(const std::string& name, const std::vector<EffectFit>& effects,
                        std::vector<double> ReportedParameter::*what) {
  if (effects.empty()) return name + ": {}\n";
  std::string text = name + ":\n";
  for (const EffectFit& fit : effects) {
    std::string parameters;
    for (const ReportedParameter& p : fit.parameters) {
      if (!parameters.empty()) parameters += ", ";
      parameters += p.name + ": " + ListText(p.*what);
    }
    text += "  " + fit.effect + ": {" + parameters + "}\n";
  }
  return text;
}

/// The names of all effects, or of all nuisances.
std::set<std::string> Names(bool nuisances) {
  Arm arm;
  arm.payload_places.resize(1);  // without a place there is no payload
  std::set<std::string> names;
  const Effects all = nuisances ? MakeNuisances() : MakeEffects(arm);
  for (const auto& effect : all) names.insert(effect->Name());
  return names;
}

/// Other names could be read, and not be written so that they are read again.
bool IsParameterName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_';
  });
}

std::vector<EffectFit> ReadSection(const YamlMap& top, const std::string& key, bool nuisances) {
  std::vector<EffectFit> effects;
  if (!top.Has(key)) return effects;
  const YamlMap section = top.Map(key);
  const std::set<std::string> known = Names(nuisances);
  for (const std::string& name : section.Keys()) {
    if (!known.contains(name))
      throw section.Error(name, fmt::format("found {}, which is unknown", Quoted(name)));
    EffectFit fit{name, {}};
    const YamlMap map = section.Map(name);
    for (const std::string& parameter : map.Keys()) {
      if (!IsParameterName(parameter))
        throw map.Error(parameter, "expected a name of letters, digits and _");
      const auto values = map.IsList(parameter) ? map.Numbers(parameter)
                                                : std::vector<double>{map.Number(parameter)};
      fit.parameters.push_back({parameter, values, std::vector<double>(values.size(), 0.0)});
    }
    effects.push_back(std::move(fit));
  }
  return effects;
}

/// Gives the parameters their deviations, where there are as many.
void TakeDeviations(const std::vector<EffectFit>& sd, std::vector<EffectFit>& fits) {
  for (EffectFit& fit : fits) {
    for (const EffectFit& of : sd) {
      if (of.effect != fit.effect) continue;
      for (ReportedParameter& p : fit.parameters)
        for (const ReportedParameter& q : of.parameters)
          if (p.name == q.name && p.value.size() == q.value.size()) p.sd = q.value;
    }
  }
}

}  // namespace

std::string ArmModelYaml(const ArmModel& model) {
  std::string text = fmt::format("format: {}\nversion: {}\n", kArmModelFormat, kArmModelVersion);
  text += SectionText("effects", model.effects, &ReportedParameter::value);
  text += SectionText("within_tolerance", model.within_tolerance, &ReportedParameter::value);
  std::vector<EffectFit> all = model.effects;
  all.insert(all.end(), model.within_tolerance.begin(), model.within_tolerance.end());
  text += SectionText("sd", all, &ReportedParameter::sd);
  text += SectionText("nuisances", model.nuisances, &ReportedParameter::value);
  text += SectionText("base_nuisances", model.base_nuisances, &ReportedParameter::value);
  return text;
}

bool IsArmModel(const std::filesystem::path& file) {
  const YamlMap top = YamlMap::Load(file);
  return top.Has("format") && top.Text("format") == kArmModelFormat;
}

ArmModel ReadArmModel(const std::filesystem::path& file) {
  const YamlMap top = YamlMap::Load(file);
  if (const std::string format = top.Text("format"); format != kArmModelFormat) {
    throw top.Error("format",
                    fmt::format("found {}, expected {}", Quoted(format), kArmModelFormat));
  }
  if (const auto version = top.Integer("version"); version != kArmModelVersion)
    throw top.Error("version", fmt::format("found {}, expected {}", version, kArmModelVersion));
  ArmModel model{ReadSection(top, "effects", false), ReadSection(top, "within_tolerance", false),
                 ReadSection(top, "nuisances", true), ReadSection(top, "base_nuisances", true)};
  const std::vector<EffectFit> sd = ReadSection(top, "sd", false);
  for (auto* section : {&model.effects, &model.within_tolerance}) TakeDeviations(sd, *section);
  top.RefuseUnknown();
  return model;
}

}  // namespace flextip::arms
