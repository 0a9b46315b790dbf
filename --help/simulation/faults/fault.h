// Faults of sensors, robot and plant: what, where, when and how much.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace flextip::simulation {

enum class FaultKind : std::uint8_t {
  // Of a sensor's figures: its place (m), moments (Nm) or force (N).
  kStuck,        ///< repeats with new time stamps; of the tip: the picture is frozen
  kSpike,        ///< one sample is off by `size`
  kSpikes,       ///< one in five is, each another way
  kOffset,       ///< all are off by `size`
  kDrift,        ///< off by `size` a second more and more
  kScale,        ///< times `size`, about the frame's origin
  kSwappedAxes,  ///< `size` 0: y and z, 1: x and y, 2: x and z; of strain always y and z
  kUnits,        ///< times `size`, a power of 1000
  kNotFinite,    ///< NaN
  // Of its samples' times and order.
  kDelayed,     ///< arrive `size` s late with the stamps they were taken at
  kDropped,     ///< the part `size` of the samples never arrives
  kRepeated,    ///< a sample comes `size` times more, in the place of the next ones
  kOutOfOrder,  ///< every second one is `size` samples older
  kStampJump,   ///< stamps are off by `size` s
  kOtherClock,  ///< stamps run `size` times as fast from the fault's begin on
  // Of one sensor alone.
  kWrongTag,          ///< the tip is off by `size` along the shaft: a tag's pitch
  kSecondInstrument,  ///< every second tip on average is another's, which stands `size` m away
  kTagsCovered,       ///< the tip is lost
  kMetal,             ///< the field of em0 is bent by `size` m, by another place otherwise
  kGageBroken,        ///< one channel of strain stands at `size` Nm
  // Of the robot.
  kWristStands,   ///< the wrist does not follow
  kEncoderSlip,   ///< the true wrist goes `size` m aside, its readings do not; for good
  kRobotRate,     ///< its largest speed is `size` times as high
  kCommandsLost,  ///< the part `size` of the set-points never arrives
  kCycleLate,     ///< one cycle runs `size` s late
  // Of the plant.
  kPortMoved,     ///< by `size` m
  kTissueLetsGo,  ///< the tip's load is less by the part `size`
  kTipCaught,     ///< something holds the tip where it is by `size` N/m
  kShaftGrasped,  ///< a load of `size` N/m across the shaft beyond the port
};
inline constexpr int kFaultKinds = static_cast<int>(FaultKind::kShaftGrasped) + 1;

enum class FaultStream : std::uint8_t { kWrist, kTip, kEm0, kStrain, kLoad, kRobot, kPlant };
inline constexpr int kFaultStreams = static_cast<int>(FaultStream::kPlant) + 1;

const char* Name(FaultKind kind);      ///< "stuck"
const char* Name(FaultStream stream);  ///< "wrist", "tip", ...
std::optional<FaultKind> FaultKindNamed(std::string_view name);
std::optional<FaultStream> FaultStreamNamed(std::string_view name);

/// Returns whether there is such a fault.
bool CanHave(FaultStream stream, FaultKind kind);

struct Fault {
  FaultKind kind = FaultKind::kStuck;
  FaultStream stream = FaultStream::kTip;
  double start_s = 0.0;     ///< since the run's begin
  double duration_s = 0.0;  ///< means nothing to kEncoderSlip and kCycleLate
  double size = 0.0;        ///< as the kind says

  /// Returns whether it acts at `t_s`.
  bool IsActive(double t_s) const { return t_s >= start_s && t_s < start_s + duration_s; }
};

/// Returns the seed of a run's fault number `fault`: each keeps its draws whatever others there
/// are.
std::uint64_t FaultSeed(std::uint64_t seed, std::size_t fault);

}  // namespace flextip::simulation
