// Which folder may include what: the table of docs/architecture.md as a check.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/project/source_tree.h"

namespace flextip {

/// Returns the table: folder -> the folders whose headers it may include, beside its own.
const std::map<std::string, std::set<std::string>>& IncludeArrows();

/// Returns a line for each broken rule: "vision/x.h:3: includes control/y.h, which vision may not
/// use".
std::vector<std::string> IncludeViolations(const SourceTree& tree);

}  // namespace flextip
