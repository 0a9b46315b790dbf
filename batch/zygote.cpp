#include "batch/zygote.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <thread>
#include <utility>

namespace flextip::batch {
namespace {

using Clock = std::chrono::steady_clock;

std::string HostName() {
  char name[256] = "";
  gethostname(name, sizeof name - 1);
  return name;
}

/// The item's own process: never returns.
[[noreturn]] void BeItem(const Work& work, const Item& item, int payload_end) {
  std::string payload;
  int code = 1;
  try {
    code = work(item, payload);
  } catch (const std::exception& error) {
    payload = error.what();
  } catch (...) {
    payload = "stopped by an error of unknown kind";
  }
  std::fflush(nullptr);
  for (std::size_t done = 0; done < payload.size();) {
    const ssize_t n = write(payload_end, payload.data() + done, payload.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) _exit(1);
    done += static_cast<std::size_t>(n);
  }
  _exit(code);
}

class Zygote {
 public:
  Zygote(int socket, const Work& work, double timeout_s)
      : socket_(socket), work_(work), timeout_s_(timeout_s), host_(HostName()) {
    prctl(PR_SET_NAME, "flextip-items");
    signal(SIGINT, SIG_IGN);  // its pool sees those, and closes the socket
    signal(SIGTERM, SIG_IGN);
    sigset_t child;
    sigemptyset(&child);
    sigaddset(&child, SIGCHLD);
    sigprocmask(SIG_BLOCK, &child, &mask_before_);
    signals_ = signalfd(-1, &child, SFD_NONBLOCK | SFD_CLOEXEC);
  }

  [[noreturn]] void Serve() {
    while (true) {
      Poll();
      ReadRequests();
      for (Child& child : children_) ReadPayload(child);
      Reap();
      KillTheLate();
    }
  }

 private:
  struct Child {
    pid_t pid = -1;
    std::size_t index = 0;
    std::string name, payload;
    int pipe = -1;
    Clock::time_point begin;
    bool late = false;
  };

  void Poll() {
    std::vector<pollfd> watched{{socket_, POLLIN, 0}, {signals_, POLLIN, 0}};
    for (const Child& child : children_) {
      if (child.pipe >= 0) watched.push_back({child.pipe, POLLIN, 0});
    }
    poll(watched.data(), watched.size(), MillisecondsLeft());
    signalfd_siginfo ignored;
    while (read(signals_, &ignored, sizeof ignored) > 0) {
    }
  }

  int MillisecondsLeft() const {
    if (timeout_s_ <= 0 || children_.empty()) return -1;
    double least_s = timeout_s_;
    for (const Child& child : children_) {
      if (!child.late) least_s = std::min(least_s, timeout_s_ - SecondsOf(child));
    }
    return static_cast<int>(std::ceil(1e3 * std::clamp(least_s, 0.0, 1e6)));
  }

  static double SecondsOf(const Child& child) {
    return std::chrono::duration<double>(Clock::now() - child.begin).count();
  }

  void ReadRequests() {
    char bytes[65536];
    const ssize_t n = recv(socket_, bytes, sizeof bytes, MSG_DONTWAIT);
    if (n == 0 || (n < 0 && errno != EAGAIN && errno != EINTR)) KillAllAndEnd();
    if (n > 0) received_.append(bytes, static_cast<std::size_t>(n));
    while (const auto message = TakeMessage(received_)) Begin(*message);
  }

  void Begin(const std::string& request) {
    const auto [index, text] = IndexAndText(request);
    const Item item = UnpackItem(text);
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) KillAllAndEnd();
    const pid_t self = getpid();
    pid_t pid = fork();
    for (int tries = 0; pid < 0 && tries < 50; ++tries) {  // too many processes for the moment
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      pid = fork();
    }
    if (pid < 0) KillAllAndEnd();
    if (pid == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != self) _exit(1);
      setpgid(0, 0);
      prctl(PR_SET_NAME, "flextip-item");
      signal(SIGINT, SIG_DFL);
      signal(SIGTERM, SIG_DFL);
      sigprocmask(SIG_SETMASK, &mask_before_, nullptr);
      close(socket_);
      close(signals_);
      close(ends[0]);
      for (const Child& other : children_) close(other.pipe);
      BeItem(work_, item, ends[1]);
    }
    setpgid(pid, pid);  // in both, whichever comes first
    close(ends[1]);
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    children_.push_back({pid, index, item.name, "", ends[0], Clock::now(), false});
  }

