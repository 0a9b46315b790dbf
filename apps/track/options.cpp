#include "apps/track/options.h"

#include <fmt/format.h>

#include <set>
#include <string_view>
#include <system_error>

#include "apps/common/input/input_check.h"
#include "apps/common/length_option.h"
#include "core/error.h"

namespace flextip {
namespace {

void AddInputOptions(CLI::App& command, TrackOptions& options) {
  command
      .add_option("recording", options.source,
                  "Recording with cam0/ and tags0/; or a folder of pictures or a video, with "
                  "--camera and --collar")
      ->type_name("RECORDING");
  command
      .add_option("--live", options.live,
                  "A device number or URL, until Ctrl-C (a file: as without --live)")
      ->type_name("SOURCE");
  command.add_option("--camera", options.camera, "Camera file: EuRoC, Kalibr, ROS or OpenCV")
      ->type_name("FILE");
  command.add_option("--collar", options.collar, "Collar file, as a recording's tags0")
      ->type_name("FILE");
  command
      .add_option("--rate", options.rate_hz,
                  "Of plain pictures or a video; without it names in nanoseconds, the video's rate")
      ->check(CLI::PositiveNumber)
      ->type_name("HZ");
  AddCalibrationOption(command, options.calibrations);
  command.add_option("--frames", options.max_frames, "End after so many")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  command
      .add_option("--black-white", options.black_white,
                  "Values of 16-bit pictures that become 0 and 255; without it 0,65535")
      ->expected(2)
      ->delimiter(',')
      ->type_name("LOW,HIGH");
}

void AddTrackerOptions(CLI::App& command, TrackOptions& options) {
  command
      .add_option("--decimate", options.tracker.detector.quad_decimate,
                  "Search tags at 1/this of the resolution: faster, misses small ones")
      ->capture_default_str();
  command.add_option("--threads", options.tracker.detector.threads, "Threads")
      ->capture_default_str();
  command.add_flag("--no-model", options.no_model,
                   "Carry a hidden tip on by its motion alone, not by wrist0 and the shaft");
  auto* outline =
      command
          .add_option("--outline", options.end,
                      "Carry a tip whose tags are covered on by the shaft's outline; its end is "
                      "round or flat")
          ->check(CLI::IsMember({"round", "flat"}))
          ->type_name("END");
  AddLength(command, "--diameter", options.diameter_m,
            "Of the shaft as it is seen; without it the recording's outer_diameter_m")
      ->check(CLI::PositiveNumber)
      ->needs(outline);
  AddNoCheckOption(command, options.no_check);
  command.add_flag("--force", options.force, "Replace the folder of an earlier run");
  command.add_flag("--resume", options.resume, "Go on where an interrupted run ended");
}

/// A file waits for its reader: it is tracked like any video, with its own times.
void TakeLiveFileAsVideo(TrackOptions& options) {
  options.until_stopped = !options.live.empty();
  constexpr std::string_view kScheme = "file://";
  std::string_view path = options.live;
  if (path.starts_with(kScheme)) path.remove_prefix(kScheme.size());
  if (!options.source.empty() || !std::filesystem::is_regular_file(path)) return;
  options.source = path;
  options.live.clear();
}

/// Throws InputError where camera, collar and rate are given with a recording, or missing without.
void CheckSource(const TrackOptions& options) {
  const bool live = !options.live.empty();
  if (live == !options.source.empty()) {
    throw InputError(live ? "track: found a recording and --live, expected one of them"
                          : "track: expected a recording, pictures, a video or --live SOURCE");
  }
  const auto refuse = [&](const char* what) {
    throw InputError::At(live ? options.live : options.source.string(), 0, what);
  };
  const bool given = !options.camera.empty() || !options.collar.empty() || options.rate_hz > 0;
  if (options.IsRecording()) {
    if (given) {
      refuse(
          "a recording has its own camera, collar and times: --camera, --collar and --rate are "
          "for plain pictures and videos");
    }
  } else if (options.camera.empty() || options.collar.empty()) {
    refuse("is no recording, expected --camera FILE and --collar FILE with it");
  }
}

/// The first of the pictures in `folder` by its name; empty where there is none.
std::filesystem::path FirstPicture(const std::filesystem::path& folder) {
  const std::set<std::filesystem::path> endings{".png", ".jpg", ".jpeg", ".tif", ".tiff"};
  std::filesystem::path first;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (!endings.contains(entry.path().extension())) continue;
    if (first.empty() || entry.path() < first) first = entry.path();
  }
  return first;
}

}  // namespace

