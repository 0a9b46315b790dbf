// The user study done again with simulated operators (5.2.6 to 5.4).
#include <algorithm>
#include <iterator>

#include "reproduction/chapter5/groups.h"
#include "reproduction/chapter5/parts.h"
#include "reproduction/chapter5/rows.h"

namespace flextip::reproduction {

ChapterResult Ch5Operators(const ReproduceOptions& options, const ChapterProgress& progress) {
  const auto results = RunStudy(StudyGroups(options.quick), options.seed, progress);
  ChapterResult chapter;
  chapter.rows.push_back(HoldRow(options));
  for (const auto& rows :
       {ThesisRows(results), ReductionRows(results), OursRows(results), VariationRows(results)}) {
    std::copy(rows.begin(), rows.end(), std::back_inserter(chapter.rows));
  }
  chapter.figures = StudyFigures(results);
  return chapter;
}

}  // namespace flextip::reproduction
