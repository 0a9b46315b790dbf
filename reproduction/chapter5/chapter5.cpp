#include "reproduction/chapter.h"
#include "reproduction/chapter5/parts.h"

namespace flextip::reproduction {

ChapterResult ReproduceChapter5(const ReproduceOptions& options, const ChapterProgress& progress) {
  return InParts({{Ch5Operators, 0.8}, {Ch5Sensors, 0.2}}, options, progress);
}

}  // namespace flextip::reproduction
