// AprilTag 3, ViSP, OpenCV's ArUco and flextip on the same pictures: corners, tip, depth, recall,
// time.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <opencv2/core/utility.hpp>

#include "bench/tool.h"
#include "bench/vision_pictures.h"
#include "bench/vision_still.h"
#include "recording/text.h"

namespace flextip {
namespace {

struct Arguments {
  int pictures = 40;
  std::uint64_t seed = 1;
  std::vector<std::string> sweeps = {"size", "blur", "noise", "angle", "base"};
  std::vector<double> gammas = {2.2, 1.0};
  std::filesystem::path data, visp = "/usr/share/visp-images-data/ViSP-images", out;
};

struct Sweep {
  std::string name, unit;
  std::vector<double> values;
  double StillCase::*what;
};

const std::vector<Sweep>& Sweeps() {
  static const std::vector<Sweep> sweeps = {
      {"base", "gamma", {}, &StillCase::gamma},
      {"size", "side of a tag, px", {12, 16, 20, 24, 32, 45, 60, 80, 120}, &StillCase::tag_px},
      {"blur", "blur, px", {0.5, 0.8, 1.2, 1.6, 2, 2.5, 3}, &StillCase::blur_px},
      {"noise", "noise, grey levels", {1, 2.5, 4, 6, 8, 10}, &StillCase::noise_grey},
      {"angle", "view angle, degrees", {0, 15, 25, 35, 45, 55, 65, 75}, &StillCase::angle_deg}};
  return sweeps;
}

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--pictures", a.pictures, "For each value of a sweep")->check(CLI::PositiveNumber);
  app.add_option("--seed", a.seed, "Another one gives other pictures");
  app.add_option("--sweeps", a.sweeps, "base,size,blur,noise,angle")->delimiter(',');
  app.add_option("--gammas", a.gammas, "Of the video")->delimiter(',');
  app.add_option("--data", a.data, "Folder with rendered_sample and apriltag_photos");
  app.add_option("--visp", a.visp, "Folder of ViSP's images");
  app.add_option("-o,--out", a.out, "Folder for compare.json, compare.md and SVGs")->required();
  app.footer("Example:\n  flextip_vision_compare --data DATA -o compare\n");
}

CompareRow RunStills(const StillCase& one, const Arguments& a, const Sweep& sweep, double value) {
  const StillMaker maker(one, a.seed);
  auto peers = MakePeers(maker.Camera(), maker.Collar());
  std::vector<PeerScore> scores(peers.size(), PeerScore(maker.Camera(), maker.Collar()));
  for (int i = 0; i < a.pictures; ++i) {
    const Still still = maker.Make(i);
    for (std::size_t k = 0; k < peers.size(); ++k)
      scores[k].Add(peers[k]->See(still.grey), still.truth);
  }
  CompareRow row{sweep.name, sweep.unit, value, {}};
  for (std::size_t k = 0; k < peers.size(); ++k) {
    row.peers.push_back(scores[k].Figures(peers[k]->Name()));
  }
  return row;
}

CompareRow RunPictures(const PictureSet& set, bool tags_alone) {
  auto peers = MakePeers(set.camera, set.collar);
  if (tags_alone) peers.back() = MakeFlextipDetector(set.collar);
  CompareRow row{set.name, "", 0, {}};
  for (auto& peer : peers) {
    PeerScore score(set.camera, set.collar);
    for (const Picture& picture : set.pictures) {
      score.Add(peer->See(ReadGrey(picture.file)), picture.truth, tags_alone);
    }
    row.peers.push_back(score.Figures(peer->Name()));
  }
  return row;
}

void Report(const CompareRow& row, const std::string& title, bool with_pose, std::string& page) {
  const std::string text = fmt::format("\n{}\n\n{}", title, CompareTable(row, with_pose));
  fmt::print("{}", text);
  std::fflush(stdout);
  page += text;
}

void RunSweeps(const Arguments& a, double gamma, std::string& page) {
  std::vector<CompareRow> rows;
  for (const Sweep& sweep : Sweeps()) {
    if (std::count(a.sweeps.begin(), a.sweeps.end(), sweep.name) == 0) continue;
    const std::vector<double> values =
        sweep.values.empty() ? std::vector<double>{gamma} : sweep.values;
    for (const double value : values) {
      StillCase one;
      one.gamma = gamma;
      one.*sweep.what = value;
      rows.push_back(RunStills(one, a, sweep, value));
      Report(rows.back(),
             fmt::format("### gamma {}, {} {} ({})", gamma, sweep.name, value, sweep.unit), true,
             page);
    }
  }
  const std::string tag = fmt::format("gamma{}", gamma);
  WriteTextFile(a.out / ("sweeps_" + tag + ".json"), CompareJson(rows));
  std::erase_if(rows, [](const CompareRow& row) { return row.sweep == "base"; });
  const auto draw = [&](const std::string& name, const std::string& title, const std::string& y,
                        double (*figure)(const PeerFigures&), bool log) {
    if (rows.empty()) return;
    WriteTextFile(a.out / (name + "_" + tag + ".svg"),
                  PlotsSvg(ComparePlots(rows, y, figure, log),
                           fmt::format("{}, video of gamma {}", title, gamma), 2));
  };
  draw(
      "tip", "Error of the tip", "tip RMS, mm", [](const PeerFigures& f) { return f.tip_rms_mm; },
      true);
  draw(
      "corners", "Error of the corners found", "corner RMS, px",
      [](const PeerFigures& f) { return f.corner_rms_px; }, true);
  draw(
      "recall", "Tags found", "part of the tags in view",
      [](const PeerFigures& f) { return f.Recall(); }, false);
}

void Run(Arguments& a) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  cv::setNumThreads(1);
  std::filesystem::create_directories(a.out);
  std::string page;
  std::vector<CompareRow> rows;
  const auto sample = a.data.empty() ? std::vector<PictureSet>{} : RenderedSample(a.data);
  if (sample.empty()) page += "\nThe rendered sample is absent.\n";
  for (const PictureSet& set : sample) {
    rows.push_back(RunPictures(set, false));
    Report(rows.back(), "### " + set.name, true, page);
  }
  const auto photos = TagPictures(a.data, a.visp);
  if (photos.empty()) page += "\nNo photographs are there.\n";
  for (const PictureSet& set : photos) {
    rows.push_back(RunPictures(set, true));
    Report(rows.back(), "### " + set.name, false, page);
  }
  WriteTextFile(a.out / "pictures.json", CompareJson(rows));
  for (const double gamma : a.gammas) RunSweeps(a, gamma, page);
  WriteTextFile(a.out / "compare.md", page);
}

}  // namespace
}  // namespace flextip

int main(int argc, char** argv) {
  return flextip::RunTool(argc, argv, "Ways of seeing a tag collar compared on the same pictures",
                          flextip::AddOptions, flextip::Run);
}
