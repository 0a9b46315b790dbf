// What 2.3.1 and 2.4 say of the maps, measured. Private to reproduction.
#pragma once

#include <vector>

#include "reproduction/chapter.h"
#include "workspace/map.h"
#include "workspace/motion_plan.h"
#include "workspace/tolerance.h"

namespace flextip::reproduction {

/// ||G|| and the angles over the map of Fig. 2.4.
std::vector<TableRow> StudyMeasures(const WorkspaceMap<2>& map);
/// ||G|| over the gain, on a grid.
std::vector<TableRow> StudyGains(double spacing_m);
/// v_sigma and p_phi of Fig. 2.5.
std::vector<TableRow> StudyDirections(const WorkspaceMap<2>& map);
/// The four errors of Fig. 2.6, in the order of FourErrors().
std::vector<TableRow> StudyFourErrors(const std::vector<WorkspaceMap<2>>& maps);

/// Which port errors parts of the workspace stand (2.4).
std::vector<TableRow> StudyTolerances(double spacing_m);
/// A path that is worth its detour (2.4), and what becomes of it and of the direct one.
struct PathStudy {
  std::vector<TableRow> rows;
  report::Figure figure;
};
PathStudy StudyPaths(double spacing_m);

}  // namespace flextip::reproduction
