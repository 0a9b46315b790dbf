#include "reproduction/ch3_parts.h"

namespace flextip {

ChapterResult Ch3Direction(const ReproduceOptions& /*options*/, const ChapterProgress& progress) {
  progress(1.0);
  return {};
}

}  // namespace flextip
