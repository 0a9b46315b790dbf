// Numbers of a summary.json for sentences.
#pragma once

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "core/judgement.h"
#include "report/labels.h"

namespace flextip::report::leads {

using Json = nlohmann::ordered_json;

/// Zero where there is no such number.
inline double Number(const Json& json, const char* key) {
  const auto it = json.find(key);
  return it != json.end() && it->is_number() ? it->get<double>() : 0.0;
}

inline bool Has(const Json& json, const char* key) {
  return json.contains(key) && json[key].is_number();
}

/// With the unit people read.
inline std::string Value(const Json& json, const char* key) {
  return SpokenValue(key, Number(json, key));
}

inline std::string Count(const Json& json, const char* key) {
  return fmt::format("{:.0f}", Number(json, key));
}

inline const std::string kGood = Name(Grade::kGood), kBeware = Name(Grade::kBeware),
                         kNotFound = Name(Grade::kNotFound);

}  // namespace flextip::report::leads
