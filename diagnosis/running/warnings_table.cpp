#include "diagnosis/running/warnings_table.h"

#include "diagnosis/effects/watched.h"
#include "diagnosis/running/running_diagnosis.h"
#include "recording/text/csv.h"

namespace flextip::diagnosis {
namespace {

void AddSized(const SizedCause& sized, CsvWriter& rows) {
  const bool is_there = sized.cause >= 0;
  rows.Add(is_there ? CauseName(sized.cause) : "");
  if (is_there && sized.cause != kUnknownCause) {
    rows.Add(sized.value).Add(sized.sd);
  } else {
    rows.Add(std::string()).Add(std::string());
  }
}

}  // namespace

std::string WarningsCsv(std::span<const Warning> warnings) {
  CsvWriter rows({"timestamp [ns]", "cause []", "value [SI]", "sd [SI]", "or []", "or_value [SI]",
                  "or_sd [SI]", "or_others []", "since [ns]", "log_evidence []", "text []"});
  for (const Warning& warning : warnings) {
    const FoundCause& cause = warning.cause;
    rows.Add(warning.t_ns);
    AddSized(cause.likeliest, rows);
    AddSized(cause.other, rows);
    rows.Add(std::int64_t(cause.has_more));
    // 0: it was there from the start.
    rows.Add(cause.since_ns).Add(cause.log_evidence).Add(Text(cause));
    rows.EndRow();
  }
  return rows.text();
}

}  // namespace flextip::diagnosis
