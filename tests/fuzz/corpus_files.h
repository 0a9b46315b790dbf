// The kept inputs of a fuzzing program.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace flextip {

/// Returns the content of every file of tests/fuzz/corpus/NAME.
inline std::vector<std::vector<std::uint8_t>> CorpusFiles(const std::string& name) {
  const auto folder = std::filesystem::path(FLEXTIP_SOURCE_DIR) / "tests/fuzz/corpus" / name;
  std::vector<std::vector<std::uint8_t>> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
    files.emplace_back(text.begin(), text.end());
  }
  return files;
}

}  // namespace flextip
