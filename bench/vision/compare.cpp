// AprilTag 3, ViSP, OpenCV's ArUco and flextip on the same pictures: corners, tip, depth, recall,
// time.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cmath>
#include <fstream>
#include <opencv2/core/utility.hpp>

#include "bench/tool.h"
#include "bench/vision/pictures.h"
#include "bench/vision/rows.h"
#include "bench/vision/still.h"
#include "recording/text/text.h"

namespace flextip::bench {
namespace {

struct Arguments {
  int pictures = 12;
  std::uint64_t seed = 1;
  std::vector<double> gammas = {2.2, 1.0};
  std::filesystem::path recordings = "testdata/recordings", data;
  std::filesystem::path visp = "/usr/share/visp-images-data/ViSP-images", out;
  bool summarize = false;
};

struct Sweep {
  std::string name, unit;
  std::vector<double> values;
  double StillCase::*what;
};

const std::vector<Sweep>& Sweeps() {
  static const std::vector<Sweep> sweeps = {
      {"noise", "noise, grey levels", {1, 2.5, 4, 6, 8, 10}, &StillCase::noise_grey},
      {"angle", "view angle, degrees", {0, 15, 25, 35, 45, 55, 65, 75}, &StillCase::angle_deg},
      {"size", "side of a tag, px", {12, 16, 20, 24, 32, 45, 60, 80, 120}, &StillCase::tag_px},
      {"blur", "blur, px", {0.5, 0.8, 1.2, 1.6, 2, 2.5, 3}, &StillCase::blur_px}};
  return sweeps;
}

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--pictures", a.pictures, "For each value of a sweep")->check(CLI::PositiveNumber);
  app.add_option("--seed", a.seed, "Another one gives other pictures");
  app.add_option("--gammas", a.gammas, "Of the video")->delimiter(',');
  app.add_option("--recordings", a.recordings, "Folder with rendered (testdata/recordings)");
  app.add_option("--data", a.data, "Folder with apriltag_photos");
  app.add_option("--visp", a.visp, "Folder of ViSP's images");
  app.add_flag("--summarize", a.summarize, "Only read cases.jsonl");
  app.add_option("-o,--out", a.out, "Folder for cases.jsonl, tables (compare.md) and SVGs")
      ->required();
  app.footer("Example:\n  flextip_vision_compare --data DATA -o compare\n");
}

// Rows of this run and of runs before it in the same folder, which are not run again.
class Rows {
 public:
  explicit Rows(const std::filesystem::path& folder)
      : file_(folder / "cases.jsonl"), rows_(ReadRows(file_)) {
    std::string text;  // without a torn line
    for (const CompareRow& row : rows_) text += RowText(row) + '\n';
    WriteTextFile(file_, text);
  }
  bool Has(const std::string& sweep, double value) const {
    return std::any_of(rows_.begin(), rows_.end(), [&](const CompareRow& row) {
      return row.sweep == sweep && row.value == value;
    });
  }
  void Add(const std::vector<CompareRow>& rows) {
    std::ofstream file(file_, std::ios::app);
    for (const CompareRow& row : rows) {
      rows_.push_back(row);
      file << RowText(row) << '\n';
      fmt::print("\n{} {}, gamma {}\n\n{}", row.sweep, row.value, row.gamma, CompareTable({row}));
    }
    std::fflush(stdout);
  }
  /// In order of their values.
  std::vector<CompareRow> Of(const std::string& sweep, double gamma) const {
    std::vector<CompareRow> some;
    for (const CompareRow& row : rows_) {
      if (row.sweep == sweep && row.gamma == gamma) some.push_back(row);
    }
    std::sort(some.begin(), some.end(),
              [](const CompareRow& a, const CompareRow& b) { return a.value < b.value; });
    return some;
  }
  const std::vector<CompareRow>& All() const { return rows_; }

