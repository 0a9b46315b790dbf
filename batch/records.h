// The ends of a batch's items on the disk, from which an interrupted batch goes on.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "batch/item.h"
#include "batch/line_file.h"
#include "batch/pool.h"

namespace flextip::batch {

class Records {
 public:
  /// Reads the file, none where it is missing. A torn last line is cut off: its item counts as not
  /// done. Throws InputError, with the line, for any other line that is no record and for a second
  /// record of an item; WorkError where the disk refuses.
  explicit Records(const std::filesystem::path& file);

  std::size_t size() const { return outcomes_.size(); }
  /// Returns the item's end, nullptr where it has none yet.
  const Outcome* Find(const std::string& name) const;

  /// Takes records out: their items are to be done again. Throws WorkError where the disk refuses.
  void Forget(const std::set<std::string>& names);

  /// Adds the ends of items and waits until the disk has them. Throws WorkError where it refuses:
  /// none of them counts then.
  void Add(const std::vector<Ended>& ended);

 private:
  std::filesystem::path file_;
  std::map<std::string, Outcome> outcomes_;
  std::unique_ptr<LineFile> lines_;
};

/// Writes a whole file beside its place and moves it there, so that it is never half written.
/// Throws WorkError where the disk refuses.
void WriteWhole(const std::filesystem::path& file, const std::string& text);

/// A file that one program at a time holds locked, with the processes that it forks.
class FolderLock {
 public:
  /// Waits up to `seconds` for the processes of a program that was killed. Throws InputError where
  /// another one holds it still.
  FolderLock(const std::filesystem::path& file, double seconds);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace flextip::batch
