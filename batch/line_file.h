// A file that grows by whole lines and survives whatever kills its writer.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flextip::batch {

/// Returns the whole lines of a file, none where it is missing. A last line without its line break
/// was torn and is left out. Throws InputError where the file cannot be read.
std::vector<std::string> WholeLines(const std::filesystem::path& file);

/// Appends lines. Only one program at a time may write the file.
class LineFile {
 public:
  /// Opens or makes the file, and cuts off a torn last line. Throws WorkError where the disk
  /// refuses.
  explicit LineFile(const std::filesystem::path& file);
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;

  /// Writes `lines` (each without its line break) and waits until the disk has them. Where that
  /// fails, cuts off what was written of them and throws WorkError.
  void Append(const std::vector<std::string>& lines);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
  long long size_ = 0;  // bytes of whole lines
};

}  // namespace flextip::batch
