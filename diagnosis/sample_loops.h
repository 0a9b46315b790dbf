// Loops over a replay's samples.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bitset>
#include <vector>

#include "diagnosis/sample_set.h"

namespace flextip {

/// Calls `work(begin, end)` for all stretches of samples, in parallel; within one, each sample can
/// be solved from the last.
template <class Work>
void ForChunks(std::size_t count, Work work) {
  constexpr std::size_t kChunk = 64;
  const std::size_t chunks = (count + kChunk - 1) / kChunk;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chunks, 1), [&](const auto& range) {
    for (std::size_t c = range.begin(); c < range.end(); ++c)
      work(c * kChunk, std::min(count, (c + 1) * kChunk));
  });
}

/// The rows that `sample` has and that are wanted.
inline std::vector<int> UsedRows(const DiagnosisSample& sample,
                                 const std::bitset<row::kCount>& wanted) {
  std::vector<int> rows;
  for (int r = 0; r < row::kCount; ++r)
    if (sample.present[r] && wanted[r]) rows.push_back(r);
  return rows;
}

}  // namespace flextip
