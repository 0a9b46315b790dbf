// What 2.3.1 and 2.4 say of the maps, measured. Private to reproduction.
#pragma once

#include <vector>

#include "reproduction/chapter.h"
#include "workspace/map.h"

namespace flextip {

/// Sizes, ||G||, angles, gains and directions of Figs. 2.3 to 2.5.
std::vector<TableRow> StudyMeasures(const WorkspaceMap<2>& map);
std::vector<TableRow> StudyDirections(const WorkspaceMap<2>& map);
/// ||G|| over the gain.
std::vector<TableRow> StudyGains(double spacing_m);
/// The four errors of Fig. 2.6, in the order of FourErrors().
std::vector<TableRow> StudyFourErrors(const std::vector<WorkspaceMap<2>>& maps);
/// Which port errors the workspace stands, and which path is worth a detour (2.4).
std::vector<TableRow> StudyTolerances(double spacing_m);

}  // namespace flextip
