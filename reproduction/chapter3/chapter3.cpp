#include "reproduction/chapter3/parts.h"

namespace flextip::reproduction {

ChapterResult ReproduceChapter3(const ReproduceOptions& options, const ChapterProgress& progress) {
  return InParts(
      {{Ch3Straight, 0.1}, {Ch3Sensitivity, 0.5}, {Ch3Tracker, 0.2}, {Ch3Direction, 0.2}}, options,
      progress);
}

}  // namespace flextip::reproduction
