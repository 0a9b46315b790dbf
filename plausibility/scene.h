// A recording at a few instants, all streams side by side: small enough to be tried in many
// changed forms.
#pragma once

#include <Eigen/Dense>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace flextip::plausibility {

/// A sensor's place and orientation in R.
struct Placed {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  std::optional<Eigen::Quaterniond> q;
};

/// The shaft's end as seen.
struct Seen {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> d;
  std::optional<Eigen::Vector3d> sight;  ///< along which it is known worst, where that is clear
};

struct Instant {
  TimeNs t_ns = 0;
  std::optional<Placed> wrist, em0, em1;
  std::optional<Seen> tip;
  std::optional<Eigen::Vector4d> strain_Nm;
  std::optional<Eigen::Vector3d> load_N, command;
};

struct Scene {
  Instrument instrument;
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d::Zero();
  double em0_from_tip_m = 0.0;
  double station_m[2] = {0.0, 0.0};  ///< of strain0, from the wrist
  double strain_noise_Nm = 0.0, load_noise_N = 0.0;
  double em0_registration_m = 0.0, tip_registration_m = 0.0;  ///< at the shaft's end
  double wrist_step_m = 0.0;  ///< root mean square way of the wrist in a step of command0
  std::optional<CameraCalibration> camera;
  std::vector<std::string> streams;  ///< of the recording, in its order
  std::vector<Instant> instants;
  std::set<std::string> unknown;  ///< subjects that relations are not to be about (Relation::about)

  bool Has(const std::string& stream) const;
  double EmAt() const { return instrument.length_m - em0_from_tip_m; }  ///< em0 from the wrist
};

/// Clock corrections: seconds to add to a stream's time stamps.
using Shifts = std::map<std::string, double>;

/// Returns the recording at `count` samples of its wrist (fewer where there are fewer). Empty of
/// instants without a wrist.
Scene TakeScene(const Recording& recording, const Shifts& shifts_s = {}, int count = 80);

/// Returns the place (m, in R) that wrist0, command0, em0, em1 or vision0 has at `t_ns` by its own
/// clock; empty outside its times and where the tip is lost.
std::optional<Eigen::Vector3d> PlaceAt(const Recording& recording, const std::string& stream,
                                       TimeNs t_ns);

/// Returns all streams at time `t_ns` (of the wrist's clock), each with its clock corrected.
Instant InstantAt(const Recording& recording, TimeNs t_ns, const Shifts& shifts_s = {});

}  // namespace flextip::plausibility
