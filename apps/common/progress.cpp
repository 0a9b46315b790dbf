#include "apps/common/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <utility>

namespace flextip {

Progress::Progress(std::string label, std::size_t total, bool quiet, std::string rate_unit)
    : label_(std::move(label)),
      rate_unit_(std::move(rate_unit)),
      total_(total),
      visible_(!quiet && isatty(fileno(stderr)) == 1),
      logs_(!quiet && !visible_),
      start_(Clock::now()) {
  Update(0);
}

Progress::~Progress() {
  if (visible_) std::fputs("\r\033[K", stderr);
}

void Progress::Update(std::size_t done, const std::string& remark) {
  const auto now = Clock::now();
  if (logs_) Log(done, now);
  if (!visible_ || (done > 0 && now - last_drawn_ < std::chrono::milliseconds(100))) return;
  last_drawn_ = now;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  std::string line = fmt::format("{} {}", label_, done);
  if (total_ > 0) {
    constexpr std::size_t kWidth = 32;
    done = std::min(done, total_);
    const std::size_t filled = kWidth * done / total_;
    line = fmt::format("{} [{}{}] {:3} %", label_, std::string(filled, '#'),
                       std::string(kWidth - filled, ' '), 100 * done / total_);
  }
  line += fmt::format(" {:.0f} s", seconds);
  if (total_ > 0 && done > 0) line += fmt::format(", {:.0f} s left", SecondsLeft(done, now));
  if (!rate_unit_.empty() && seconds > 0) {
    line += fmt::format(" {:.1f} {}", static_cast<double>(done) / seconds, rate_unit_);
  }
  fmt::print(stderr, "\r{} {}\033[K", line, remark);
  std::fflush(stderr);
}

double Progress::SecondsLeft(std::size_t done, Clock::time_point now) const {
  const double seconds = std::chrono::duration<double>(now - start_).count();
  return seconds * static_cast<double>(total_ - done) / static_cast<double>(done);
}

void Progress::Log(std::size_t done, Clock::time_point now) {
  if (done == 0) last_drawn_ = start_;
  if (now - last_drawn_ < std::chrono::minutes(1)) return;
  last_drawn_ = now;
  if (total_ > 0 && done <= total_) {
    fmt::print(stderr, "flextip: {}: {} of {}, {:.0f} s left\n", label_, done, total_,
               SecondsLeft(done, now));
  } else {
    fmt::print(stderr, "flextip: {}: {}\n", label_, done);
  }
}

std::function<void(std::size_t, std::size_t)> ProgressFunction(const std::string& label,
                                                               bool quiet) {
  return
      [label, quiet, bar = std::shared_ptr<Progress>()](std::size_t done, std::size_t all) mutable {
        if (!bar) bar = std::make_shared<Progress>(label, all, quiet);
        bar->Update(done);
      };
}

}  // namespace flextip
