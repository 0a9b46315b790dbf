// What the server's thread leaves for the robot's. Private to serve.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>
#include <variant>

#include "live/serve/outlets.h"
#include "live/wire.h"

namespace flextip::live {

class Mailbox {
 public:
  struct Mail {
    Outlets::Source source;
    WireMessage message;
  };
  using Item = std::variant<Mail, WireEvent>;

  /// Waits where it is full: a client that floods is read no faster than it is served.
  void Put(Item item) {
    {
      std::unique_lock lock(mutex_);
      room_.wait(lock, [this] { return items_.size() < kMost || closed_; });
      if (closed_) return;
      items_.push_back(std::move(item));
    }
    changed_.notify_one();
  }

  /// From now on nothing is put, and nobody waits to.
  void Close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    room_.notify_all();
  }

  /// Returns the oldest item; waits for one until `until`.
  std::optional<Item> TakeUntil(std::chrono::steady_clock::time_point until) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_until(lock, until, [this] { return !items_.empty(); })) return {};
    Item item = std::move(items_.front());
    items_.pop_front();
    room_.notify_one();
    return item;
  }

 private:
  static constexpr std::size_t kMost = 1000;
  std::mutex mutex_;
  std::condition_variable changed_, room_;
  bool closed_ = false;
  std::deque<Item> items_;
};

}  // namespace flextip::live
