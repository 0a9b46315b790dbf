// Loops over a replay's samples.
#pragma once

#include <bitset>
#include <cstddef>
#include <functional>
#include <vector>

#include "diagnosis/samples/sample_set.h"

namespace flextip::diagnosis {

/// Calls `work(begin, end)` for all stretches of samples, in parallel; within one, each sample can
/// be solved from the last.
void ForChunks(std::size_t count, const std::function<void(std::size_t, std::size_t)>& work);

/// The rows that `sample` has and that are wanted.
std::vector<int> UsedRows(const DiagnosisSample& sample, const std::bitset<row::kCount>& wanted);

}  // namespace flextip::diagnosis
