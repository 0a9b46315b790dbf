#include "reproduction/chapter.h"

namespace flextip {

ChapterResult ReproduceChapter4(const ReproduceOptions& /*options*/,
                                const ChapterProgress& progress) {
  progress(1.0);
  return {};
}

}  // namespace flextip
