// What `flextip map` writes of a map: rows of map.csv and figures.
#pragma once

#include <string>
#include <vector>

#include "recording/text/csv.h"
#include "report/figure.h"
#include "workspace/map_scenario.h"

namespace flextip {

/// Worst cases over a map, one value a point, NaN where there is none; empty: not asked for.
struct WorstValues {
  std::vector<double> norm;
  std::vector<double> angle_rad;
};

/// Returns the columns of map.csv.
template <int N>
std::vector<std::string> MapColumns(bool with_worst);
/// Adds a row for every point that the tip can reach. SI units, angles in degrees as named; a
/// measure that is not there is left empty.
template <int N>
void AddMapRows(const std::string& slice, const WorkspaceMap<N>& map, const WorstValues& worst,
                CsvWriter& csv);

/// ||G||, bound, angle and the two directions of a slice. `prefix` begins the names.
template <int N>
std::vector<report::Figure> MapFigures(const MapSetup<N>& setup, const std::string& slice,
                                       const std::string& prefix, const WorkspaceMap<N>& map);
/// The worst cases and, where there is one, the part they were asked for.
template <int N>
std::vector<report::Figure> WorstFigures(const MapSetup<N>& setup, const ToleranceTask<N>& task,
                                         const std::string& slice, const std::string& prefix,
                                         const WorkspaceMap<N>& map, const WorstValues& worst);
/// Around the paths.
template <int N>
report::Figure PlanFigure(const WorkspaceMap<N>& map, const Path& direct, const Path& planned,
                          const Followed<N>& by_direct, const Followed<N>& by_planned);

}  // namespace flextip
