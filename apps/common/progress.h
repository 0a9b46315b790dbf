// A progress bar for long work.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

namespace flextip {

/// Draws "label [####    ] 40 % 12 s, 18 s left 31 fps" (the rate where a unit is given) on stderr,
/// at most ten times a second; erases itself at the end. Where stderr is no terminal, writes a line
/// a minute. Says nothing where the program was asked to be quiet.
class Progress {
 public:
  /// `total` 0: not known, and no bar but the count.
  Progress(std::string label, std::size_t total, bool quiet, std::string rate_unit = "");
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `done` of the total is done; `remark` is shown behind.
  void Update(std::size_t done, const std::string& remark = "");

 private:
  using Clock = std::chrono::steady_clock;

  double SecondsLeft(std::size_t done, Clock::time_point now) const;
  void Log(std::size_t done, Clock::time_point now);

  std::string label_, rate_unit_;
  std::size_t total_;
  bool visible_, logs_;
  Clock::time_point start_, last_drawn_;
};

/// Returns a function for libraries that report (done, all); the bar appears with its first call
/// and goes with the function.
std::function<void(std::size_t done, std::size_t all)> ProgressFunction(const std::string& label,
                                                                        bool quiet);

}  // namespace flextip
