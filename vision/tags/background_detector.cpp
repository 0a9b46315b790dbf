#include "vision/tags/background_detector.h"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

namespace flextip {

struct BackgroundDetector::Impl {
  explicit Impl(const TagDetectorOptions& options)
      : detector(options), worker([this](const std::stop_token& stop) { Run(stop); }) {}

  void Run(const std::stop_token& stop) {
    std::unique_lock lock(mutex);
    while (changed.wait(lock, stop, [this] { return busy && !found; })) {
      const Image picture = std::move(image);
      lock.unlock();
      Found result{t_ns, detector.Detect(picture)};
      lock.lock();
      found = std::move(result);
      busy = false;
    }
  }

  TagDetector detector;
  std::mutex mutex;
  std::condition_variable_any changed;
  bool busy = false;  // from here on guarded by the mutex
  Image image;
  TimeNs t_ns = 0;
  std::optional<Found> found;
  std::jthread worker;  // last: it uses all of the above
};

BackgroundDetector::BackgroundDetector(const TagDetectorOptions& options)
    : impl_(std::make_unique<Impl>(options)) {}
BackgroundDetector::~BackgroundDetector() = default;
BackgroundDetector::BackgroundDetector(BackgroundDetector&&) noexcept = default;
BackgroundDetector& BackgroundDetector::operator=(BackgroundDetector&&) noexcept = default;

bool BackgroundDetector::Submit(const Image& image, TimeNs t_ns) {
  const std::lock_guard lock(impl_->mutex);
  if (impl_->busy) return false;
  impl_->image = image;
  impl_->t_ns = t_ns;
  impl_->found.reset();
  impl_->busy = true;
  impl_->changed.notify_one();
  return true;
}

std::optional<BackgroundDetector::Found> BackgroundDetector::Take() {
  const std::lock_guard lock(impl_->mutex);
  return std::exchange(impl_->found, std::nullopt);
}

}  // namespace flextip
