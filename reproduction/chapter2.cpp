#include "reproduction/ch2_parts.h"
#include "reproduction/chapter.h"

namespace flextip {

ChapterResult ReproduceChapter2(const ReproduceOptions& options, const ChapterProgress& progress) {
  return InParts({{Ch2Maps, 0.5}, {Ch2Trajectories, 0.5}}, options, progress);
}

}  // namespace flextip
