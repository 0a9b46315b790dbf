// The way on which the wrist was sent, and whether the wrist is on it.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>
#include <optional>

#include "core/state_text.h"
#include "core/time_series.h"

namespace flextip {

/// A reading of the wrist, in R (m).
struct WristReading {
  TimeNs t_ns = 0;
  std::optional<Eigen::Vector3d> p_RW;  ///< empty: not measured
  double noise_m = 0.0;                 ///< standard deviation per axis
};

/// Keeps the commands of some seconds. Fixed size, allocates nothing. All in R (m).
class CommandedWay {
 public:
  /// Takes the robot's lag: so long ago at least it was sent where it is.
  explicit CommandedWay(double follow_lag_s) : follow_lag_s_(follow_lag_s) {}

  /// Takes the command of a cycle, and the wrist as it was measured in it.
  void Keep(const WristReading& wrist, const Eigen::Vector3d& p_RW_command);
  /// Takes another place for the newest command.
  void Replace(const Eigen::Vector3d& p_RW_command);
  bool IsEmpty() const { return count_ == 0; }

  /// Returns how far a reading may be beside the way: a servo's settling and noise.
  static double AllowedBeside_m(const WristReading& wrist);
  /// Returns how far the wrist is from the way of the lag; 0 where it was not sent for so long yet.
  double Beside_m(const WristReading& wrist) const;
  /// Returns the place nearest to `p_RW` on the way of the lag, up to the newest command `p_last`.
  Eigen::Vector3d NearestTo(const WristReading& wrist, const Eigen::Vector3d& p_last) const;
  /// Returns whether the wrist did not move for the lag though it was sent away all the time, or
  /// moved farther in a cycle than it was sent; both by more than noise.
  bool IsLeft(const WristReading& wrist) const;
  /// Returns whether the wrist stood in this cycle though it is not where it was sent.
  bool Lags(const WristReading& wrist) const;

  /// Throws InputError where the text holds no place in a ring.
  void VisitState(StateText& state);

 private:
  struct Sent {
    TimeNs t_ns = 0;
    Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();         // commanded
    Eigen::Vector3d p_RW_before = Eigen::Vector3d::Zero();  // as measured in that cycle
    void VisitState(StateText& state) {
      state(t_ns);
      state(p_RW);
      state(p_RW_before);
    }
  };
  static constexpr std::size_t kSize = 512;

  /// The command of `ago` cycles ago; 1: the newest.
  const Sent& Ago(std::size_t ago) const { return sent_[(next_ + kSize - ago) % kSize]; }

  double follow_lag_s_;
  std::array<Sent, kSize> sent_;  // a ring, the newest before next_
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace flextip
