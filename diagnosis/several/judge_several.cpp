#include <fmt/format.h>

#include "diagnosis/judge_diagnosis.h"
#include "diagnosis/several/diagnose_several.h"

namespace flextip::diagnosis {

namespace {

/// No recording makes an answer certain.
std::string Likely(double probability) {
  return probability > 0.99 ? std::string("over 99 %")
                            : fmt::format("{:.0f} %", 100.0 * probability);
}

}  // namespace

Judgement JudgeSeveral(const SeveralResult& several) {
  Judgement judged = JudgeDiagnosis(several.common);
  if (judged.grade == Grade::kNotFound) return judged;
  judged.says = fmt::format("In all {} recordings: {}", several.names.size(), judged.says);
  for (const FoundChange& change : several.changes) {
    judged.says += fmt::format(" {} began in {} ({}).", change.effect,
                               several.names[change.first_in], Likely(change.probability));
  }
  if (several.changes.empty()) return judged;
  const FoundChange& first = several.changes.front();
  judged.next = fmt::format("see what happened between {} and {}",
                            several.names[first.first_in - 1], several.names[first.first_in]);
  judged.command = "";
  return judged;
}

}  // namespace flextip::diagnosis
