#include "live/serve/photographer.h"

#include <utility>

namespace flextip::live {

Photographer::Photographer(const simulation::Laparoscope& laparoscope, bool own_thread, Use use)
    : laparoscope_(laparoscope), use_(std::move(use)) {
  if (own_thread) thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
}

Photographer::~Photographer() {
  if (!thread_.joinable()) return;
  thread_.request_stop();
  thread_.join();
}

void Photographer::Take(TimeNs t_ns, const simulation::PictureDue& due) {
  if (!thread_.joinable()) {
    use_(t_ns, laparoscope_.Render(due.curve, due.number));
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    if (error_) std::rethrow_exception(error_);
    order_ = Order{t_ns, due};
  }
  changed_.notify_one();
}

void Photographer::Run(const std::stop_token& stop) {
  while (true) {
    Order order;
    {
      std::unique_lock lock(mutex_);
      if (!changed_.wait(lock, stop, [this] { return order_.has_value(); })) return;
      order = *std::exchange(order_, {});
    }
    try {
      use_(order.t_ns, laparoscope_.Render(order.due.curve, order.due.number));
    } catch (...) {
      const std::lock_guard lock(mutex_);
      error_ = std::current_exception();
      return;
    }
  }
}

}  // namespace flextip::live
