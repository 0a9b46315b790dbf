// One item of a batch: the program run within a process of its own.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/batch/list.h"
#include "batch/pool.h"

namespace flextip {

struct BatchWork {
  std::vector<std::string> command, options;
  std::filesystem::path defaults;
  int threads = 1;  ///< of one item
  /// The program, on arguments as a user types them.
  std::function<int(const std::vector<std::string>&)> program;
};

/// The item as the library hands it out: OUT, the input, its options. Its size is that of the files
/// at its path.
batch::Item ItemOf(const ListedItem& listed, const std::filesystem::path& out);

/// Runs the program on an item, with its messages in OUT/logs/NAME.log. The payload is JSON:
/// `times`, what its summary would have said of time.
int DoItem(const BatchWork& work, const batch::Item& item, std::string& payload);

/// Completes the payload of an item that ended by `message`, the line it left, and clears away what
/// a crashed one left.
void FinishItem(const std::filesystem::path& out, batch::Outcome& outcome);

/// Whether an item failed because the disk did not take its results.
bool DiskRefused(const batch::Outcome& outcome);

}  // namespace flextip
