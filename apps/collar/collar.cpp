// flextip collar: a tag collar for a shaft, ready to print, and how well it will be seen.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/collar/output.h"
#include "apps/common/commands.h"
#include "apps/common/input/camera_option.h"
#include "apps/common/length_option.h"
#include "apps/common/output.h"
#include "core/error.h"
#include "recording/streams/sensor_streams.h"
#include "recording/text/text.h"
#include "report/pages.h"
#include "targets/collar/drawing.h"
#include "targets/collar/mount.h"
#include "targets/collar/print.h"

namespace flextip {
namespace {

struct CollarOptions {
  CollarWishes wishes;
  CameraOption camera;
  ViewingConditions conditions;
  double lean_deg = 25.0;
  std::vector<double> distances_m = {0.05, 0.15};
  std::string paper = "a4";
  std::filesystem::path out;
  bool force = false;
};

constexpr int kDistances = 11;

std::vector<double> DistancesOf(const CollarOptions& options) {
  const double from = options.distances_m.front(), to = options.distances_m.back();
  if (!(from > 0.0) || from > to) {
    throw InputError(fmt::format(
        "--distances: found {:g} mm to {:g} mm, expected the nearest first", 1e3 * from, 1e3 * to));
  }
  std::vector<double> distances;
  distances.reserve(kDistances);
  for (int i = 0; i < kDistances; ++i) {
    distances.push_back(from + (to - from) * i / (kDistances - 1));
  }
  return distances;
}

void RunCollar(CollarOptions options, bool quiet) {
  options.conditions.camera = ReadCamera(options.camera);
  options.conditions.lean_rad = options.lean_deg * M_PI / 180.0;
  const CollarDesign design = DesignCollar(options.wishes);
  const auto distances_m = DistancesOf(options);
  CheckReadable(design.tag_size_m, design.cell_m, options.conditions.camera, distances_m.back());
  const auto accuracy = AccuracyOver(design.collar, options.conditions, distances_m);
  OutputFolder output(options.out, "collar",
                      {.force = options.force, .inputs = {options.camera.file}});
  const auto& folder = output.folder();
  const Paper paper = PaperOf(options.paper);
  PrintCollar(design, paper, folder / "print.pdf");
  PrintCollar(design, paper, folder / "print.png");
  DrawCollar(design, folder / "drawing.svg");
  DrawCollar(design, folder / "drawing.png");
  WriteStl(folder / "mount.stl", MountMesh(design));
  std::filesystem::create_directory(folder / "tags0");
  WriteTags(folder / "tags0", design.collar);
  WriteTextFile(folder / "accuracy.csv", AccuracyTable(accuracy));
  report::WriteFigures(folder / "figures.json", AccuracyFigures(accuracy));
  const auto summary = CollarSummary(design, options.conditions, accuracy);
  output.WriteSummary(summary);
  report::WriteReport(folder);
  const auto name = output.name();
  output.Commit();
  if (quiet) return;
  fmt::print("{}\nprint        {}\nmount        {}\ncollar file  {}\npage         {}\n",
             summary["verdict"]["says"].get<std::string>(), (name / "print.pdf").string(),
             (name / "mount.stl").string(), (name / "tags0/sensor.yaml").string(),
             (name / "report.html").string());
}

void AddDesignOptions(CLI::App& command, CollarOptions& options) {
  CollarWishes& w = options.wishes;
  AddLength(command, "--shaft", w.shaft_diameter_m, "Diameter of the shaft")->default_str("5mm");
  command.add_option("--faces", w.faces, "Faces with a tag each")->capture_default_str();
  AddLength(command, "--tag", w.tag_size_m,
            "Size of a tag between its detected corners; without it the largest that fits");
  AddLength(command, "--outer", w.outer_m,
            "Largest diameter over the corners, of the port it must pass; 12mm without --tag");
  command.add_option("--family", w.family, "Tag family")->capture_default_str();
  command.add_option("--ids", w.ids, "Ids of the tags, one a face; without it 0, 1, 2 ...")
      ->delimiter(',')
      ->type_name("ID,ID,...");
  AddLength(command, "--from-tip", w.from_tip_m, "From the tags' middles to the tip")
      ->default_str("30mm");
  AddLength(command, "--thickness", w.paper_m, "Thickness of the printed paper")
      ->default_str("0.1mm");
  AddLength(command, "--clearance", w.bore_clearance_m, "Bore less shaft, in diameter")
      ->default_str("0.1mm");
  command.add_option("--paper", options.paper, "a4, a3, letter, ...")->capture_default_str();
}

}  // namespace

void AddCollar(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand(
      "collar", "A tag collar for a shaft: print, mount, collar file, accuracy to expect");
  auto options = std::make_shared<CollarOptions>();
  command->add_option("-o,--output", options->out, "Folder for the results")
      ->required()
      ->type_name("OUT");
  AddDesignOptions(*command, *options);
  AddCameraOption(*command, options->camera);
  AddLength(*command, "--distances", options->distances_m,
            "Nearest and farthest distance from the camera to the collar")
      ->expected(2)
      ->delimiter(',')
      ->default_str("50mm,150mm");
  command->add_option("--noise", options->conditions.noise_grey, "Noise of a pixel, grey values")
      ->capture_default_str();
  command->add_option("--blur", options->conditions.blur_px, "Blur of the lens, px")
      ->capture_default_str();
  command->add_option("--lean", options->lean_deg, "Shaft out of the picture's plane, degrees")
      ->capture_default_str();
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Lengths are metres, or have their unit: 5mm.\n"
      "Examples:\n"
      "  flextip collar -o collar                            # for a shaft of 5 mm\n"
      "  flextip collar --shaft 8mm --tag 6mm --camera cam.yaml -o collar\n");
  OnRun(*command, context, [options, &context] { RunCollar(*options, context.quiet); });
}

}  // namespace flextip
