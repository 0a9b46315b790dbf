#include "apps/common/judgement.h"

#include <fmt/format.h>

#include <cstdio>

#include "core/error.h"

namespace flextip {

nlohmann::json JudgementJson(const Judgement& judged) {
  return {{"grade", Name(judged.grade)},
          {"says", judged.says},
          {"reasons", judged.reasons},
          {"next", judged.next},
          {"command", judged.command}};
}

void PrintJudgement(const Judgement& judged, bool quiet) {
  if (quiet || judged.grade == Grade::kNotFound) return;
  fmt::print("{}\n", judged.says);
  for (const auto& reason : judged.reasons) {
    if (judged.grade == Grade::kBeware) fmt::print(stderr, "flextip: beware: {}\n", reason);
  }
  if (!judged.next.empty()) fmt::print("Next: {}\n", judged.next);
  if (!judged.command.empty()) fmt::print("  {}\n", judged.command);
}

void RequireFound(const Judgement& judged, const std::filesystem::path& out) {
  if (judged.grade != Grade::kNotFound) return;
  std::string text = judged.says;
  if (!judged.next.empty()) text += " Next: " + judged.next + ".";
  if (!judged.command.empty()) text += " (" + judged.command + ")";
  throw WorkError(fmt::format("{} Details: {}", text, (out / "report.html").string()));
}

}  // namespace flextip
