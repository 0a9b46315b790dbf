#include "apps/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace flextip {

Progress::Progress(std::string label, std::size_t total, bool quiet)
    : label_(std::move(label)),
      total_(std::max<std::size_t>(total, 1)),
      visible_(!quiet && isatty(fileno(stderr)) == 1),
      start_(Clock::now()) {
  Update(0);
}

Progress::~Progress() {
  if (visible_) std::fputs("\r\033[K", stderr);
}

void Progress::Update(std::size_t done) {
  const auto now = Clock::now();
  if (!visible_ || (done > 0 && now - last_drawn_ < std::chrono::milliseconds(100))) return;
  last_drawn_ = now;
  constexpr std::size_t kWidth = 32;
  done = std::min(done, total_);
  const std::size_t filled = kWidth * done / total_;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  fmt::print(stderr, "\r{} [{}{}] {:3} % {:.0f} s\033[K", label_, std::string(filled, '#'),
             std::string(kWidth - filled, ' '), 100 * done / total_, seconds);
  std::fflush(stderr);
}

}  // namespace flextip
