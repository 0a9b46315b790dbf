// A batch's results: a row an item, and what is written beside the rows.
#pragma once

#include <string>

#include "apps/batch/folder.h"
#include "core/judgement.h"

namespace flextip {

/// Writes OUT/table.csv, figures.json, summary.json and report.html from the records and the items'
/// summaries. Returns how many items are not ok. Throws WorkError where the disk refuses.
std::size_t WriteBatchResults(const BatchPlan& plan, BatchFolder& folder, const std::string& list);

}  // namespace flextip
