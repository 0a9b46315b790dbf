#include "tests/apps/run_program.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace flextip {
namespace {

/// In the child: stdout and stderr into files, then the program.
[[noreturn]] void Become(std::string program, const std::vector<std::string>& arguments,
                         const std::string& out, const std::string& err) {
  std::vector<std::string> copies(arguments);
  std::vector<char*> argv{program.data()};
  for (auto& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
  dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
  execv(program.c_str(), argv.data());
  _exit(127);
}

}  // namespace

ProgramResult RunProgram(const std::vector<std::string>& arguments, const std::string& program) {
  const TestFolder folder;
  const std::string out = (folder / "stdout").string(), err = (folder / "stderr").string();
  const pid_t child = fork();
  if (child == 0) Become(program, arguments, out, err);
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, ReadText(out), ReadText(err)};
}

void KillAtFileSize(const std::vector<std::string>& arguments, std::uintmax_t bytes) {
  const TestFolder messages;
  const pid_t child = fork();
  if (child == 0) {
    const rlimit size{bytes, bytes}, none{0, 0};
    setrlimit(RLIMIT_CORE, &none);
    setrlimit(RLIMIT_FSIZE, &size);
    Become(FLEXTIP_PROGRAM, arguments, messages / "out", messages / "err");
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status)) << ReadText(messages / "err");
  ASSERT_EQ(WTERMSIG(status), SIGXFSZ);
}

TestFolder::TestFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "flextip-XXXXXX").string();
  path_ = mkdtemp(name.data());
}

TestFolder::~TestFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

std::string TestFolder::Write(const std::string& name, const std::string& text) const {
  std::filesystem::create_directories((path_ / name).parent_path());
  std::ofstream(path_ / name, std::ios::binary) << text;
  return (path_ / name).string();
}

std::string ReadText(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

testing::AssertionResult IsRefused(const ProgramResult& result,
                                   const std::vector<std::string>& parts) {
  if (result.exit_code != 2) {
    return testing::AssertionFailure() << "exit code " << result.exit_code << ", " << result.err;
  }
  if (!result.err.starts_with("flextip: ") ||
      std::count(result.err.begin(), result.err.end(), '\n') != 1) {
    return testing::AssertionFailure() << "not one line: " << result.err;
  }
  for (const auto& part : parts) {
    if (result.err.find(part) == std::string::npos) {
      return testing::AssertionFailure() << "no '" << part << "' in: " << result.err;
    }
  }
  return testing::AssertionSuccess();
}

testing::AssertionResult PageIsMadeAgain(const std::filesystem::path& folder) {
  const std::filesystem::path page = folder / "report.html";
  const std::string before = ReadText(page);
  if (before.empty()) return testing::AssertionFailure() << page << " is empty or missing";
  std::filesystem::remove(page);
  const ProgramResult run = RunProgram({"report", folder.string()});
  if (run.exit_code != 0) return testing::AssertionFailure() << run.err;
  if (ReadText(page) == before) return testing::AssertionSuccess();
  return testing::AssertionFailure() << page << " differs from the command's own";
}

}  // namespace flextip
