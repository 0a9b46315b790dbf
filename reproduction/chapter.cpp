#include "reproduction/chapter.h"

#include <iterator>

namespace flextip::reproduction {

ChapterResult InParts(const std::vector<ChapterPart>& parts, const ReproduceOptions& options,
                      const ChapterProgress& progress) {
  ChapterResult all;
  double done = 0.0;
  for (const auto& part : parts) {
    ChapterResult of_part =
        part.run(options, [&](double of_it) { progress(done + part.share * of_it); });
    std::move(of_part.rows.begin(), of_part.rows.end(), std::back_inserter(all.rows));
    std::move(of_part.figures.begin(), of_part.figures.end(), std::back_inserter(all.figures));
    done += part.share;
  }
  return all;
}

}  // namespace flextip::reproduction
