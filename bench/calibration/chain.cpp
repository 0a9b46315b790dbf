// Whether the chain's error budget is true: lens, hand-eye and tip calibrated again and again from
// other poses of the board and other noise, by the program's own commands, and the tip that is then
// tracked beside where it is.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bench/calibration/chain_commands.h"
#include "bench/calibration/chain_picture.h"
#include "bench/calibration/chain_record.h"
#include "bench/campaign/campaign.h"
#include "bench/tool.h"
#include "core/linear_algebra.h"

namespace flextip::bench {
namespace {

struct Arguments {
  int runs = 30, jobs = 1;
  unsigned first_seed = 1;
  std::filesystem::path out, program = FLEXTIP_PROGRAM;
  bool keep = false;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--runs", a.runs, "Repetitions")->check(CLI::PositiveNumber);
  app.add_option("--first-seed", a.first_seed, "Of poses and noise; each repetition has the next");
  app.add_option("--jobs", a.jobs, "Repetitions at a time")->check(CLI::PositiveNumber);
  app.add_option("--program", a.program, "The flextip to be judged")->check(CLI::ExistingFile);
  app.add_flag("--keep", a.keep, "Leave the recordings and results of every repetition");
  app.add_option("-o,--out", a.out, "Folder for runs.jsonl, chain.json and chain.svg")->required();
  app.footer("Example:\n  flextip_calibration_chain --runs 30 -o chain\n");
}

/// Mean of something that each repetition has one of, and how well it is known.
class RunMean {
 public:
  void Add(double value) { sum_ += value, squares_ += value * value, ++n_; }
  double Mean() const { return sum_ / n_; }
  double Error() const {
    return std::sqrt(std::max(0.0, squares_ / n_ - Mean() * Mean()) / (n_ - 1));
  }

