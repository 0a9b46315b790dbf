#include "live/loop/beat.h"

#include <cerrno>
#include <chrono>
#include <cmath>
#include <ctime>

#include "live/streams/streams.h"

namespace flextip::live {
namespace {

TimeNs Monotonic_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return TimeNs(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

void SleepUntil(TimeNs t_ns) {
  const timespec until{t_ns / 1'000'000'000, t_ns % 1'000'000'000};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

}  // namespace

ClockBeats::ClockBeats(double rate_hz)
    : period_ns_(std::llround(1e9 / rate_hz)), due_ns_(Monotonic_ns()) {}

Beat ClockBeats::Next() {
  due_ns_ += period_ns_;
  const TimeNs late_ns = Monotonic_ns() - due_ns_;
  if (late_ns >= period_ns_) {
    missed_ += late_ns / period_ns_;
    due_ns_ += late_ns / period_ns_ * period_ns_;
  }
  SleepUntil(due_ns_);
  const TimeNs woke_ns = Now_ns();
  return {woke_ns, woke_ns - (Monotonic_ns() - due_ns_), woke_ns};
}

void GivenBeats::Give(TimeNs t_ns, TimeNs arrived_ns) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    beats_.push_back({t_ns, arrived_ns, 0});
  }
  there_.notify_one();
}

std::optional<Beat> GivenBeats::Next() {
  std::unique_lock<std::mutex> lock(mutex_);
  if (!there_.wait_for(lock, std::chrono::milliseconds(50), [&] { return !beats_.empty(); }))
    return {};
  Beat beat = beats_.front();
  beats_.pop_front();
  beat.woke_ns = Now_ns();
  return beat;
}

}  // namespace flextip::live