 private:
  std::filesystem::path file_;
  std::vector<CompareRow> rows_;
};

// One row a gamma, of the same pictures.
std::vector<CompareRow> RunStills(StillMaker& maker, const Arguments& a, const StillCase& one) {
  maker.Show(one);
  std::vector<std::vector<std::unique_ptr<VisionPeer>>> peers;
  std::vector<std::vector<PeerScore>> scores;
  for (const double gamma : a.gammas) {
    const CameraCalibration camera = maker.Camera(gamma);
    peers.push_back(MakePeers(camera, maker.Collar()));
    scores.emplace_back(peers.back().size(), PeerScore(camera, maker.Collar()));
  }
  for (int i = 0; i < a.pictures; ++i) {
    const Still still = maker.Make(i);
    for (std::size_t g = 0; g < a.gammas.size(); ++g) {
      const Image grey = maker.Film(still.light, a.gammas[g], i);
      for (std::size_t k = 0; k < peers[g].size(); ++k) {
        scores[g][k].Add(peers[g][k]->See(grey), still.truth);
      }
    }
  }
  std::vector<CompareRow> rows;
  for (std::size_t g = 0; g < a.gammas.size(); ++g) {
    rows.push_back({"base", "", 0, a.gammas[g], true, {}});
    for (std::size_t k = 0; k < peers[g].size(); ++k) {
      rows.back().peers.push_back(scores[g][k].Figures(peers[g][k]->Name()));
    }
  }
  return rows;
}

void RunSweeps(const Arguments& a, Rows& rows) {
  StillMaker maker(a.seed);
  if (!rows.Has("base", 0)) rows.Add(RunStills(maker, a, {}));
  for (const Sweep& sweep : Sweeps()) {
    for (const double value : sweep.values) {
      StillCase one;
      const bool is_base = one.*sweep.what == value;
      one.*sweep.what = value;
      if (rows.Has(sweep.name, value)) continue;
      std::vector<CompareRow> now;
      if (is_base) {
        for (const double gamma : a.gammas) now.push_back(rows.Of("base", gamma).at(0));
      } else {
        now = RunStills(maker, a, one);
      }
      for (CompareRow& row : now) {
        row.sweep = sweep.name;
        row.unit = sweep.unit;
        row.value = value;
      }
      rows.Add(now);
    }
  }
}

void RunPictures(const PictureSet& set, bool tags_alone, Rows& rows) {
  if (rows.Has(set.name, 0)) return;
  auto peers = MakePeers(set.camera, set.collar);
  if (tags_alone) peers.back() = MakeFlextipDetector(set.collar);
  CompareRow row{set.name, "", 0, set.camera.gamma.value_or(0), !tags_alone, {}};
  for (auto& peer : peers) {
    PeerScore score(set.camera, set.collar);
    for (const Picture& picture : set.pictures) {
      score.Add(peer->See(ReadGrey(picture.file)), picture.truth, tags_alone);
    }
    row.peers.push_back(score.Figures(peer->Name()));
  }
  rows.Add({row});
}

double OrNan(bool measured, double value) { return measured ? value : std::nan(""); }

void Draw(const Arguments& a, double gamma, const std::vector<CompareRow>& swept) {
  const auto draw = [&](const std::string& name, const std::string& title, const std::string& y,
                        double (*figure)(const PeerFigures&), bool log) {
    WriteTextFile(a.out / fmt::format("vision_{}_gamma{}.svg", name, gamma),
                  PlotsSvg(ComparePlots(swept, y, figure, log),
                           fmt::format("{}, video of gamma {}", title, gamma), 2));
  };
  draw(
      "tip", "Error of the tip", "tip RMS, mm",
      [](const PeerFigures& f) { return OrNan(f.GoodPoses() > 0, f.tip_rms_mm); }, true);
  draw(
      "corners", "Error of the corners that the pose says", "corner RMS, px",
      [](const PeerFigures& f) { return OrNan(f.GoodPoses() > 0, f.pose_corner_rms_px); }, true);
  draw(
      "recall", "Tags found", "part of the tags in view",
      [](const PeerFigures& f) { return f.Recall(); }, false);
}

void Summarize(const Arguments& a, const Rows& rows) {
  std::string page;
  for (const CompareRow& row : rows.All()) {
    if (!row.unit.empty()) continue;
    page +=
        fmt::format("\n### {}{}\n\n{}", row.sweep,
                    row.gamma > 0 ? fmt::format(", gamma {}", row.gamma) : "", CompareTable({row}));
  }
  for (const double gamma : a.gammas) {
    std::vector<CompareRow> swept;
    for (const Sweep& sweep : Sweeps()) {
      const std::vector<CompareRow> some = rows.Of(sweep.name, gamma);
      swept.insert(swept.end(), some.begin(), some.end());
      page += fmt::format("\n### {}, gamma {}\n\nTip RMS, mm:\n\n{}\nTags found, %:\n\n{}\n{}",
                          sweep.name, gamma, TipTable(some), RecallTable(some), CompareTable(some));
    }
    if (!swept.empty()) Draw(a, gamma, swept);
  }
  WriteTextFile(a.out / "compare.md", page);
}

void Run(Arguments& a) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  cv::setNumThreads(1);
  std::filesystem::create_directories(a.out);
  Rows rows(a.out);
  if (!a.summarize) {
    for (const PictureSet& set : RenderedPictures(a.recordings)) RunPictures(set, false, rows);
    for (const PictureSet& set : TagPictures(a.data, a.visp)) RunPictures(set, true, rows);
    RunSweeps(a, rows);
  }
  Summarize(a, rows);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv,
                                 "Ways of seeing a tag collar compared on the same pictures",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
