#include "live/page/operator_commands.h"

namespace flextip::live {
namespace {

constexpr TimeNs kAskAgain_ns = 200'000'000;   // a robot that did not change its state
constexpr TimeNs kBlindly_ns = 1'000'000'000;  // a robot that does not say its state
constexpr TimeNs kGiveUp_ns = 10'000'000'000;  // enabling

/// The next step towards an enabled, homed robot; nothing where it is, or must not be.
std::optional<CrtkCommand> TowardsEnabled(const CrtkOperatingState& robot) {
  if (robot.is_busy) return {};
  switch (robot.state) {
    case CrtkState::kDisabled:
      return CrtkCommand::kEnable;
    case CrtkState::kPaused:
      return CrtkCommand::kResume;
    case CrtkState::kEnabled:
      if (!robot.is_homed) return CrtkCommand::kHome;
      break;
    case CrtkState::kFault:
      break;
  }
  return {};
}

}  // namespace

std::optional<CrtkCommand> OperatorCommands::Next(
    TimeNs t_ns, const std::optional<Arrived<CrtkOperatingState>>& state,
    const std::optional<CrtkCommand>& own) {
  const Wish wish = wish_;
  if (wish != last_) {
    last_ = wish;
    wished_ns_ = t_ns;
    asked_ns_ = 0;
  }
  if (wish == Wish::kNone || stop_ || own == CrtkCommand::kPause) return own;
  std::optional<CrtkCommand> command;
  if (!state) {
    if (wish == Wish::kPause && t_ns - wished_ns_ < kBlindly_ns) command = CrtkCommand::kPause;
  } else if (wish == Wish::kPause) {
    if (state->value.state == CrtkState::kEnabled) command = CrtkCommand::kPause;
  } else {
    const CrtkOperatingState& robot = state->value;
    command = TowardsEnabled(robot);
    const bool ready = robot.state == CrtkState::kEnabled && robot.is_homed && !robot.is_busy;
    if (ready || robot.state == CrtkState::kFault || t_ns - wished_ns_ > kGiveUp_ns) {
      Wish expected = Wish::kEnable;  // a pause that came meanwhile stays
      wish_.compare_exchange_strong(expected, Wish::kNone);
      return own;
    }
  }
  if (!command || t_ns - asked_ns_ < kAskAgain_ns) return {};
  asked_ns_ = t_ns;
  return command;
}

}  // namespace flextip::live
