// Numbers of a summary.json for sentences. `Json` is any type that reads as nlohmann's does.
#pragma once

#include <fmt/format.h>

#include <string>

#include "core/judgement.h"
#include "report/labels.h"

namespace flextip::report::leads {

/// Zero where there is no such number.
template <class Json>
double Number(const Json& json, const char* key) {
  const auto it = json.find(key);
  return it != json.end() && it->is_number() ? it->template get<double>() : 0.0;
}

template <class Json>
bool Has(const Json& json, const char* key) {
  return json.contains(key) && json[key].is_number();
}

/// With the unit people read.
template <class Json>
std::string Value(const Json& json, const char* key) {
  return SpokenValue(key, Number(json, key));
}

template <class Json>
std::string Count(const Json& json, const char* key) {
  return fmt::format("{:.0f}", Number(json, key));
}

inline const std::string kGood = Name(Grade::kGood), kBeware = Name(Grade::kBeware),
                         kNotFound = Name(Grade::kNotFound);

}  // namespace flextip::report::leads
