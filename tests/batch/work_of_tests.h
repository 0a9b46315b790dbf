// Items for tests: each does as its first argument says.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "batch/item.h"

namespace flextip::batch {

/// "ok", "exit N", "throw", "segv", "abort", "sleep SECONDS", "payload BYTES", "orphan FILE"
/// (leaves a process that writes FILE after 0.3 s), "append FILE" (adds a line with the item's
/// name).
int DoAsTold(const Item& item, std::string& payload);

/// A folder of the running test, removed at its end.
class BatchTestFolder {
 public:
  BatchTestFolder();
  ~BatchTestFolder();
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace flextip::batch
