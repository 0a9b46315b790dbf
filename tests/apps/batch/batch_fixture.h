// What the tests of flextip batch share.
#pragma once

#include <gmock/gmock.h>
#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/apps/run_program.h"

namespace flextip::batch_test {

/// Every file below a folder, by its path, with its bytes.
std::map<std::string, std::string> FilesBelow(const std::filesystem::path& folder);

/// table.csv without what depends on time or machine: the columns from `seconds` on.
std::string TableWithoutTimes(const std::filesystem::path& out);

/// The cells of a table's row by the columns' names; empty where there is no such item.
std::map<std::string, std::string> RowOf(const std::filesystem::path& out, const std::string& name);

/// Starts the program and does not wait. Its messages go to files in `folder`.
pid_t Begin(const std::vector<std::string>& arguments, const std::filesystem::path& folder);
/// Returns the exit code, 128 + the signal where one ended it.
int ExitCodeOf(pid_t process);

/// The processes below `process`, by the name they have given themselves.
std::vector<pid_t> Below(pid_t process, const std::string& name);

/// A recording of the project.
std::string Sample(int number);

class BatchCommand : public testing::Test {
 protected:
  std::string Out(const std::string& name = "out") const { return (folder_ / name).string(); }
  /// `check` of two samples and of a path that is not there.
  std::string CheckList() const {
    return folder_.Write("list.txt", Sample(0) + "\n" + Sample(1) + "\nabsent # is not there\n");
  }
  TestFolder folder_;
};

}  // namespace flextip::batch_test
