// The items of a batch: a file of paths, or a glob.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flextip {

struct ListedItem {
  std::string name;                  ///< of its folder: letters, digits, . _ -
  std::string input;                 ///< a path, seen from the working folder
  std::vector<std::string> options;  ///< of its own
};

/// Reads LIST. A file has a line an item: a path relative to the file's folder, then `name=NAME`
/// and options of its own where wanted, as a shell takes them; # begins a comment. A text with *, ?
/// or [ is a glob. An item without a name has its path's last part, with as much before it as tells
/// it from the others. Throws InputError, with file and line, for what cannot be understood, for a
/// name twice and for a list without items.
std::vector<ListedItem> ReadBatchList(const std::string& list);

}  // namespace flextip
