#include "simulation/closed_loop/replay.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>

#include "core/error.h"

namespace flextip::simulation {
namespace {

/// The newest samples at times that only go forward.
class NewestAt {
 public:
  explicit NewestAt(const Recording& recording) : recording_(recording) {}

  SensorReadings At(TimeNs t_ns) {
    const Recording& r = recording_;
    SensorReadings readings;
    if (r.wrist0) readings.wrist = Newest(*r.wrist0, r.wrist0->samples, wrist_, t_ns);
    if (r.vision0) readings.tip = Newest(*r.vision0, r.vision0->tips, tip_, t_ns);
    if (r.em0) readings.em0 = Newest(*r.em0, r.em0->samples, em0_, t_ns);
    if (r.em1) readings.em1 = Newest(*r.em1, r.em1->samples, em1_, t_ns);
    if (r.strain0) readings.strain = Newest(*r.strain0, r.strain0->moments_Nm, strain_, t_ns);
    if (r.load0) readings.load = Newest(*r.load0, r.load0->f_tip_N, load_, t_ns);
    return readings;
  }

 private:
  template <class Stream, class Value>
  static auto Newest(const Stream& stream, const Series<Value>& series, std::size_t& passed,
                     TimeNs t_ns)
      -> std::optional<Sample<decltype(Measured(stream, series.back().value))>> {
    while (passed < series.size() && series[passed].t_ns <= t_ns) ++passed;
    if (passed == 0) return {};
    return {{series[passed - 1].t_ns, Measured(stream, series[passed - 1].value)}};
  }

  const Recording& recording_;
  std::size_t wrist_ = 0, tip_ = 0, em0_ = 0, em1_ = 0, strain_ = 0, load_ = 0;
};

bool SameBits(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  for (int i = 0; i < 3; ++i)
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return false;
  return true;
}

/// Whether the recording has a picture of `t_ns`; a camera may be slower than the commands.
bool HasPicture(const Recording& recording, TimeNs t_ns) {
  if (!recording.cam0) return false;
  const auto bracket = FindBracket(recording.cam0->filenames, t_ns);
  return bracket && bracket->fraction == 0.0;
}

Frame NextFrame(FrameSource& frames, TimeNs t_ns) {
  auto frame = frames.Next();
  if (frame && frame->t_ns == t_ns) return std::move(*frame);
  throw InputError(fmt::format("the recording has no picture of the command at {} ns", t_ns));
}

}  // namespace

std::vector<ReplayedCommand> ReplayController(const Scenario& scenario, ControllerKind kind,
                                              const Recording& recording, FrameSource* frames) {
  if (!recording.command0)
    throw InputError("the recording has no command0, expected one of simulate");
  LoopSetup setup = scenario.loop;
  setup.controller.kind = kind;
  InstrumentController controller(ControllerOptionsOf(setup), setup.model ? setup.model() : nullptr,
                                  TrackerOf(setup, frames != nullptr ? &scenario.tracker : nullptr),
                                  setup.watch ? setup.watch() : nullptr);
  const PlantShape start = Plant(setup.plant, setup.plant_options).Solve(setup.p_RW_start);
  if (!start.IsUsable())
    throw InputError(fmt::format("the shaft has no equilibrium at the start: {}", start.message));
  TipPath path(setup.path, start.T_RE(), setup.update_rate_hz);
  NewestAt newest(recording);
  Eigen::Vector3d p_RE_known = Eigen::Vector3d::Zero();
  std::vector<ReplayedCommand> commands;
  for (const auto& [t_ns, p_RW] : recording.command0->p_RW) {
    ControllerInputs inputs;
    inputs.t_ns = inputs.pictures_t_ns = t_ns;
    inputs.sensors = newest.At(t_ns);
    TakeOffLatencies(setup, inputs);
    inputs.p_RE_desired = path.Advance(p_RE_known);
    inputs.d_RE_desired = path.Direction();
    Frame frame;
    const Image* pictures[] = {nullptr};
    if (frames != nullptr && HasPicture(recording, t_ns)) {
      // The loop had the tips of earlier frames; that of this one it saw in the picture.
      frame = NextFrame(*frames, t_ns);
      pictures[0] = &frame.image;
      inputs.pictures = pictures;
      inputs.sensors.tip.reset();
    }
    const ControllerCommand command = controller.Step(inputs);
    if (command.status != ControlStatus::kNoTip) p_RE_known = command.p_RE_used;
    commands.push_back({t_ns, p_RW, command.p_RW_command, SameBits(p_RW, command.p_RW_command)});
  }
  return commands;
}

}  // namespace flextip::simulation
