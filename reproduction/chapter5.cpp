#include "reproduction/ch5_parts.h"
#include "reproduction/chapter.h"

namespace flextip {

ChapterResult ReproduceChapter5(const ReproduceOptions& options, const ChapterProgress& progress) {
  return InParts({{Ch5Operators, 0.8}, {Ch5Sensors, 0.2}}, options, progress);
}

}  // namespace flextip
