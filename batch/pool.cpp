#include "batch/pool.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "batch/zygote.h"
#include "core/check.h"
#include "core/error.h"

namespace flextip::batch {
namespace {

[[noreturn]] void SayItDied() {
  throw WorkError("the process that starts items was killed: items that ended are kept");
}

}  // namespace

Pool::Pool(const Work& work, const PoolOptions& options) : options_(options) {
  FLEXTIP_CHECK(options.jobs > 0, "a job at least");
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw WorkError(fmt::format("items cannot be started: {}", std::strerror(errno)));
  }
  std::fflush(nullptr);
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ < 0) {
    const int error = errno;
    close(ends[0]);
    close(ends[1]);
    throw WorkError(fmt::format("items cannot be started: {}", std::strerror(error)));
  }
  if (process_ == 0) {
    close(ends[0]);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);  // the parent was killed before the line above
    ServeItems(ends[1], work, options.timeout_s);
  }
  close(ends[1]);
  socket_ = ends[0];
}

Pool::~Pool() {
  close(socket_);  // the process sees that, kills its items and ends
  while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void Pool::Start(std::size_t index, const Item& item) {
  if (!SendMessage(socket_, WithIndex(index, Pack(item)))) SayItDied();
  ++running_;
}

std::vector<Ended> Pool::Wait(double seconds) {
  pollfd readable{socket_, POLLIN, 0};
  const int wait_ms = seconds < 0 ? -1 : static_cast<int>(std::ceil(1e3 * seconds));
  if (poll(&readable, 1, wait_ms) <= 0) return {};
  while (true) {
    char bytes[65536];
    const ssize_t n = recv(socket_, bytes, sizeof bytes, MSG_DONTWAIT);
    if (n < 0 && (errno == EAGAIN || errno == EINTR)) break;
    if (n <= 0) SayItDied();
    received_.append(bytes, static_cast<std::size_t>(n));
  }
  std::vector<Ended> ended;
  while (const auto message = TakeMessage(received_)) {
    auto [index, text] = IndexAndText(*message);
    ended.push_back({index, UnpackOutcome(text)});
    --running_;
    if (options_.finish) options_.finish(ended.back().outcome);
  }
  return ended;
}

}  // namespace flextip::batch
