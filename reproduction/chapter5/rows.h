// The user study's numbers beside the thesis's, and its figures. Private to reproduction.
#pragma once

#include <vector>

#include "reproduction/chapter.h"
#include "reproduction/chapter5/study.h"

namespace flextip::reproduction {

/// 5.3: time, depth, swept and outline area of the thesis's four controllers, with p-values.
std::vector<TableRow> ThesisRows(const std::vector<GroupResult>& results);
/// 5.4: how much each improvement takes away.
std::vector<TableRow> ReductionRows(const std::vector<GroupResult>& results);
/// Flexion and forces; ours; vision; the tissue's response.
std::vector<TableRow> OursRows(const std::vector<GroupResult>& results);
/// What moves the numbers toward the thesis's.
std::vector<TableRow> VariationRows(const std::vector<GroupResult>& results);
/// Holding still (5.2.6).
TableRow HoldRow(const ReproduceOptions& options);

/// Figs. 5.6 to 5.9, sensing and update rates.
std::vector<report::Figure> StudyFigures(const std::vector<GroupResult>& results);

}  // namespace flextip::reproduction