  void ReadPayload(Child& child) {
    char bytes[65536];
    while (child.pipe >= 0) {
      const ssize_t n = read(child.pipe, bytes, sizeof bytes);
      if (n > 0) {
        child.payload.append(bytes, static_cast<std::size_t>(n));
      } else if (n == 0) {
        close(child.pipe);
        child.pipe = -1;
      } else if (errno != EINTR) {
        return;
      }
    }
  }

  void Reap() {
    while (true) {
      siginfo_t info{};
      if (waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT) != 0 || info.si_pid == 0) return;
      kill(-info.si_pid, SIGKILL);  // what the item started and left
      int status = 0;
      waitpid(info.si_pid, &status, 0);
      const auto child = std::find_if(children_.begin(), children_.end(),
                                      [&](const Child& c) { return c.pid == info.si_pid; });
      if (child == children_.end()) continue;
      ReadPayload(*child);
      Tell(*child, status);
      if (child->pipe >= 0) close(child->pipe);
      children_.erase(child);
    }
  }

  void Tell(const Child& child, int status) {
    Outcome outcome{
        .name = child.name, .seconds = SecondsOf(child), .host = host_, .payload = child.payload};
    if (WIFEXITED(status)) {
      outcome.exit_code = WEXITSTATUS(status);
      outcome.status = outcome.exit_code == 0 ? Status::kOk : Status::kFailed;
    } else {
      outcome.exit_code = -1;
      outcome.signal = WTERMSIG(status);
      outcome.status = child.late ? Status::kTimedOut : Status::kCrashed;
    }
    if (!SendMessage(socket_, WithIndex(child.index, Pack(outcome)))) KillAllAndEnd();
  }

  void KillTheLate() {
    if (timeout_s_ <= 0) return;
    for (Child& child : children_) {
      if (child.late || SecondsOf(child) < timeout_s_) continue;
      child.late = true;
      kill(-child.pid, SIGKILL);
    }
  }

  [[noreturn]] void KillAllAndEnd() {
    for (const Child& child : children_) kill(-child.pid, SIGKILL);
    for (const Child& child : children_) waitpid(child.pid, nullptr, 0);
    _exit(0);
  }

  int socket_, signals_ = -1;
  const Work& work_;
  double timeout_s_;
  std::string host_, received_;
  sigset_t mask_before_{};
  std::vector<Child> children_;
};

}  // namespace

void ServeItems(int socket, const Work& work, double timeout_s) {
  Zygote(socket, work, timeout_s).Serve();
}

bool SendMessage(int socket, const std::string& message) {
  const auto length = static_cast<std::uint32_t>(message.size());
  std::string bytes(sizeof length, '\0');
  std::memcpy(bytes.data(), &length, sizeof length);
  bytes += message;
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = send(socket, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

std::optional<std::string> TakeMessage(std::string& received) {
  std::uint32_t length = 0;
  if (received.size() < sizeof length) return {};
  std::memcpy(&length, received.data(), sizeof length);
  if (received.size() < sizeof length + length) return {};
  std::string message = received.substr(sizeof length, length);
  received.erase(0, sizeof length + length);
  return message;
}

std::string WithIndex(std::size_t index, const std::string& text) {
  return std::to_string(index) + "\t" + text;
}

std::pair<std::size_t, std::string> IndexAndText(const std::string& message) {
  const std::size_t tab = message.find('\t');
  return {std::stoull(message.substr(0, tab)), message.substr(tab + 1)};
}

}  // namespace flextip::batch
