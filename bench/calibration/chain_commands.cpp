#include "bench/calibration/chain_commands.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>

#include "core/error.h"
#include "core/rotation.h"
#include "recording/calibrations/file.h"
#include "recording/streams/sensor_streams.h"
#include "recording/text/csv.h"

namespace flextip::bench {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

/// One repetition's folder and the program that works in it.
class Workshop {
 public:
  Workshop(const fs::path& program, const fs::path& folder) : program_(program), folder_(folder) {}
  fs::path operator/(const std::string& name) const { return folder_ / name; }

  /// Runs `command` with results in `out`, its messages into a file.
  void Run(std::vector<std::string> command, const std::string& out,
           const Files& calibrations = {}) const {
    command.insert(command.begin(), program_.string());
    command.insert(command.end(), {"-o", (folder_ / out).string(), "--force", "--quiet"});
    for (const fs::path& file : calibrations) {
      command.insert(command.end(), {"--calibration", file.string()});
    }
    std::vector<char*> argv;
    argv.reserve(command.size() + 1);
    for (std::string& argument : command) argv.push_back(argument.data());
    argv.push_back(nullptr);
    const std::string log = (folder_ / (out + ".log")).string();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 2, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    pid_t child = 0;
    const int failed =
        posix_spawn(&child, program_.c_str(), &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    int status = -1;
    if (failed == 0) waitpid(child, &status, 0);
    if (status != 0)
      throw WorkError(fmt::format("{} {} failed, see {}", command[1], command[2], log));
  }

  /// Tips by time. Throws WorkError where one was not seen.
  std::map<TimeNs, Eigen::Vector3d> Track(const std::string& out, const Files& calibrations) const {
    Run({"track", (folder_ / "work").string()}, out, calibrations);
    ReadLog log;
    std::map<TimeNs, Eigen::Vector3d> tips;
    for (const auto& tip : ReadVision(folder_ / out / "vision0", log).tips) {
      if (tip.value.status != TipStatus::kOk) {
        throw WorkError(fmt::format("{}: the tip was lost", (folder_ / out).string()));
      }
      tips[tip.t_ns] = tip.value.p_RE;
    }
    return tips;
  }

 private:
  fs::path program_, folder_;
};

struct Calibrated {
  fs::path lens, hand_eye, tip, true_tip;
};

Calibrated Calibrate(const ChainScene& scene, const Workshop& shop, unsigned seed) {
  std::mt19937 random(seed);
  scene.WriteLens(shop / "lens_pictures", random);
  scene.WriteHandEye(shop / "hand_eye_recording", random);
  scene.WriteTip(shop / "tip_recording", random);
  scene.WriteWork(shop / "work", random);
  Calibrated files{shop / "lens/calibration.yaml", shop / "hand_eye/calibration.yaml",
                   shop / "tip/calibration.yaml", shop / "true_tip.yaml"};

  std::vector<std::string> camera = {"calibrate", "camera"};
  for (const auto& entry : fs::directory_iterator(shop / "lens_pictures")) {
    camera.push_back(entry.path().string());
  }
  std::sort(camera.begin() + 2, camera.end());
  camera.insert(camera.end(), {"--board", ChainScene::Board(), "--distortion", "radial-tangential",
                               "--warp", "off", "--board-error", "0"});
  shop.Run(camera, "lens");
  shop.Run({"calibrate", "hand-eye", (shop / "hand_eye_recording").string(), "--board",
            ChainScene::Board(), "--camera", (shop / "lens/cam0/sensor.yaml").string(),
            "--no-time-offset"},
           "hand_eye");
  shop.Run({"calibrate", "tip", (shop / "tip_recording").string(), "--sensor", "tags0"}, "tip",
           {files.lens, files.hand_eye});

  Calibration truth;
  truth.kind = "tip";
  truth.numbers["tags0.p_E"] = {scene.p_E().x(), scene.p_E().y(), scene.p_E().z()};
  WriteCalibration(files.true_tip, truth);
  return files;
}

/// budget.csv by time: each part's two standard deviations, and the total's covariance in R.
struct Budget {
  std::map<TimeNs, std::map<std::string, Eigen::Vector2d>> parts_m;
  std::map<TimeNs, Eigen::Matrix3d> total_R;
};

Budget ReadBudget(const fs::path& file) {
  std::vector<std::string> columns = {"timestamp [ns]"};
  for (std::string part : kChainParts) {
    std::replace(part.begin(), part.end(), ' ', '_');
    columns.push_back(part + "_depth [m]");
    columns.push_back(part + "_across [m]");
  }
  const std::size_t first = columns.size();
  for (const char* c : {"xx", "xy", "xz", "yy", "yz", "zz"}) {
    columns.push_back(fmt::format("total_cov_{} [m2]", c));
  }
  ReadLog log;
  CsvReader csv(file, columns, log, {.allow_other_columns = true});
  Budget budget;
  while (csv.Next()) {
    const TimeNs t_ns = csv.Integer(0);
    std::size_t at = 1;
    for (const char* part : kChainParts) {
      budget.parts_m[t_ns][part] = {csv.Number(at), csv.Number(at + 1)};
      at += 2;
    }
    const auto c = [&](std::size_t i) { return csv.Number(first + i); };
    budget.total_R[t_ns] << c(0), c(1), c(2), c(1), c(3), c(4), c(2), c(4), c(5);
  }
  return budget;
}

}  // namespace

ChainRun RunChain(const ChainScene& scene, const fs::path& program, const fs::path& folder,
                  unsigned seed) {
  const Workshop shop(program, folder);
  const Calibrated files = Calibrate(scene, shop, seed);
  const auto base = shop.Track("track_truth", {files.true_tip});
  std::map<std::string, std::map<TimeNs, Eigen::Vector3d>> with;
  with["lens"] = shop.Track("track_lens", {files.lens, files.true_tip});
  with["hand-eye"] = shop.Track("track_hand_eye", {files.hand_eye, files.true_tip});
  with["tip offset"] = shop.Track("track_tip", {files.tip});
  const Files all = {files.lens, files.hand_eye, files.tip};
  with["total"] = shop.Track("track", all);
  shop.Run(
      {"calibrate", "budget", (shop / "work").string(), "--tracked", (shop / "track").string()},
      "budget", all);
  const Budget budget = ReadBudget(shop / "budget/budget.csv");

  ChainRun run;
  const Pose T_CR = scene.camera().T_RC.Inverse();
  const std::vector<Eigen::Vector3d> truth = scene.Tips();
  const std::vector<TimeNs> times = scene.WorkTimes();
  for (std::size_t i = 0; i < times.size(); ++i) {
    const TimeNs t_ns = times[i];
    const Eigen::Matrix3d R_VR =
        RotationWithoutTwist((T_CR * truth[i]).normalized(), Eigen::Vector3d::UnitZ()) * T_CR.R;
    run.error_V["pixels"].emplace_back(R_VR * (base.at(t_ns) - truth[i]));
    for (const auto& [part, tips] : with) {
      const Eigen::Vector3d& from = part == "total" ? truth[i] : base.at(t_ns);
      run.error_V[part].emplace_back(R_VR * (tips.at(t_ns) - from));
    }
    for (const auto& [part, sd] : budget.parts_m.at(t_ns)) run.claimed_m[part].push_back(sd);
    run.claimed_V.emplace_back(R_VR * budget.total_R.at(t_ns) * R_VR.transpose());
  }
  return run;
}

}  // namespace flextip::bench