bool TrackOptions::IsRecording() const {
  const bool plain = !live.empty() || std::filesystem::is_regular_file(source) ||
                     (!camera.empty() && !std::filesystem::exists(source / "recording.yaml"));
  return !plain;
}

void TrackOptions::LeaveDefaultsOfPlainPictures() {
  if (!std::filesystem::exists(source / "recording.yaml")) return;
  camera.clear();
  collar.clear();
  rate_hz = 0.0;
}

std::string TrackOptions::InputName() const {
  if (!live.empty()) return live;
  return std::filesystem::weakly_canonical(source).string();
}

std::string TrackOptions::RunName() const {
  std::string name = InputName();
  for (const auto& file : calibrations) name += " with " + file.string();
  return name;
}

std::vector<std::filesystem::path> TrackOptions::Files() const {
  std::vector<std::filesystem::path> files{source, truth};
  std::erase_if(files, [](const auto& path) { return path.empty(); });
  files.insert(files.end(), calibrations.begin(), calibrations.end());
  return files;
}

CommandPaths TrackOptions::Paths() const {
  CommandPaths paths{.calibrations = calibrations};
  if (IsRecording()) paths.recording = source;
  paths.picture = FirstPicture(IsRecording() ? source / "cam0" / "data" : source);
  return paths;
}

void AddTrackOptions(CLI::App& command, TrackOptions& options) {
  AddInputOptions(command, options);
  command.add_option("-o,--output", options.out, "Folder for the results")->required();
  command.add_flag("--overlay", options.overlay, "Draw what was found into a video");
  command.add_option("--truth", options.truth, "Score against this CSV: timestamp [ns],x,y,z")
      ->type_name("FILE");
  AddTrackerOptions(command, options);
  command.footer(
      "Examples:\n"
      "a recording (both eyes where it has cam1, the wrist where it has wrist0)\n"
      "  flextip track RECORDING -o OUT --overlay\n"
      "a folder of PNG, JPEG or TIFF pictures, here of a 12-bit camera at 50 Hz\n"
      "  flextip track pictures/ --camera sensor.yaml --collar collar.yaml --rate 50 "
      "--black-white 0,4095 -o OUT\n"
      "a video\n"
      "  flextip track video.mp4 --camera camera_info.yaml --collar collar.yaml -o OUT\n"
      "a camera that is plugged in, or a stream, until Ctrl-C\n"
      "  flextip track --live 0 --camera sensor.yaml --collar collar.yaml -o OUT\n"
      "  flextip track --live rtsp://HOST/STREAM --camera sensor.yaml --collar collar.yaml -o "
      "OUT\n"
      "tags that another instrument covers for a while, on a shaft with a round end\n"
      "  flextip track RECORDING --outline round -o OUT\n"
      "after an interruption\n"
      "  flextip track RECORDING -o OUT --resume\n");
}

void CheckTrackOptions(TrackOptions& options) {
  TakeLiveFileAsVideo(options);
  const auto& range = options.black_white;
  if (!range.empty() && range[0] >= range[1]) {
    throw InputError(fmt::format("--black-white: found {},{}, expected the first below the second",
                                 range[0], range[1]));
  }
  // Recorded frames give the same tables on every machine; live ones do not wait for a search.
  options.tracker.background_detection = !options.live.empty();
  if (options.resume && !options.live.empty()) {
    throw InputError("--resume: a live source cannot be seen again");
  }
}

TrackInput OpenTrackInput(const TrackOptions& options) {
  CheckSource(options);
  TrackInputOptions how{.calibrations = options.calibrations};
  const auto& range = options.black_white;
  if (!range.empty()) how.range = {range[0], range[1]};
  if (options.IsRecording()) return OpenRecordingToTrack(options.source, how);
  CameraFiles files{.camera = options.camera, .collar = options.collar};
  if (options.rate_hz > 0) files.rate_hz = options.rate_hz;
  return options.live.empty() ? OpenPicturesToTrack(options.source, files, how)
                              : OpenCameraToTrack(options.live, files, how);
}

}  // namespace flextip
