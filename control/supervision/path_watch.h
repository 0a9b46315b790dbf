// Whether the tip keeps to the way that it was asked to go.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstddef>

#include "core/state_text.h"
#include "core/time_series.h"

namespace flextip {

/// A place with its covariance (m, m^2). In R.
struct PlaceKnown {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();

  void VisitState(StateText& state) {
    state(p);
    state(covariance_m2);
  }
};

/// Knows the wishes of the last second, where the tip is (a Kalman filter over what is seen of it
/// and how the wrist moves it), and how near it lately was to the way through the wishes. Fixed
/// size, allocates nothing. All in R (m).
class PathWatch {
 public:
  /// Takes how far the tip may be beside its way (0: as far as it likes), and the standard
  /// deviation of what its sensors are off all the while.
  PathWatch(double max_deviation_m, double tolerance_m)
      : max_deviation_m_(max_deviation_m), tolerance_m_(tolerance_m) {}

  /// Returns whether the tip, seen as `tip`, is for certain (three deviations) farther than it may
  /// be from the way through the wishes of the last second in which they moved, up to `p_wish`, and
  /// gets no nearer to it.
  /// `dp_RE`: how the wrist moved the tip since the last call, by the model.
  bool IsAstray(TimeNs t_ns, const PlaceKnown& tip, const Eigen::Vector3d& dp_RE,
                const Eigen::Vector3d& p_wish);

  /// Returns whether the tip that IsAstray was given last is more likely than not farther than it
  /// may be, and gets no nearer.
  bool MayBeAstray() const { return may_be_astray_; }

  /// Returns whether the tip that IsAstray was given last moved otherwise than the wrist moved it,
  /// in the last 0.4 s: by more than noise, three quarters of the way, and twice what it may be
  /// astray. A caught tip does, and one that is thrown.
  bool MovesOtherwise(TimeNs t_ns) const;

  /// Returns what of a `step` (m) of the tip keeps it within four fifths of what it may be beside
  /// its way, or as near as it is before the step: quarters of it; where not even one does, all but
  /// what leads away from the way. The tip is that which IsAstray was given last, moved by `before`
  /// (m): by what was commanded already.
  Eigen::Vector3d Kept(const Eigen::Vector3d& before, const Eigen::Vector3d& step) const;

  /// Lets the tip come back from where it is now: for half a second it need only get no farther.
  void ComeBack(TimeNs t_ns) {
    from_ns_ = t_ns;
    from_m_ = deviation_m_;
  }
  /// Does so once, a second after the tip was found astray: what led it astray may be over.
  void TryOnce(TimeNs t_ns);

  /// Throws InputError where the text holds no place in a ring.
  void VisitState(StateText& state);

 private:
  // A wish each thirtieth of a second: a robot may lag a second behind.
  static constexpr std::size_t kSize = 32;
  struct Wish {
    TimeNs t_ns = 0;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();

    void VisitState(StateText& state) {
      state(t_ns);
      state(p);
    }
  };

  /// The tip as it was seen, and where the wrist's motion alone has led it.
  struct Step {
    TimeNs t_ns = 0;
    PlaceKnown seen;
    Eigen::Vector3d led = Eigen::Vector3d::Zero();

    void VisitState(StateText& state) {
      state(t_ns);
      state(seen);
      state(led);
    }
  };

  void Follow(TimeNs t_ns, const PlaceKnown& seen, const Eigen::Vector3d& dp_RE);
  void Note(TimeNs t_ns, const Eigen::Vector3d& p_wish);
  Eigen::Vector3d Ahead(TimeNs t_ns, const Eigen::Vector3d& p_wish) const;
  Eigen::Vector3d NearestOnWay(const Eigen::Vector3d& p_RE) const;

  double max_deviation_m_, tolerance_m_;
  std::array<Wish, kSize> wishes_;  // a ring, the newest before next_
  std::size_t next_ = 0, count_ = 0;
  std::array<Step, kSize> steps_;  // a ring, the newest before next_step_
  Step newest_;
  std::size_t next_step_ = 0, steps_kept_ = 0;
  PlaceKnown tip_;
  Eigen::Vector3d p_wish_ = Eigen::Vector3d::Zero(), p_ahead_ = Eigen::Vector3d::Zero();  // now
  TimeNs tip_ns_ = 0;  // 0: never seen
  double deviation_m_ = 0.0;
  TimeNs from_ns_ = 0;    // of ComeBack
  TimeNs astray_ns_ = 0;  // since when; 0: it is not
  bool tried_ = false, may_be_astray_ = false;
  double from_m_ = 0.0;
  // The nearest in this span of time, in the one before, and in the one before that.
  TimeNs span_ns_ = 0;
  std::array<double, 3> nearest_m_{};
};

}  // namespace flextip
