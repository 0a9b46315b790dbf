#include "report/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "report/report.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

std::string VerdictText(const nlohmann::ordered_json& object, const char* key) {
  return object.contains(key) && object[key].is_string() ? object[key].get<std::string>() : "";
}

std::string Paragraph(const char* style, const std::string& text) {
  return text.empty() ? "" : fmt::format("<p class=\"{}\">{}</p>\n", style, EscapeHtml(text));
}

std::string List(const char* style, const std::vector<std::string>& items) {
  if (items.empty()) return "";
  std::string html = fmt::format("<ul class=\"{}\">\n", style);
  for (const auto& item : items) html += fmt::format("<li>{}</li>\n", EscapeHtml(item));
  return html + "</ul>\n";
}

}  // namespace

std::string HeadHtml(const Head& head) {
  if (head.says.empty()) return "";
  std::string style = head.grade;
  std::replace(style.begin(), style.end(), ' ', '-');
  std::string html =
      fmt::format("<section class=\"verdict{}{}\">\n", style.empty() ? "" : " ", EscapeHtml(style));
  if (!head.grade.empty()) {
    html += fmt::format("<p class=\"grade\"><span class=\"unseen\">Grade: </span>{}</p>\n",
                        EscapeHtml(head.grade));
  }
  html += Paragraph("says", head.says) + List("says", head.causes) + Paragraph("gains", head.more) +
          List("reasons", head.reasons) + Paragraph("advice", head.advice);
  if (!head.next.empty()) {
    html += fmt::format("<p class=\"advice\"><b>Next:</b> {}.</p>\n", EscapeHtml(head.next));
  }
  if (!head.command.empty()) html += fmt::format("<pre>{}</pre>\n", EscapeHtml(head.command));
  return html + "</section>\n";
}

Head VerdictOf(const std::filesystem::path& folder) {
  const auto file = folder / "summary.json";
  const auto summary = nlohmann::ordered_json::parse(ReadBytes(file), nullptr, false);
  if (!summary.is_object()) throw InputError::At(file.string(), 0, "not an object");
  if (!summary.contains("verdict") || !summary["verdict"].is_object()) return {};
  const auto& verdict = summary["verdict"];
  Head head{.grade = VerdictText(verdict, "grade"),
            .says = VerdictText(verdict, "says"),
            .next = VerdictText(verdict, "next"),
            .command = VerdictText(verdict, "command")};
  for (const auto& reason : verdict.value("reasons", nlohmann::ordered_json::array())) {
    if (reason.is_string()) head.reasons.push_back(reason.get<std::string>());
  }
  return head;
}

}  // namespace flextip::report
