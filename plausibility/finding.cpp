#include "plausibility/finding.h"

#include <set>
#include <utility>

namespace flextip::plausibility {

const char* Name(Severity severity) { return severity == Severity::kWrong ? "wrong" : "doubtful"; }

void SortFindings(std::vector<Finding>& findings) {
  std::set<std::string> seen;
  std::vector<Finding> sorted;
  for (const Severity severity : {Severity::kWrong, Severity::kDoubtful}) {
    for (Finding& f : findings) {
      if (f.severity == severity && seen.insert(f.id).second) sorted.push_back(std::move(f));
    }
  }
  findings = std::move(sorted);
}

}  // namespace flextip::plausibility