 private:
  double sum_ = 0, squares_ = 0;
  int n_ = 0;
};

/// Length of the larger axis.
double Longest(const Eigen::Matrix2d& squares) {
  return std::sqrt(SymmetricEigenvalues(squares)[1]);
}

/// Of one part over all repetitions.
ChainPart PartOf(const std::string& name, const std::vector<ChainRun>& runs) {
  const std::size_t frames = runs.front().error_V.at(name).size();
  RunMean depth;
  Eigen::Vector2d claimed = Eigen::Vector2d::Zero();  // squares
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero(), constant = squares;
  std::vector<Eigen::Vector3d> mean(frames, Eigen::Vector3d::Zero());
  const double by_frame = 1.0 / static_cast<double>(frames),
               by_run = 1.0 / static_cast<double>(runs.size());
  for (const ChainRun& run : runs) {
    double depth_squares = 0;
    for (std::size_t i = 0; i < frames; ++i) {
      const Eigen::Vector3d& e = run.error_V.at(name)[i];
      depth_squares += by_frame * e.z() * e.z();
      squares += by_frame * by_run * e * e.transpose();
      claimed += by_frame * by_run * run.claimed_m.at(name)[i].cwiseAbs2();
      mean[i] += by_run * e;
    }
    depth.Add(depth_squares);
  }
  for (const Eigen::Vector3d& e : mean) constant += by_frame * e * e.transpose();
  ChainPart part{.name = name};
  part.depth_mm = {1e3 * std::sqrt(claimed[0]), 1e3 * std::sqrt(squares(2, 2)),
                   1e3 * std::sqrt(constant(2, 2))};
  part.across_mm = {1e3 * std::sqrt(claimed[1]), 1e3 * Longest(squares.topLeftCorner<2, 2>()),
                    1e3 * Longest(constant.topLeftCorner<2, 2>())};
  part.depth_ratio_sd = 0.5 * depth.Error() / depth.Mean() * part.depth_mm.Ratio();
  return part;
}

/// Squared errors over the claimed covariance, of three numbers: 1 where it is honest.
nlohmann::json Nees(const std::vector<ChainRun>& runs) {
  constexpr double kInside95 = 7.815;  // of chi-squared with three degrees of freedom
  RunMean nees, inside;
  for (const ChainRun& run : runs) {
    const auto& errors = run.error_V.at("total");
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const double squared = errors[i].dot(Ldlt(run.claimed_V[i]).Solve(errors[i]));
      sum += squared / 3 / static_cast<double>(errors.size());
      count += (squared < kInside95 ? 1.0 : 0.0) / static_cast<double>(errors.size());
    }
    nees.Add(sum);
    inside.Add(count);
  }
  return {
      {"nees_over_3", nees.Mean()}, {"nees_over_3_sd", nees.Error()}, {"inside_95", inside.Mean()}};
}

void Write(const std::filesystem::path& out, const std::vector<ChainRun>& runs) {
  std::vector<ChainPart> parts;
  nlohmann::json list = nlohmann::json::array();
  fmt::print("part         line of sight: claimed, true (same each time) mm, ratio; across\n");
  for (const char* name : kChainParts) {
    const ChainPart part = PartOf(name, runs);
    const auto &d = part.depth_mm, &a = part.across_mm;
    fmt::print("{:<12} {:.4f} {:.4f} ({:.4f}) {:.2f} +- {:.2f}   {:.4f} {:.4f} ({:.4f}) {:.2f}\n",
               name, d.claimed, d.measured, d.constant, d.Ratio(), part.depth_ratio_sd, a.claimed,
               a.measured, a.constant, a.Ratio());
    list.push_back({{"part", name},
                    {"depth_claimed_mm", d.claimed},
                    {"depth_true_mm", d.measured},
                    {"depth_same_each_time_mm", d.constant},
                    {"depth_ratio_sd", part.depth_ratio_sd},
                    {"across_claimed_mm", a.claimed},
                    {"across_true_mm", a.measured},
                    {"across_same_each_time_mm", a.constant}});
    parts.push_back(part);
  }
  nlohmann::json result = Nees(runs);
  fmt::print("{}\n", result.dump());
  result["parts"] = list;
  result["runs"] = runs.size();
  std::ofstream(out / "chain.json") << result.dump(1) << '\n';
  std::ofstream(out / "chain.svg") << ChainSvg(parts);
}

/// Its pictures are rendered once, for all that follow. No thread may be left where cases begin.
ChainScene SceneWithoutThreads() {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  return ChainScene({});
}

CaseResult RunOne(const Arguments& a, const ChainScene& scene, unsigned seed) {
  const auto folder = a.out / fmt::format("run{:03}", seed);
  std::filesystem::remove_all(folder);  // of a repetition that was cut off
  std::filesystem::create_directories(folder);
  const ChainRun run = RunChain(scene, a.program, folder, seed);
  if (!a.keep) std::filesystem::remove_all(folder);
  return {JsonLine(seed, run), fmt::format("{}: {} frames", seed, run.claimed_V.size())};
}

void Run(Arguments& a) {
  std::filesystem::create_directories(a.out);
  std::vector<unsigned> seeds;
  for (int i = 0; i < a.runs; ++i) seeds.push_back(a.first_seed + static_cast<unsigned>(i));
  Campaign campaign{.records = a.out / "runs.jsonl", .jobs = a.jobs};
  for (const unsigned seed : seeds) campaign.names.push_back(std::to_string(seed));
  for (const auto& [seed, run] : ReadChainRuns(campaign.records)) {
    campaign.done.insert(std::to_string(seed));
  }
  const ChainScene scene = SceneWithoutThreads();
  campaign.run = [&](std::size_t index) { return RunOne(a, scene, seeds[index]); };
  if (!RunCampaign(campaign)) return;
  const std::map<unsigned, ChainRun> done = ReadChainRuns(campaign.records);
  std::vector<ChainRun> runs;
  for (const unsigned seed : seeds) runs.push_back(done.at(seed));
  Write(a.out, runs);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool<flextip::bench::Arguments>(
      argc, argv, "Whether the chain's error budget is true", flextip::bench::AddOptions,
      flextip::bench::Run);
}
