#include "report/compare/summary_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostWords = 12;  // of a list; longer ones are tables of their own

bool IsOfTheRun(const std::string& key) {
  static const std::set<std::string> keys{"command", "version", "date",     "typed",
                                          "output",  "inputs",  "warnings", "findings"};
  return keys.contains(key);
}

std::string TextOf(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

void AddVerdict(const Json& verdict, std::vector<SummaryValue>& values) {
  if (verdict.contains("grade")) values.push_back({"", "grade", TextOf(verdict["grade"]), {}});
  if (verdict.contains("says")) values.push_back({"", "answer", TextOf(verdict["says"]), {}});
}

void AddList(const Json& list, SummaryValue value, std::vector<SummaryValue>& values) {
  if (list.size() > kMostWords) return;
  if (std::any_of(list.begin(), list.end(), [](const Json& e) { return e.is_structured(); }))
    return;
  for (const Json& entry : list) {
    if (!value.text.empty()) value.text += '+';
    value.text += TextOf(entry);
  }
  values.push_back(std::move(value));
}

void AddObject(const Json& object, const std::string& group, std::vector<SummaryValue>& values) {
  for (const auto& [key, value] : object.items()) {
    if (group.empty() && IsOfTheRun(key)) continue;
    if (key == "verdict" && value.is_object()) {
      if (group.empty()) AddVerdict(value, values);
    } else if (value.is_number()) {
      values.push_back({group, key, value.dump(), value.get<double>()});
    } else if (value.is_string() || value.is_boolean()) {
      values.push_back({group, key, TextOf(value), {}});
    } else if (value.is_array()) {
      AddList(value, {group, key, "", {}}, values);
    } else if (value.is_object()) {
      const bool list = key == "controllers" || key == "statuses";
      std::string inner = group;
      if (!list) inner += (group.empty() ? "" : " ") + key;
      AddObject(value, inner, values);
    }
  }
}

}  // namespace

std::vector<SummaryValue> ValuesOf(const std::filesystem::path& folder) {
  const auto file = folder / "summary.json";
  const Json summary = Json::parse(ReadBytes(file), nullptr, false);
  if (!summary.is_object()) throw InputError::At(file.string(), 0, "not an object");
  std::vector<SummaryValue> values;
  if (summary.contains("verdict") && summary["verdict"].is_object()) {
    AddVerdict(summary["verdict"], values);
  }
  std::vector<SummaryValue> others;
  AddObject(summary, "", others);
  std::erase_if(others, [](const SummaryValue& v) {
    return v.group.empty() && (v.key == "grade" || v.key == "answer");
  });
  values.insert(values.end(), others.begin(), others.end());
  return values;
}

}  // namespace flextip::report
