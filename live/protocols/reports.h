// What every protocol keeps of its messages: counts, and lines on those that were refused.
#pragma once

#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include "live/wire.h"

namespace flextip::live {

inline constexpr std::size_t kShownBytes = 100;  // of a text that a peer chose

/// Returns the first `most` bytes of a text, fit for a line: what is not printable as '?'.
inline std::string Printable(std::string_view text, std::size_t most = std::string_view::npos) {
  std::string shown(text.substr(0, most));
  for (char& c : shown)
    if (c < ' ' || c > '~') c = '?';
  return shown;
}

/// Counts that several threads change.
class SharedCounts {
 public:
  void Add(std::int64_t WireCounts::*count, std::int64_t n = 1) {
    const std::lock_guard lock(mutex_);
    counts_.*count += n;
  }
  WireCounts Get() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }

 private:
  mutable std::mutex mutex_;
  WireCounts counts_;
};

/// Lets ten lines a second pass, and says how many it left out.
class Reports {
 public:
  void Tell(const std::function<void(WireEvent&&)>& event, const std::string& what,
            const std::string& device = {}) {
    const auto now = std::chrono::steady_clock::now();
    if (now - begun_ > std::chrono::seconds(1)) {
      begun_ = now;
      told_ = 0;
    }
    constexpr int kMostPerSecond = 10;
    if (++told_ > kMostPerSecond) {
      ++untold_;
      return;
    }
    const std::int64_t left_out = std::exchange(untold_, 0);
    const std::string more =
        left_out > 0 ? fmt::format(" ({} such lines were left out before)", left_out) : "";
    event({WireEvent::Kind::kRefused, what + more, device});
  }

 private:
  std::chrono::steady_clock::time_point begun_{};
  int told_ = 0;
  std::int64_t untold_ = 0;
};

}  // namespace flextip::live
