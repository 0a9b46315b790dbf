// What carries the wrist where no exact robot does.
#pragma once

#include <Eigen/Dense>
#include <functional>

#include "recording/recording.h"

namespace flextip::hidden {

class Carrier {
 public:
  /// Where the wrist is to be at a time.
  using Course = std::function<Eigen::Vector3d(double t_s)>;

  virtual ~Carrier() = default;
  /// Goes the whole course once, from `from_s` to `to_s`.
  virtual void Follow(const Course& course, double from_s, double to_s) = 0;
  /// Where it had the wrist.
  virtual Eigen::Vector3d WristAt(double t_s) const = 0;
  /// Puts its own readings in the place of wrist0's positions; wrist0 begins at `start_ns`, which
  /// is t_s = 0.
  virtual void Record(Recording& recording, TimeNs start_ns) = 0;

 protected:
  Carrier() = default;
  Carrier(const Carrier&) = delete;
  Carrier& operator=(const Carrier&) = delete;
};

}  // namespace flextip::hidden
