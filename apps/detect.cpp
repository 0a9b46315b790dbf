// flextip detect: tags in single images.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/next_step.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "apps/track/overlay.h"
#include "core/error.h"
#include "recording/frames/frames.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "report/pages.h"
#include "vision/tags/detector.h"

namespace flextip {
namespace {

struct DetectOptions {
  std::vector<std::filesystem::path> images;
  TagDetectorOptions detector;
  bool json = false, no_refit = false, edge_refinement = false, force = false;
  std::filesystem::path out;
};

struct DetectedImage {
  std::filesystem::path file;
  Image image;  // kept only where overlays are wanted
  int width_px = 0, height_px = 0;
  std::vector<TagDetection> tags;
};

nlohmann::json Points(const TagCorners& corners) {
  nlohmann::json points = nlohmann::json::array();
  for (const Eigen::Vector2d& c : corners) points.push_back({c.x(), c.y()});
  return points;
}

nlohmann::json ToJson(const std::vector<DetectedImage>& results) {
  nlohmann::json list = nlohmann::json::array();
  for (const DetectedImage& r : results) {
    nlohmann::json tags = nlohmann::json::array();
    for (const TagDetection& t : r.tags) {
      tags.push_back({{"id", t.id},
                      {"hamming", t.hamming},
                      {"decision_margin", t.decision_margin},
                      {"corners_px", Points(t.corners_px)},
                      {"raw_corners_px", Points(t.raw_corners_px)},
                      {"refined", t.refined}});
    }
    list.push_back({{"file", r.file.string()},
                    {"width_px", r.width_px},
                    {"height_px", r.height_px},
                    {"tags", tags}});
  }
  return list;
}

void PrintTags(const std::vector<DetectedImage>& results) {
  for (const DetectedImage& r : results) {
    fmt::print("{}: {} tags\n", r.file.string(), r.tags.size());
    for (const TagDetection& t : r.tags) {
      fmt::print("  id {:<4} margin {:6.1f} hamming {}  corners (px)", t.id, t.decision_margin,
                 t.hamming);
      for (const Eigen::Vector2d& c : t.corners_px) fmt::print("  {:.2f} {:.2f}", c.x(), c.y());
      fmt::print("\n");
    }
  }
}

std::string TagTable(const std::vector<DetectedImage>& results) {
  CsvWriter csv({"image", "id", "hamming", "decision_margin", "c0_x_px", "c0_y_px", "c1_x_px",
                 "c1_y_px", "c2_x_px", "c2_y_px", "c3_x_px", "c3_y_px", "refined"},
                false);
  for (std::size_t i = 0; i < results.size(); ++i) {
    for (const TagDetection& t : results[i].tags) {
      csv.Add(static_cast<TimeNs>(i)).Add(static_cast<TimeNs>(t.id));
      csv.Add(static_cast<TimeNs>(t.hamming)).Add(t.decision_margin);
      for (const Eigen::Vector2d& c : t.corners_px) csv.Add(c.x()).Add(c.y());
      csv.Add(static_cast<TimeNs>(t.refined));
      csv.EndRow();
    }
  }
  return csv.text();
}

void WriteResults(const DetectOptions& options, std::vector<DetectedImage>& results) {
  OutputFolder output(options.out, "detect", {.force = options.force, .inputs = options.images});
  nlohmann::json images = nlohmann::json::array();
  std::size_t tags = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    DetectedImage& r = results[i];
    DrawTags(r.image, r.tags);
    WritePng(output.folder() / "overlay" / fmt::format("{:04}_{}.png", i, r.file.stem().string()),
             r.image);
    images.push_back({{"image", r.file.filename().string()}, {"tags", r.tags.size()}});
    tags += r.tags.size();
  }
  WriteTextFile(output.folder() / "tags.csv", TagTable(results));
  output.WriteSummary({{"tags", tags}, {"family", options.detector.family}, {"images", images}});
  report::WriteDetectReport(output.folder());
  output.Commit();
}

void RunDetect(const DetectOptions& options, bool quiet) {
  TagDetectorOptions detector_options = options.detector;
  detector_options.refine_corners = !options.no_refit;
  detector_options.refine_edges = options.edge_refinement;
  TagDetector detector(detector_options);
  std::vector<DetectedImage> results;
  {
    Progress progress("images", options.images.size(), quiet);
    for (const auto& file : options.images) {
      DetectedImage r{file, ReadImageFile(file), 0, 0, {}};
      r.width_px = r.image.width_px;
      r.height_px = r.image.height_px;
      r.tags = detector.Detect(r.image);
      if (options.out.empty()) r.image = Image();
      results.push_back(std::move(r));
      progress.Update(results.size());
    }
  }
  if (!options.out.empty()) WriteResults(options, results);
  if (options.json) {
    fmt::print("{}\n", ToJson(results).dump(2));
  } else if (!quiet) {
    PrintTags(results);
    if (!options.out.empty()) PrintNextOf(options.out);
  }
}

}  // namespace

void AddDetect(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("detect", "Tags in single images");
  auto options = std::make_shared<DetectOptions>();
  command->add_option("images", options->images, "PNG or JPEG files")
      ->required()
      ->type_name("IMAGE");
  command->add_flag("--json", options->json, "Print the tags as JSON");
  command->add_option("--family", options->detector.family, "Tag family")->capture_default_str();
  command
      ->add_option("--decimate", options->detector.quad_decimate,
                   "Search at 1/this of the resolution: faster, misses small tags")
      ->capture_default_str();
  command->add_option("--threads", options->detector.threads, "Threads")->capture_default_str();
  command->add_flag("--no-refit", options->no_refit, "Keep the library's corners");
  command->add_flag("--edge-refinement", options->edge_refinement,
                    "Switch the library's own refinement on");
  command->add_option("-o,--output", options->out, "Folder for pictures, tags.csv and a report");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Corners are in pixels, (0,0) the centre of the top-left pixel, in the order bottom left,\n"
      "bottom right, top right, top left of the upright tag.\n\n"
      "Example:\n  flextip detect photo.jpg --json\n");
  OnRun(*command, context, [options, &context] { RunDetect(*options, context.quiet); });
}

}  // namespace flextip
