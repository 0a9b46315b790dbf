// The kept inputs of a fuzzing program, as a test of every build.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
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

/// Gives every file of tests/fuzz/corpus/NAME to the program's check, which aborts where a promise
/// is broken. Expects that there are enough files, and that enough was understood in them.
inline void CheckCorpus(const std::string& name, int (*check)(std::span<const std::uint8_t>),
                        std::size_t least_files, int least_understood) {
  const auto files = CorpusFiles(name);
  int understood = 0;
  for (const auto& bytes : files) understood += check(bytes);
  EXPECT_GE(files.size(), least_files);
  EXPECT_GE(understood, least_understood);
}

}  // namespace flextip
