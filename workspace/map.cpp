#include "workspace/map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace flextip {
namespace {

/// Multiples of the spacing within `reach` of `middle`.
std::vector<double> Lines(double middle, double reach, double spacing) {
  std::vector<double> lines;
  const double first = std::ceil((middle - reach) / spacing);
  const double last = std::floor((middle + reach) / spacing);
  for (double i = first; i <= last; i += 1.0) lines.push_back(i * spacing);
  return lines;
}

struct Range {
  std::size_t first = 0, last = 0;  // last is not part of it
};

/// From the first to the last index for which `used` is true; all where there is none.
template <class Used>
Range UsedRange(std::size_t count, Used used) {
  Range range{.first = 0, .last = count};
  while (range.first < count && !used(range.first)) ++range.first;
  if (range.first == count) return {.first = 0, .last = count};
  while (!used(range.last - 1)) --range.last;
  return range;
}

template <int N>
void Trim(WorkspaceMap<N>& map) {
  const std::size_t rows_before = map.up_m.size(), columns_before = map.right_m.size();
  const auto in = [&](std::size_t r, std::size_t c) { return map.At(r, c).state.has_value(); };
  const Range rows = UsedRange(rows_before, [&](std::size_t r) {
    for (std::size_t c = 0; c < columns_before; ++c)
      if (in(r, c)) return true;
    return false;
  });
  const Range columns = UsedRange(columns_before, [&](std::size_t c) {
    for (std::size_t r = 0; r < rows_before; ++r)
      if (in(r, c)) return true;
    return false;
  });
  std::vector<PointMeasures<N>> kept;
  for (std::size_t r = rows.first; r < rows.last; ++r)
    for (std::size_t c = columns.first; c < columns.last; ++c) kept.push_back(map.At(r, c));
  map.points = std::move(kept);
  map.up_m = {map.up_m.begin() + std::ptrdiff_t(rows.first),
              map.up_m.begin() + std::ptrdiff_t(rows.last)};
  map.right_m = {map.right_m.begin() + std::ptrdiff_t(columns.first),
                 map.right_m.begin() + std::ptrdiff_t(columns.last)};
}

}  // namespace

template <int N>
VectorN<N> Slice<N>::Point(double right_m, double up_m) const {
  VectorN<N> p = VectorN<N>::Constant(offset_m);
  p[right] = right_m;
  p[up] = up_m;
  return p;
}

template <int N>
std::size_t WorkspaceMap<N>::Reached() const {
  return std::size_t(std::count_if(points.begin(), points.end(),
                                   [](const auto& point) { return point.state.has_value(); }));
}

template <int N>
WorkspaceMap<N> ComputeMap(const MapSetup<N>& setup, const Slice<N>& slice, double spacing_m) {
  assert(spacing_m > 0.0);
  WorkspaceMap<N> map{.slice = slice, .spacing_m = spacing_m};
  const double reach = setup.truth.shaft_m;
  map.right_m = Lines(setup.truth.p_port[slice.right], reach, spacing_m);
  map.up_m = Lines(setup.truth.p_port[slice.up], reach, spacing_m);
  map.points.resize(map.right_m.size() * map.up_m.size());
  tbb::parallel_for(std::size_t{0}, map.up_m.size(), [&](std::size_t r) {
    TrueShaft<N> shaft(setup.truth, setup.force);
    for (std::size_t c = 0; c < map.right_m.size(); ++c) {
      const VectorN<N> p_tip = slice.Point(map.right_m[c], map.up_m[r]);
      map.points[r * map.right_m.size() + c] = MeasureAt(setup, shaft, p_tip);
    }
  });
  Trim(map);
  return map;
}

template struct Slice<2>;
template struct Slice<3>;
template struct WorkspaceMap<2>;
template struct WorkspaceMap<3>;
template WorkspaceMap<2> ComputeMap(const MapSetup<2>&, const Slice<2>&, double);
template WorkspaceMap<3> ComputeMap(const MapSetup<3>&, const Slice<3>&, double);

}  // namespace flextip
