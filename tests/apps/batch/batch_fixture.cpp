#include "tests/apps/batch/batch_fixture.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace flextip::batch_test {
namespace {

namespace fs = std::filesystem;

/// Cells of a line whose fields in quotes hold no quotes themselves.
std::vector<std::string> CellsOf(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::vector<std::vector<std::string>> TableOf(const fs::path& out) {
  std::istringstream text(ReadText(out / "table.csv"));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(text, line);) rows.push_back(CellsOf(line));
  return rows;
}

}  // namespace

std::map<std::string, std::string> FilesBelow(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[entry.path().lexically_relative(folder).string()] = ReadText(entry.path());
  }
  return files;
}

std::string TableWithoutTimes(const fs::path& out) {
  const auto rows = TableOf(out);
  std::string text;
  if (rows.empty()) return text;
  const auto times = std::find(rows[0].begin(), rows[0].end(), "seconds") - rows[0].begin();
  for (const auto& row : rows) {
    for (std::ptrdiff_t i = 0; i < times; ++i) text += row[static_cast<std::size_t>(i)] + ",";
    text += "\n";
  }
  return text;
}

std::map<std::string, std::string> RowOf(const fs::path& out, const std::string& name) {
  const auto rows = TableOf(out);
  std::map<std::string, std::string> cells;
  for (const auto& row : rows) {
    if (row[0] != name) continue;
    for (std::size_t i = 0; i < row.size(); ++i) cells[rows[0][i]] = row[i];
  }
  return cells;
}

pid_t Begin(const std::vector<std::string>& arguments, const fs::path& folder) {
  const pid_t process = fork();
  if (process != 0) return process;
  std::vector<std::string> copies(arguments);
  std::string program = FLEXTIP_PROGRAM;
  std::vector<char*> argv{program.data()};
  for (auto& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  dup2(open((folder / "stdout").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
  dup2(open((folder / "stderr").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
  execv(program.c_str(), argv.data());
  _exit(127);
}

int ExitCodeOf(pid_t process) {
  int status = 0;
  waitpid(process, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::vector<pid_t> Below(pid_t process, const std::string& name) {
  std::map<pid_t, std::pair<pid_t, std::string>> all;  // parent and name
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream stat(entry.path() / "stat");
    std::string line;
    if (!std::getline(stat, line)) continue;
    const std::size_t open = line.find('('), close = line.rfind(')');
    std::istringstream rest(line.substr(close + 1));
    std::string state;
    pid_t parent = 0;
    if (rest >> state >> parent) {
      all[std::stoi(line)] = {parent, line.substr(open + 1, close - open - 1)};
    }
  }
  std::vector<pid_t> found;
  for (const auto& [pid, about] : all) {
    if (about.second != name) continue;
    for (pid_t above = about.first; all.contains(above); above = all[above].first) {
      if (above == process) found.push_back(pid);
    }
  }
  return found;
}

std::string Sample(int number) {
  return fmt::format("{}/testdata/recordings/sample_{}", FLEXTIP_SOURCE_DIR, number);
}

}  // namespace flextip::batch_test
