#include "apps/common/next_step.h"

#include "apps/common/judgement.h"
#include "report/leads/leads.h"

namespace flextip {

void PrintNextOf(const std::filesystem::path& folder) {
  const report::Head head = report::leads::LeadOf(folder);
  PrintNext(head.next, head.command);
}

}  // namespace flextip
