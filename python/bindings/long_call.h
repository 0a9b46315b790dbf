// Calls that run without Python's lock (the GIL), so that other threads of the caller go on.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <mutex>
#include <utility>

namespace flextip::python {

/// Lets Ctrl-C end a long call. Made and used by the thread of the call, which does not hold the
/// GIL.
class Interruption {
 public:
  /// Throws Python's exception where a signal has come. Looks twenty times a second at most: taking
  /// the GIL waits for the caller's other threads.
  void Check() {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(50);
    const pybind11::gil_scoped_acquire gil;
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
  }

 private:
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now();
};

/// Returns call() made without the GIL. The call must touch no object of Python.
template <class Call>
auto WithoutGil(Call&& call) {
  const pybind11::gil_scoped_release release;
  return std::forward<Call>(call)();
}

/// An object with a memory from call to call. Threads that share it take turns.
template <class T>
class Shared {
 public:
  template <class... Args>
  explicit Shared(Args&&... args) : object_(std::forward<Args>(args)...) {}

  /// Returns call(object) made without the GIL.
  template <class Call>
  auto Use(Call&& call) {
    const pybind11::gil_scoped_release release;
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::forward<Call>(call)(object_);
  }

 private:
  std::mutex mutex_;
  T object_;
};

}  // namespace flextip::python
