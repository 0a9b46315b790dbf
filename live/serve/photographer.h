// Takes the pictures of a served robot: at once, or on a thread that leaves out what it is too slow
// for. Private to serve.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "core/image.h"
#include "core/time_series.h"
#include "simulation/render/laparoscope.h"
#include "simulation/virtual_robot/virtual_robot.h"

namespace flextip::live {

class Photographer {
 public:
  using Use = std::function<void(TimeNs, Image&&)>;

  /// `use` is given each picture with the time it was due, from the thread where there is one.
  Photographer(const simulation::Laparoscope& laparoscope, bool own_thread, Use use);
  /// Finishes the picture under way.
  ~Photographer();
  Photographer(const Photographer&) = delete;
  Photographer& operator=(const Photographer&) = delete;

  /// Takes a picture, or leaves it to the thread, which takes the newest one. Throws what `use`
  /// threw, on the thread too.
  void Take(TimeNs t_ns, const simulation::PictureDue& due);

 private:
  struct Order {
    TimeNs t_ns = 0;
    simulation::PictureDue due;
  };
  void Run(const std::stop_token& stop);

  const simulation::Laparoscope& laparoscope_;
  Use use_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<Order> order_;
  std::exception_ptr error_;
  std::jthread thread_;
};

}  // namespace flextip::live
