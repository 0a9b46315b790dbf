// A folder for the files of one input, and what is asked of every reader of files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace flextip {

/// The process's own folder, in memory where the system has one; removed at the program's end.
class InputFolder {
 public:
  InputFolder();
  ~InputFolder();
  InputFolder(const InputFolder&) = delete;
  InputFolder& operator=(const InputFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Writes a file and its folders, and gives its path.
  std::filesystem::path Write(const std::string& name, std::string_view text) const;

 private:
  std::filesystem::path path_;
};

/// Aborts unless `holds`.
void Require(bool holds);

/// Calls `read`. Returns whether it read; aborts where it refuses by anything but an InputError
/// with one line that a terminal can show.
bool ReadsOrRefuses(const std::function<void()>& read);

/// Returns the parts of the input between lines "====".
std::vector<std::string_view> PartsOf(std::span<const std::uint8_t> input);

std::string_view TextOf(std::span<const std::uint8_t> input);

}  // namespace flextip
