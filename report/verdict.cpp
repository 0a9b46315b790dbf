#include "report/verdict.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "report/report.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

std::string Text(const nlohmann::ordered_json& object, const char* key) {
  return object.contains(key) && object[key].is_string() ? object[key].get<std::string>() : "";
}

}  // namespace

std::string VerdictHtml(const std::filesystem::path& folder) {
  const auto file = folder / "summary.json";
  const auto summary = nlohmann::ordered_json::parse(ReadBytes(file), nullptr, false);
  if (!summary.is_object()) throw InputError::At(file.string(), 0, "not an object");
  if (!summary.contains("verdict") || !summary["verdict"].is_object()) return "";
  const auto& verdict = summary["verdict"];
  if (verdict.empty()) return "";
  const std::string grade = Text(verdict, "grade");
  std::string html =
      fmt::format("<section class=\"verdict {}\">\n<p class=\"says\">{}</p>\n",
                  grade == "good" ? "good" : "beware", EscapeHtml(Text(verdict, "says")));
  if (verdict.contains("reasons") && !verdict["reasons"].empty()) {
    html += "<ul class=\"reasons\">\n";
    for (const auto& reason : verdict["reasons"]) {
      html += fmt::format("<li>{}</li>\n", EscapeHtml(reason.get<std::string>()));
    }
    html += "</ul>\n";
  }
  const std::string next = Text(verdict, "next");
  if (!next.empty()) {
    html += fmt::format("<p class=\"advice\"><b>Next:</b> {}.</p>\n", EscapeHtml(next));
  }
  const std::string command = Text(verdict, "command");
  if (!command.empty()) html += fmt::format("<pre>{}</pre>\n", EscapeHtml(command));
  return html + "</section>\n";
}

}  // namespace flextip::report
