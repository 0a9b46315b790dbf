// flextip convert: files of other programs, one sub-command a kind.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "core/error.h"
#include "recording/cameras/camera_formats.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

struct ConvertOptions {
  fs::path in, out;
  std::string from, to;
  CameraFileChoice choice;
  std::vector<int> resolution;
  std::vector<std::string> drop;
  bool force = false;
};

constexpr CameraFormat kFormats[] = {CameraFormat::kEuroc, CameraFormat::kKalibr,
                                     CameraFormat::kRos, CameraFormat::kOpenCv};

CameraFormat FormatOf(const std::string& name) {
  const auto* found = std::find_if(std::begin(kFormats), std::end(kFormats),
                                   [&](CameraFormat f) { return name == Name(f); });
  if (found == std::end(kFormats)) {
    throw InputError(fmt::format("format '{}': expected euroc, kalibr, ros or opencv", name));
  }
  return *found;
}

// By the names the programs give their files.
CameraFormat GuessTarget(const fs::path& out) {
  const std::string name = out.filename().string(), extension = out.extension().string();
  const auto has = [&](const char* part) { return name.find(part) != std::string::npos; };
  if (extension == ".xml" || extension == ".json" || extension == ".yml") {
    return CameraFormat::kOpenCv;
  }
  if (name == "sensor.yaml") return CameraFormat::kEuroc;
  if (has("camchain")) return CameraFormat::kKalibr;
  if (has("camera_info")) return CameraFormat::kRos;
  throw InputError::At(out.string(), 0,
                       "the name does not say which format is wanted, expected --to euroc, kalibr, "
                       "ros or opencv");
}

// Takes what may be dropped out of the description's list; the rest is refused in one line.
void RefuseLosses(const ConvertOptions& options, CameraFormat to, const CameraDescription& d) {
  std::string losses, names;
  bool droppable = true;
  for (const CameraLoss& loss : LossesIn(to, d)) {
    const bool dropped = std::count(options.drop.begin(), options.drop.end(), loss.name) > 0;
    if (!loss.name.empty() && dropped) continue;
    losses += (losses.empty() ? "" : "; ") + loss.what;
    droppable = droppable && !loss.name.empty();
    if (("," + names + ",").find("," + loss.name + ",") == std::string::npos) {
      names += (names.empty() ? "" : ",") + loss.name;
    }
  }
  if (losses.empty()) return;
  const std::string way = droppable ? fmt::format(" (--drop {} leaves it out)", names) : "";
  throw InputError::At(
      options.in.string(), 0,
      fmt::format("not converted to {}, which would lose: {}{}", Name(to), losses, way));
}

void RunConvertCamera(ConvertOptions options, bool quiet) {
  if (!options.resolution.empty()) {
    options.choice.width_px = options.resolution[0];
    options.choice.height_px = options.resolution[1];
  }
  const auto from = options.from.empty() ? GuessCameraFormat(options.in) : FormatOf(options.from);
  const auto to = options.to.empty() ? GuessTarget(options.out) : FormatOf(options.to);
  if (fs::exists(options.out) && !options.force) {
    throw InputError::At(options.out.string(), 0, "exists; --force replaces it");
  }
  const CameraDescription camera = ReadCameraDescription(options.in, from, options.choice);
  RefuseLosses(options, to, camera);
  WriteCameraDescription(options.out, to, camera);
  if (quiet) return;
  for (const auto& note : camera.notes) fmt::print("left out: {}\n", note);
  fmt::print("{} ({}) from {} ({})\n", options.out.string(), Name(to), options.in.string(),
             Name(from));
}

void AddConvertCamera(CLI::App& convert, AppContext& context) {
  auto* command = convert.add_subcommand("camera", "A camera's calibration");
  auto options = std::make_shared<ConvertOptions>();
  const auto formats = CLI::IsMember({"euroc", "kalibr", "ros", "opencv"});
  command->add_option("in", options->in, "File to read")->required()->type_name("IN");
  command->add_option("out", options->out, "File to write")->required()->type_name("OUT");
  command->add_option("--from", options->from, "Format of IN; without it by what is in it")
      ->check(formats)
      ->type_name("FORMAT");
  command->add_option("--to", options->to, "Format of OUT; without it by its name")
      ->check(formats)
      ->type_name("FORMAT");
  command->add_option("--camera", options->choice.camera, "Which one of a camchain")
      ->type_name("NAME");
  command->add_option("--resolution", options->resolution, "Where IN does not state it (OpenCV)")
      ->expected(2)
      ->delimiter(',')
      ->check(CLI::Range(1, 100'000))
      ->type_name("W,H");
  command
      ->add_option("--drop", options->drop, "What may be lost: pose, gamma, or a key of the file")
      ->delimiter(',')
      ->type_name("WHAT");
  command->add_flag("--force", options->force, "Replace OUT");
  command->footer(
      "Formats: euroc (sensor.yaml, also a recording's), kalibr (camchain), ros (camera_info) and\n"
      "opencv (FileStorage). What OUT has no place for is named, and nothing is written.\n\n"
      "Example:\n  flextip convert camera camchain.yaml sensor.yaml --camera cam0\n");
  OnRun(*command, context, [options, &context] { RunConvertCamera(*options, context.quiet); });
}

}  // namespace

void AddConvert(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("convert", "Read and write files of other programs");
  command->require_subcommand(1);
  command->footer("Example:\n  flextip convert camera --help\n");
  AddConvertCamera(*command, context);
}

}  // namespace flextip
