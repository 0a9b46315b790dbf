// The newest value of a stream between two threads, neither of which ever waits.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

namespace flextip::live {

/// One thread puts values, one other thread looks at the newest. Three places: one is written, one
/// is looked at, and the newest whole value is in the third.
template <class T>
class Newest {
 public:
  void Put(const T& value) {
    places_[writing_] = value;
    writing_ = between_.exchange(static_cast<std::uint8_t>(writing_ | kFresh)) & kPlace;
  }

  /// Returns the newest value, null before the first. It stays as it is until the next call.
  const T* Look() {
    if ((between_.load() & kFresh) != 0) {
      looking_ = between_.exchange(looking_) & kPlace;
      any_ = true;
    }
    return any_ ? &places_[looking_] : nullptr;
  }

 private:
  static constexpr std::uint8_t kFresh = 4, kPlace = 3;
  std::array<T, 3> places_{};
  std::uint8_t writing_ = 0, looking_ = 2;
  std::atomic<std::uint8_t> between_{1};
  bool any_ = false;
};

/// Values from one thread to one other, in order. Neither waits: what finds no room is dropped and
/// counted.
template <class T>
class Ring {
 public:
  explicit Ring(std::size_t capacity) : places_(capacity + 1) {}

  bool Push(const T& value) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    const std::size_t next = (end + 1) % places_.size();
    if (next == begin_.load(std::memory_order_acquire)) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    places_[end] = value;
    end_.store(next, std::memory_order_release);
    return true;
  }

  /// Calls `take(value)` for every value that is there.
  template <class Take>
  void Drain(Take take) {
    std::size_t begin = begin_.load(std::memory_order_relaxed);
    const std::size_t end = end_.load(std::memory_order_acquire);
    for (; begin != end; begin_.store(begin, std::memory_order_release)) {
      take(places_[begin]);
      begin = (begin + 1) % places_.size();
    }
  }

  long Dropped() const { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::vector<T> places_;
  std::atomic<std::size_t> begin_{0}, end_{0};
  std::atomic<long> dropped_{0};
};

}  // namespace flextip::live
