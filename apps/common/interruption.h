// Ctrl-C while a command works: what is unfinished goes or stays, and the user is told.
#pragma once

#include <atomic>
#include <csignal>
#include <filesystem>
#include <thread>

namespace flextip {

/// While it lives, the first interrupt or termination signal removes the folder `unfinished`, says
/// so on stderr and ends the program with 128 + the signal's number. To be made before other
/// threads are, which then leave the signals to it.
class Interruption {
 public:
  explicit Interruption(std::filesystem::path unfinished);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// From now on the folder stays, and the message says that --resume goes on with it.
  void Keep() { keep_ = true; }
  /// From now on the first signal only sets Requested; the second ends the program.
  void OnlyNote() { only_note_ = true; }
  bool Requested() const { return requested_; }

 private:
  void Wait(const std::stop_token& stop);
  void End(int signal) const;

  std::filesystem::path unfinished_;
  std::atomic<bool> keep_ = false, only_note_ = false, requested_ = false;
  sigset_t signals_{}, before_{};
  std::jthread waiting_;
};

}  // namespace flextip
