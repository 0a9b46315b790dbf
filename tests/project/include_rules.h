// Which folder may include what: the table of docs/architecture.md as a check.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace flextip {

/// The files of a tree: path from the root (with '/') -> text.
using SourceTree = std::map<std::string, std::string>;

/// Every .h and .cpp below the folders that have rules.
SourceTree ReadSourceTree(const std::filesystem::path& root);

/// What breaks a rule, a line each: "vision/x.h:3: includes control/y.h, which vision may not use".
std::vector<std::string> IncludeViolations(const SourceTree& tree);

}  // namespace flextip
