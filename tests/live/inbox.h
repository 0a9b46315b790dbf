// What an end of a connection was given, for tests that wait for it.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "live/wire.h"

namespace flextip::live {

/// What one end was given.
class Inbox {
 public:
  std::function<void(WireMessage&&)> OnMessage() {
    return [this](WireMessage&& message) {
      const std::lock_guard lock(mutex_);
      messages_.push_back(std::move(message));
      changed_.notify_all();
    };
  }
  std::function<void(WireEvent&&)> OnEvent() {
    return [this](WireEvent&& event) {
      const std::lock_guard lock(mutex_);
      events_.push_back(std::move(event));
      changed_.notify_all();
    };
  }
  /// Waits until so many messages are there, 10 s at most.
  bool Await(std::size_t count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(10),
                             [&] { return messages_.size() >= count; });
  }
  /// Waits for the `count`-th event of a kind and returns its line.
  std::string AwaitEvent(WireEvent::Kind kind, int count = 1) {
    std::unique_lock lock(mutex_);
    std::string found;
    changed_.wait_for(lock, std::chrono::seconds(10), [&] {
      int seen = 0;
      for (const WireEvent& event : events_) {
        if (event.kind != kind || ++seen != count) continue;
        found = event.what;
        return true;
      }
      return false;
    });
    return found;
  }
  /// Waits for an event whose line holds `part` and returns its line.
  std::string AwaitLine(const std::string& part) {
    std::unique_lock lock(mutex_);
    std::string found;
    changed_.wait_for(lock, std::chrono::seconds(10), [&] {
      for (const WireEvent& event : events_)
        if (event.what.find(part) != std::string::npos) found = event.what;
      return !found.empty();
    });
    return found;
  }
  std::vector<WireMessage> Messages() {
    const std::lock_guard lock(mutex_);
    return messages_;
  }
  int Events(WireEvent::Kind kind) {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(std::count_if(events_.begin(), events_.end(),
                                          [&](const WireEvent& e) { return e.kind == kind; }));
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<WireMessage> messages_;
  std::vector<WireEvent> events_;
};

}  // namespace flextip::live
