#include "apps/control/joints.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "apps/common/output.h"
#include "arms/diagnose/model_file.h"
#include "arms/feed_forward/joint_model.h"
#include "arms/feed_forward/sampled_path.h"
#include "core/error.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"

namespace flextip {

arms::Track TrackOfJoints(const JointStream& stream) {
  const auto rows = Eigen::Index(stream.q.size());
  arms::Track track{Eigen::VectorXd(rows),
                    Eigen::MatrixXd(rows, Eigen::Index(stream.types.size()))};
  for (Eigen::Index k = 0; k < rows; ++k) {
    const auto& sample = stream.q[std::size_t(k)];
    track.t_s[k] = 1e-9 * double(sample.t_ns - stream.q.front().t_ns);
    track.values.row(k) = sample.value.transpose();
  }
  return track;
}

void RequireDesiredJoints(const Recording& wish, const std::filesystem::path& file) {
  if (wish.arm && wish.joints_command0 && !wish.joints_command0->q.empty()) return;
  throw InputError::At(file.string(), 0,
                       "no joints_command0 of an arm, expected the desired joints there");
}

void WriteJointCommands(const JointCommandsRun& run) {
  const ReadResult read = ReadRecording(run.wish);
  const Recording& wish = read.recording;
  RequireDesiredJoints(wish, run.wish);
  OutputFolder output(run.out, "control joints",
                      {.force = run.force, .inputs = {run.wish, run.model}});
  output.Warn(read.warnings);
  const arms::CommandModel model =
      arms::CommandModelOf(*wish.arm, arms::ReadArmModel(run.model), wish.gravity_m_s2);
  const arms::SampledPath path(TrackOfJoints(*wish.joints_command0));
  const arms::PathCommands commands = arms::CommandsFor(path, model.joints);
  Recording result;
  result.has_shaft = false;
  result.gravity_m_s2 = wish.gravity_m_s2;
  result.arm = wish.arm;
  result.joints_command0 = wish.joints_command0;
  for (Eigen::Index k = 0; k < commands.q.rows(); ++k)
    result.joints_command0->q[std::size_t(k)].value = commands.q.row(k).transpose();
  WriteRecording(output.folder(), result);
  const Eigen::VectorXd most =
      (commands.q - path.Rows().values).cwiseAbs().colwise().maxCoeff().transpose();
  const int limited = commands.rate_limited + commands.correction_limited;
  if (limited > 0) {
    output.Warn(
        fmt::format("limited commands: {} (the motion asks for more than a command may move, "
                    "or be off it)",
                    limited));
  }
  nlohmann::ordered_json summary = {
      {"rows", commands.q.rows()},
      {"looks_ahead_s", model.joints.delay_s},
      {"taking_up_rows", commands.taking_up},
      {"rate_limited_rows", commands.rate_limited},
      {"correction_limited_rows", commands.correction_limited},
      {"largest_correction", std::vector<double>(most.data(), most.data() + most.size())},
      {"not_corrected", model.not_corrected}};
  output.WriteSummary(summary);
  output.Commit();
  if (run.quiet) return;
  fmt::print("{} commands, {:.0f} ms ahead; {} within a play, {} limited\n", commands.q.rows(),
             1e3 * model.joints.delay_s, commands.taking_up, limited);
  for (const std::string& line : model.not_corrected) fmt::print("Not corrected: {}\n", line);
  fmt::print("{}\n", (run.out / "joints_command0").string());
}

}  // namespace flextip
