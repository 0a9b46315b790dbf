// Which folder may include what: the table of docs/architecture.md as a check.
#pragma once

#include <string>
#include <vector>

#include "tests/project/source_tree.h"

namespace flextip {

/// Returns a line for each broken rule: "vision/x.h:3: includes control/y.h, which vision may not
/// use".
std::vector<std::string> IncludeViolations(const SourceTree& tree);

}  // namespace flextip
