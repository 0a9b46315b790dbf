#include "reproduction/chapter.h"
#include "reproduction/chapter2/parts.h"

namespace flextip::reproduction {

ChapterResult ReproduceChapter2(const ReproduceOptions& options, const ChapterProgress& progress) {
  return InParts({{Ch2Maps, 0.5}, {Ch2Trajectories, 0.5}}, options, progress);
}

}  // namespace flextip::reproduction
