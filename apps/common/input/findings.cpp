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
  std::string wrong, doubtful;
  for (const plausibility::Finding& f : findings) {
    std::string& ids = f.severity == plausibility::Severity::kWrong ? wrong : doubtful;
    ids += (ids.empty() ? "" : ", ") + f.id;
  }
  if (!wrong.empty()) {
    judged.Beware("the recording does not look as it says, so this answer may be wrong: " + wrong);
    judged.next = "mend the recording as the check says, and do it again";
    judged.command = "flextip check RECORDING -o RESULT-check";
  }
  if (!doubtful.empty()) judged.Beware("the check of the recording found doubtful: " + doubtful);
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
