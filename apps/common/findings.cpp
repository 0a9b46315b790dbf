#include "apps/common/findings.h"

#include <fmt/format.h>

namespace flextip {

std::string FindingText(const std::string& label, const plausibility::Finding& finding) {
  std::string text = fmt::format("{}: {} [{}]\n", label, finding.text, finding.id);
  if (!finding.mend.empty()) text += fmt::format("  mend: {}\n", finding.mend);
  return text;
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
