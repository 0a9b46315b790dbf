#include "live/page/findings.h"

namespace flextip::live {
namespace {

constexpr int kShapePoints = 25, kLooksPerWorst = 6;
constexpr double kRateOver_s = 1.5;
constexpr TimeNs kMomentsKept_ns = 1'000'000'000;
constexpr std::size_t kMostMoments = 64;

/// The Jacobian that the controller inverts, whatever was seen of the tip in this cycle.
Eigen::Matrix3d JacobianOf(TipController& controller, const ControllerCommand& command) {
  ControlInput input;
  input.p_RW = command.measurements.p_RW;
  input.p_RE_desired = input.p_RE_measured = command.estimate.p_RE;
  input.tip_measured = true;
  input.model = command.estimate.model;
  return controller.Step(input).J_tip_wrist;
}

TimeNs Apart(TimeNs a_ns, TimeNs b_ns) { return a_ns < b_ns ? b_ns - a_ns : a_ns - b_ns; }

}  // namespace

PageFinder::PageFinder(const Session& session)
    : session_(session), controller_(session.task.controller) {}

bool PageFinder::Note(const PageSnapshot& snapshot) {
  if (snapshot.cycles == noted_) return false;
  noted_ = snapshot.cycles;
  heard_ = Clock::now();
  Count(snapshot.record.inputs.t_ns, snapshot.accepted);
  return true;
}

void PageFinder::Count(TimeNs t_ns, const std::array<long, kStreams>& accepted) {
  const double dt_s = 1e-9 * static_cast<double>(t_ns - counted_from_ns_);
  const bool first = counted_from_ns_ == 0 || dt_s < 0.0;
  if (!first && dt_s < kRateOver_s) return;
  for (std::size_t i = 0; i < kStreams && !first; ++i)
    findings_.rates_hz[i] = static_cast<double>(accepted[i] - counted_[i]) / dt_s;
  counted_from_ns_ = t_ns;
  counted_ = accepted;
}

const PageFindings& PageFinder::Find(const PageSnapshot& snapshot) {
  findings_.silent_s = std::chrono::duration<double>(Clock::now() - heard_).count();
  if (snapshot.cycles == found_) return findings_;
  found_ = snapshot.cycles;
  const ControllerCommand& command = snapshot.command;
  const bool has_wrist = command.status != ControlStatus::kNoWrist;
  findings_.now = {snapshot.record.inputs.t_ns, {}, snapshot.record.outputs.p_RE_goal};
  if (has_wrist) {
    findings_.now.shape = EstimatedShape(command.estimate, command.measurements.p_RW, kShapePoints);
  }
  moments_.push_back(findings_.now);
  while (moments_.front().t_ns < findings_.now.t_ns - kMomentsKept_ns ||
         moments_.size() > kMostMoments)
    moments_.pop_front();
  if (!has_wrist) findings_.worst.reset();
  if (has_wrist && looks_++ % kLooksPerWorst == 0) {
    findings_.worst =
        FindWorstMotion(JacobianOf(controller_, command), command.estimate,
                        command.measurements.p_RW, session_.task.controller, kPageDeviations);
  }
  return findings_;
}

const ShaftMoment& PageFinder::At(TimeNs t_ns) const {
  const ShaftMoment* nearest = &findings_.now;
  for (const ShaftMoment& moment : moments_)
    if (Apart(moment.t_ns, t_ns) < Apart(nearest->t_ns, t_ns)) nearest = &moment;
  return *nearest;
}

}  // namespace flextip::live
