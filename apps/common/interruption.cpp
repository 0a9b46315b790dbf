#include "apps/common/interruption.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <ctime>
#include <utility>

namespace flextip {

Interruption::Interruption(std::filesystem::path unfinished) : unfinished_(std::move(unfinished)) {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  waiting_ = std::jthread([this](const std::stop_token& stop) { Wait(stop); });
}

Interruption::~Interruption() {
  waiting_.request_stop();
  waiting_.join();
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void Interruption::Wait(const std::stop_token& stop) {
  const timespec moment{0, 20'000'000};  // how long the end of a command may wait for this thread
  while (!stop.stop_requested()) {
    const int signal = sigtimedwait(&signals_, nullptr, &moment);
    if (signal <= 0) continue;
    if (only_note_ && !requested_.exchange(true)) continue;
    End(signal);
  }
}

void Interruption::End(int signal) const {
  if (keep_) {
    fmt::print(stderr,
               "\nflextip: interrupted; {} keeps what was done: the same command with --resume "
               "goes on\n",
               unfinished_.string());
  } else {
    std::error_code ignored;
    std::filesystem::remove_all(unfinished_, ignored);
    fmt::print(stderr, "\nflextip: interrupted; nothing was kept\n");
  }
  std::fflush(stderr);
  _exit(128 + signal);
}

}  // namespace flextip
