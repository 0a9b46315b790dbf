// Runs the flextip program as a user would.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace flextip {

struct ProgramResult {
  int exit_code = -1;
  std::string out, err;
};

/// Runs a program, by default the built one, with `arguments`, without a shell and with stderr not
/// a terminal.
ProgramResult RunProgram(const std::vector<std::string>& arguments,
                         const std::string& program = FLEXTIP_PROGRAM);

/// Runs the program until a file it writes would hold more than `bytes`: the system kills it then,
/// in the midst of writing and however fast it is.
void KillAtFileSize(const std::vector<std::string>& arguments, std::uintmax_t bytes);

/// A fresh folder of the running test, removed at its end.
class TestFolder {
 public:
  TestFolder();
  ~TestFolder();
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Writes a file and its folders, and gives its path.
  std::string Write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

std::string ReadText(const std::filesystem::path& file);

/// One line on stderr, "flextip: ..." with every one of `parts` in it, and exit code 2.
testing::AssertionResult IsRefused(const ProgramResult& result,
                                   const std::vector<std::string>& parts);

/// `folder`/report.html comes out of `flextip report` byte for byte as the command left it.
testing::AssertionResult PageIsMadeAgain(const std::filesystem::path& folder);

}  // namespace flextip
