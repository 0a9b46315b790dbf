// A progress bar for long work.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace flextip {

/// Draws "label [####    ] 40 % 12 s" on stderr, at most ten times a second, and only where stderr
/// is a terminal and the program was not asked to be quiet. Erases itself at the end.
class Progress {
 public:
  Progress(std::string label, std::size_t total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of the total is done.
  void Update(std::size_t done);

 private:
  using Clock = std::chrono::steady_clock;

  std::string label_;
  std::size_t total_;
  bool visible_;
  Clock::time_point start_, last_drawn_;
};

}  // namespace flextip
