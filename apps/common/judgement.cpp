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

void PrintNext(const std::string& next, const std::string& command) {
  if (!next.empty()) fmt::print("Next: {}\n", next);
  if (!command.empty()) fmt::print("  {}\n", command);
}

void PrintJudgement(const Judgement& judged, const CommandPaths& paths, bool quiet) {
  if (quiet || judged.grade == Grade::kNotFound) return;
  fmt::print("{}\n", judged.says);
  for (const auto& reason : judged.reasons) {
    if (judged.grade == Grade::kBeware) fmt::print(stderr, "flextip: beware: {}\n", reason);
  }
  PrintNext(judged.next, paths.Fill(judged.command));
}

void RequireFound(const Judgement& judged, const CommandPaths& paths) {
  if (judged.grade != Grade::kNotFound) return;
  std::string text = judged.says;
  if (!judged.next.empty()) text += " Next: " + judged.next + ".";
  if (!judged.command.empty()) text += " (" + paths.Fill(judged.command) + ")";
  throw WorkError(fmt::format("{} Details: {}", text, (paths.result / "report.html").string()));
}

}  // namespace flextip
