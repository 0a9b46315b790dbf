// The figures of 2.3.1. Private to reproduction.
#pragma once

#include <vector>

#include "report/figure.h"
#include "workspace/map.h"

namespace flextip::reproduction {

/// Starts of the experiment (2.3.2), as (z, y) in m.
inline const Eigen::Vector2d kStartL{0.320, 0.0}, kStartM{0.375, 0.0}, kStartN{0.415, 0.0};

/// The robot of 2.3.1 whose controller believes the port `port_error_m` (z, y) from where it is.
MapSetup<2> ThesisSetup(const Eigen::Vector2d& port_error_m);
/// (20, 10) mm in (y, z): Figs. 2.4 and 2.5, and the experiment's.
inline const Eigen::Vector2d kThesisError{0.010, 0.020};

struct NamedError {
  const char* name;      ///< name of the figures: "1" to "4"
  const char* in_words;  ///< "+z"
  Eigen::Vector2d port_error_m;
};
/// Those of Fig. 2.6, in its order.
const std::vector<NamedError>& FourErrors();

report::Figure DrawWorkspaces();                                                       ///< Fig. 2.3
std::vector<report::Figure> DrawMeasures(const WorkspaceMap<2>& map);                  ///< Fig. 2.4
std::vector<report::Figure> DrawDirections(const WorkspaceMap<2>& map);                ///< Fig. 2.5
std::vector<report::Figure> DrawFourErrors(const std::vector<WorkspaceMap<2>>& maps);  ///< Fig. 2.6

}  // namespace flextip::reproduction
