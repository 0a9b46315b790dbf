#include "workspace/map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/check.h"

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
WorkspaceMap<N> Cut(const WorkspaceMap<N>& map, const Range& rows, const Range& columns) {
  WorkspaceMap<N> part{.slice = map.slice, .spacing_m = map.spacing_m};
  const auto at = [](const auto& list, std::size_t i) { return list.begin() + std::ptrdiff_t(i); };
  part.up_m.assign(at(map.up_m, rows.first), at(map.up_m, rows.last));
  part.right_m.assign(at(map.right_m, columns.first), at(map.right_m, columns.last));
  for (std::size_t r = rows.first; r < rows.last; ++r)
    for (std::size_t c = columns.first; c < columns.last; ++c) part.points.push_back(map.At(r, c));
  return part;
}

template <int N>
WorkspaceMap<N> Trim(const WorkspaceMap<N>& map) {
  const auto in = [&](std::size_t r, std::size_t c) { return map.At(r, c).state.has_value(); };
  const Range rows = UsedRange(map.up_m.size(), [&](std::size_t r) {
    for (std::size_t c = 0; c < map.right_m.size(); ++c)
      if (in(r, c)) return true;
    return false;
  });
  const Range columns = UsedRange(map.right_m.size(), [&](std::size_t c) {
    for (std::size_t r = 0; r < map.up_m.size(); ++r)
      if (in(r, c)) return true;
    return false;
  });
  return Cut(map, rows, columns);
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
  FLEXTIP_CHECK(spacing_m > 0.0, "a positive spacing");
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
  return Trim(map);
}

template <int N>
WorkspaceMap<N> PartAround(const WorkspaceMap<N>& map, const std::vector<Eigen::Vector2d>& places,
                           double margin_m) {
  FLEXTIP_CHECK(!places.empty(), "a map has a place");
  Eigen::Vector2d low = places.front(), high = places.front();
  for (const auto& p : places) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const auto within = [&](const std::vector<double>& lines, int axis) {
    return UsedRange(lines.size(), [&](std::size_t i) {
      return lines[i] >= low[axis] - margin_m && lines[i] <= high[axis] + margin_m;
    });
  };
  return Cut(map, within(map.up_m, 1), within(map.right_m, 0));
}

template struct Slice<2>;
template struct Slice<3>;
template struct WorkspaceMap<2>;
template struct WorkspaceMap<3>;
template WorkspaceMap<2> ComputeMap(const MapSetup<2>&, const Slice<2>&, double);
template WorkspaceMap<3> ComputeMap(const MapSetup<3>&, const Slice<3>&, double);
template WorkspaceMap<2> PartAround(const WorkspaceMap<2>&, const std::vector<Eigen::Vector2d>&,
                                    double);
template WorkspaceMap<3> PartAround(const WorkspaceMap<3>&, const std::vector<Eigen::Vector2d>&,
                                    double);

}  // namespace flextip
