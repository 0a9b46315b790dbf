#include "reproduction/ch4_parts.h"

namespace flextip {
ChapterResult Ch4Experiment(const ReproduceOptions& /*options*/, const ChapterProgress& progress) {
  progress(1.0);
  return {};
}
}  // namespace flextip
