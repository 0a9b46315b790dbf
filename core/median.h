// The middle of some numbers: what most of them say, whatever a few do.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <vector>

namespace flextip {

/// The median of `values`, of an even number of them the larger of the two in the middle; 0 where
/// there are none.
template <class T>
T Median(std::vector<T> values) {
  if (values.empty()) return T{};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace flextip
