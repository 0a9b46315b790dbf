// The project's files as text, for the checks of the project itself.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace flextip {

/// The files of a tree: path from the root (with '/') -> text.
using SourceTree = std::map<std::string, std::string>;

/// Reads every .h and .cpp below the project's folders.
SourceTree ReadSourceTree(const std::filesystem::path& root);

/// Returns the paths of all files of the project, from the root. What git ignores is left out.
std::vector<std::string> ProjectFiles(const std::filesystem::path& root);

}  // namespace flextip
