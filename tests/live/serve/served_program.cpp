#include "tests/live/serve/served_program.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

namespace flextip {
namespace {

constexpr int kPatience_ms = 60'000;

}  // namespace

ServedProgram::ServedProgram(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {FLEXTIP_PROGRAM, "simulate"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return;
  pid_ = ::fork();
  if (pid_ == 0) {
    ::dup2(ends[1], STDOUT_FILENO);
    ::execv(argv[0], argv.data());
    _exit(127);
  }
  ::close(ends[1]);
  pipe_ = ends[0];
  const std::string before = "serving on 127.0.0.1:";
  std::size_t at = std::string::npos;
  while ((at = out_.find(before)) == std::string::npos || out_.find('\n', at) == std::string::npos)
    if (!ReadMore()) return;
  port_ = std::atoi(out_.c_str() + at + before.size());
}

ServedProgram::~ServedProgram() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  if (pipe_ >= 0) ::close(pipe_);
}

bool ServedProgram::ReadMore() {
  pollfd waited{pipe_, POLLIN, 0};
  char part[4096];
  if (::poll(&waited, 1, kPatience_ms) <= 0) return false;
  const ssize_t got = ::read(pipe_, part, sizeof part);
  if (got <= 0) return false;
  out_.append(part, static_cast<std::size_t>(got));
  return true;
}

void ServedProgram::Interrupt() const { ::kill(pid_, SIGINT); }

int ServedProgram::Wait() {
  while (ReadMore()) {
  }
  int status = 0;
  for (int waited_ms = 0; waited_ms < kPatience_ms; waited_ms += 10) {
    if (::waitpid(pid_, &status, WNOHANG) == pid_) {
      pid_ = -1;
      return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    ::usleep(10'000);
  }
  return -1;
}

}  // namespace flextip
