#include "apps/common/input/findings.h"

#include <fmt/format.h>

namespace flextip {

std::string FindingText(const std::string& label, const plausibility::Finding& finding) {
  std::string text = fmt::format("{}: {} [{}]\n", label, finding.text, finding.id);
  if (!finding.mend.empty()) text += fmt::format("  mend: {}\n", finding.mend);
  return text;
}

void MentionFindings(const std::vector<plausibility::Finding>& findings, Judgement& judged) {
  if (findings.empty()) return;
  std::string ids;
  for (const plausibility::Finding& f : findings) ids += (ids.empty() ? "" : ", ") + f.id;
  judged.Beware(fmt::format("the check of the recording found doubtful: {}", ids));
}

nlohmann::json FindingsJson(const std::vector<plausibility::Finding>& findings) {
  nlohmann::json list = nlohmann::json::array();
  for (const plausibility::Finding& f : findings) {
    list.push_back(
        {{"finding", f.id}, {"severity", Name(f.severity)}, {"text", f.text}, {"mend", f.mend}});
  }
  return list;
}

}  // namespace flextip
