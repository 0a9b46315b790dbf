// Chapter 4's controllers and those that it could have had, on the sensors of its set-up. All move
// in the x-y plane and track the tip. Private to reproduction.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "core/instrument.h"
#include "estimation/measurements.h"

namespace flextip::reproduction {

enum class Ch4Kind : std::uint8_t {
  kStraight,         ///< the lever's Jacobian, the port known
  kPrinted,          ///< the beam's, (3.15)-(3.26) as printed
  kPrintedWithLine,  ///< the same with phi as the angle of the line from wrist to port
  kPortForce,        ///< the beam's, corrected, F_p constant
  kTipForce,         ///< the beam's, corrected, F_t constant
  kRod,              ///< exact rod; tip by all sensors together
};
inline constexpr std::array<Ch4Kind, 6> kCh4Kinds = {Ch4Kind::kStraight,        Ch4Kind::kPrinted,
                                                     Ch4Kind::kPrintedWithLine, Ch4Kind::kPortForce,
                                                     Ch4Kind::kTipForce,        Ch4Kind::kRod};
const char* Name(Ch4Kind kind);

struct Ch4Setup {
  Instrument instrument;
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();  ///< port, as registered
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d::Zero();
  bool tissue = false;  ///< the load may change with the tip; the rod's estimator looks for that
};

struct Ch4Step {
  Eigen::Vector3d wrist_step = Eigen::Vector3d::Zero();  ///< (5.1)
  Eigen::Vector3d p_RE_known = Eigen::Vector3d::Zero();  ///< the known tip before the step
  bool straight_instead = false;                         ///< no flexion to be seen, or no beam fits
};

class Ch4Controller {
 public:
  Ch4Controller(Ch4Kind kind, const Ch4Setup& setup);
  Ch4Controller(Ch4Controller&&) noexcept;
  Ch4Controller& operator=(Ch4Controller&&) noexcept;
  ~Ch4Controller();

  /// From one set of sensor values: `em` on the tip itself, the wrist's orientation, and either the
  /// shaft's direction at the port (4.2, first method) or `strain` (second method). `p_RE`: the tip
  /// for (5.2), where it is not what these say.
  Ch4Step Step(const Measurements& z, const Eigen::Vector3d& p_RE_desired,
               const std::optional<Eigen::Vector3d>& p_RE = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace flextip::reproduction
