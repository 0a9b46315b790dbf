// What the groups of faults share: for the sources of this folder.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "plausibility/faults/fault.h"

namespace flextip::plausibility {

/// Gathers the faults of one scene.
class FaultList {
 public:
  explicit FaultList(const Scene& scene) : scene_(scene) {}

  const Scene& scene() const { return scene_; }
  void Add(const std::string& id, const std::string& subject, const std::string& looks,
           const std::string& mend, std::function<void(Scene&)> undo) {
    faults_.push_back({id, subject, subject + ": " + looks, mend, std::move(undo)});
  }
  std::vector<Fault> Take() { return std::move(faults_); }

  /// Returns whether a position is larger than an instrument's in metres.
  bool IsLarge(const Eigen::Vector3d& p) const {
    return p.norm() > 2.0 * scene_.instrument.length_m;
  }

 private:
  const Scene& scene_;
  std::vector<Fault> faults_;
};

/// A unit of length that is taken for metres.
struct LengthUnit {
  double factor;  ///< to metres
  const char *name, *option;
};
inline constexpr std::array<LengthUnit, 3> kLengthUnits{
    {{1e-3, "millimetres", "mm"}, {1e-2, "centimetres", "cm"}, {0.0254, "inches", "inch"}}};

// The groups, a file each.
/// Adds units, orders and signs of columns, and frames of a stream's positions.
void AddPositionFaults(FaultList& list, const std::string& stream, const std::string& columns);
/// Adds orders, inversion and axes of a stream's orientations.
void AddOrientationFaults(FaultList& list, const std::string& stream, const std::string& columns);
/// Adds inverted poses, swapped sensors and the tip's direction.
void AddSensorFaults(FaultList& list);
/// Adds the sensor's distance, the port, the shaft's length and stiffness.
void AddSettingFaults(FaultList& list);
/// Adds moments and forces.
void AddForceFaults(FaultList& list);
/// Adds the camera's pose.
void AddCameraFaults(FaultList& list);

/// Returns the change of every place of a stream by `change`. vision0's directions go along as
/// differences of places where `directions` is set.
std::function<void(Scene&)> ForEachPlace(const std::string& stream,
                                         std::function<void(Placed&)> change,
                                         bool directions = true);

}  // namespace flextip::plausibility
