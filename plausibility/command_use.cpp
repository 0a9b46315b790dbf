#include "plausibility/command_use.h"

#include <fmt/format.h>

namespace flextip::plausibility {
namespace {

bool Holds(const Subjects& subjects, const Finding& finding) {
  return subjects.contains(finding.id) || subjects.contains(finding.Subject());
}

}  // namespace

FindingsForUse SortForUse(const std::vector<Finding>& findings, const CommandUse& use) {
  FindingsForUse sorted;
  for (Finding f : findings) {
    const bool wrong = f.severity == Severity::kWrong;
    if (Holds(use.needs, f)) {
      (wrong ? sorted.needed : sorted.beware).push_back(std::move(f));
    } else if (Holds(use.helped_by, f)) {
      if (wrong) {
        sorted.left_out.insert(f.Subject());
        f.text += fmt::format("; {} is left out here", f.Subject());
        f.severity = Severity::kDoubtful;
      }
      sorted.beware.push_back(std::move(f));
    } else if (wrong) {
      f.text += fmt::format("; flextip {} does not use it", use.command);
      f.severity = Severity::kDoubtful;
      sorted.beware.push_back(std::move(f));
    }
  }
  return sorted;
}

void LeaveOut(const Subjects& streams, Recording& recording) {
  if (streams.contains("command0")) recording.command0.reset();
  if (streams.contains("em0")) recording.em0.reset();
  if (streams.contains("em1")) recording.em1.reset();
  if (streams.contains("strain0")) recording.strain0.reset();
  if (streams.contains("load0")) recording.load0.reset();
  if (streams.contains("vision0")) recording.vision0.reset();
}

}  // namespace flextip::plausibility
