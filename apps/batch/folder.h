// OUT of a batch: grows item by item, and an interrupted batch goes on from it.
#pragma once

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "apps/batch/list.h"
#include "batch/records.h"

namespace flextip {

/// What a batch is to do.
struct BatchPlan {
  std::vector<std::string> command;  ///< "calibrate", "tip"
  std::vector<std::string> options;  ///< of all items
  std::vector<ListedItem> items;
};

/// OUT/batch.json says what the batch is, OUT/records.tsv how its items ended, OUT/items/NAME is
/// what the command alone would have written, OUT/logs/NAME.log what it said.
class BatchFolder {
 public:
  /// Makes OUT, or with `resume` goes on with it. Throws InputError where OUT is a file, holds
  /// something (without `resume`), is no batch or another one, and where another program is at work
  /// on it; WorkError where the disk refuses.
  BatchFolder(const std::filesystem::path& out, const BatchPlan& plan, bool resume);

  const std::filesystem::path& out() const { return out_; }
  /// When the batch was first begun.
  const std::string& date() const { return date_; }
  batch::Records& records() { return *records_; }

  /// Returns the indices of the items that are still to do, and clears away what was left of them.
  std::vector<std::size_t> TakeNotDone();

 private:
  void GoOn();
  void Keep() const;

  std::filesystem::path out_;
  const BatchPlan& plan_;
  std::string date_;
  std::unique_ptr<batch::FolderLock> lock_;
  std::unique_ptr<batch::Records> records_;
};

/// Returns OUT/items/NAME and OUT/logs/NAME.log.
std::filesystem::path ItemFolder(const std::filesystem::path& out, const std::string& name);
std::filesystem::path ItemLog(const std::filesystem::path& out, const std::string& name);

/// Removes OUT/items/NAME.partial-PID of all items, or of one.
void RemovePartialItems(const std::filesystem::path& out, const std::string& name = "");

}  // namespace flextip
