#include "tests/project/source_tree.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

namespace flextip {
namespace {

/// As in .gitignore, and what git keeps for itself.
const std::set<std::string> kNotOurs{".git", "build", "node_modules", "out", "__pycache__"};

}  // namespace

std::vector<std::string> ProjectFiles(const std::filesystem::path& root) {
  std::vector<std::string> files;
  auto entries = std::filesystem::recursive_directory_iterator(root);
  for (auto entry = begin(entries); entry != end(entries); ++entry) {
    if (kNotOurs.contains(entry->path().filename().string())) {
      entry.disable_recursion_pending();
    } else if (entry->is_regular_file()) {
      files.push_back(entry->path().lexically_relative(root).generic_string());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

SourceTree ReadSourceTree(const std::filesystem::path& root) {
  SourceTree tree;
  for (const std::string& path : ProjectFiles(root)) {
    if (!path.ends_with(".h") && !path.ends_with(".cpp")) continue;
    std::ifstream file(root / path);
    tree[path] = {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  return tree;
}

}  // namespace flextip
