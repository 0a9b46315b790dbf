#include "diagnosis/replay/sample_loops.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

namespace flextip::diagnosis {

void ForChunks(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work) {
  constexpr std::size_t kChunk = 64;
  const std::size_t chunks = (count + kChunk - 1) / kChunk;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chunks, 1), [&](const auto& range) {
    for (std::size_t c = range.begin(); c < range.end(); ++c)
      work(c * kChunk, std::min(count, (c + 1) * kChunk));
  });
}

std::vector<int> UsedRows(const DiagnosisSample& sample, const std::bitset<row::kCount>& wanted) {
  std::vector<int> rows;
  for (int r = 0; r < row::kCount; ++r)
    if (sample.present[r] && wanted[r]) rows.push_back(r);
  return rows;
}

}  // namespace flextip::diagnosis
