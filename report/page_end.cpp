#include "report/page_end.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "report/labels.h"
#include "report/report.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

using Json = nlohmann::json;

std::string TextAt(const Json& json, const char* key) {
  return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : "";
}

std::string Line(const char* name, const std::string& value) {
  if (value.empty()) return "";
  return fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, EscapeHtml(value));
}

/// "2026-11-23T18:50:07Z" as "2026-11-23 18:50 UTC".
std::string DateWords(const std::string& date) {
  constexpr std::size_t kMinutes = 16;
  if (date.size() < kMinutes) return date;
  return fmt::format("{} {} UTC", date.substr(0, 10), date.substr(11, 5));
}

}  // namespace

std::string PageEnd(const std::filesystem::path& folder) {
  const auto file = folder / "summary.json";
  const Json summary = Json::parse(ReadBytes(file), nullptr, false);
  if (!summary.is_object()) throw InputError::At(file.string(), 0, "not an object");
  std::string inputs;
  for (const auto& input : summary.value("inputs", Json::array())) {
    if (!input.is_string() || input.get<std::string>().empty()) continue;
    inputs += (inputs.empty() ? "" : ", ") + input.get<std::string>();
  }
  std::string lines = Line("command", TextAt(summary, "typed")) + Line("input", inputs) +
                      Line("date", DateWords(TextAt(summary, "date")));
  if (summary.contains("seconds") && summary["seconds"].is_number()) {
    lines += Line("took", SpokenValue("seconds", summary["seconds"].get<double>()));
  }
  const std::string version = TextAt(summary, "version");
  if (!version.empty()) lines += Line("version", "flextip " + version);
  return lines.empty() ? "" : "<dl>\n" + lines + "</dl>\n";
}

}  // namespace flextip::report
