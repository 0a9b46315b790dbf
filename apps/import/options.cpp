#include "apps/import/options.h"

#include <fmt/format.h>

#include <functional>
#include <map>
#include <utility>

#include "apps/common/vector_option.h"
#include "core/error.h"
#include "exchange/mapping_file.h"
#include "exchange/sensor_settings.h"
#include "exchange/tables/times.h"
#include "exchange/tables/units.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using exchange::ImportPlan;
using exchange::StreamPlan;

using Parts = std::pair<std::string, std::string>;

// "em0=mm" at the first `sign`.
Parts SplitAt(const std::string& option, const std::string& text, char sign,
              const std::string& form) {
  const auto at = text.find(sign);
  if (at == std::string::npos || at == 0 || at + 1 == text.size()) {
    throw InputError(fmt::format("{}: found '{}', expected {}", option, text, form));
  }
  return {text.substr(0, at), text.substr(at + 1)};
}

// The stream's plan; cam0 is the video's file of times.
StreamPlan& StreamOf(ImportPlan& plan, const std::string& option, const std::string& name) {
  if (name == "cam0" && plan.video) return plan.video->times;
  if (!exchange::IsTableStream(name)) {
    throw InputError(fmt::format("{}: found the stream '{}', expected {}", option, name,
                                 exchange::TableStreamsText()));
  }
  return plan.streams[name];
}

void TellUnit(ImportPlan& plan, const std::string& text) {
  const auto [name, unit_name] = SplitAt("--unit", text, '=', "STREAM=UNIT, as em0=mm");
  StreamPlan& stream = StreamOf(plan, "--unit", name);
  auto unit = exchange::ParseUnit(unit_name);
  if (name == "strain0") {
    if (const auto moment = exchange::ParseUnit(unit_name, "moment")) unit = moment;
  }
  if (!unit) {
    throw InputError(
        fmt::format("--unit: found '{}', expected a unit like mm, ms, deg, N or Nm", unit_name));
  }
  stream.units[unit->kind] = unit->name;
  plan.Told(fmt::format("{}.units.{}", name, unit->kind));
}

void TellOffset(ImportPlan& plan, const std::string& text) {
  const bool of_video = plan.video && text.find('=') == std::string::npos;
  const auto [name, seconds] = of_video
                                   ? Parts{"cam0", text}
                                   : SplitAt("--offset", text, '=', "STREAM=SECONDS, as em0=12.3");
  const auto offset = exchange::DecimalTime(seconds, "s");
  if (!offset) throw InputError(fmt::format("--offset: found '{}', expected seconds", seconds));
  if (name == "cam0" && plan.video) {
    plan.video->offset_ns = *offset;
  } else {
    StreamOf(plan, "--offset", name).offset_ns = *offset;
  }
}

void TellQuaternion(ImportPlan& plan, const std::string& text) {
  const auto [name, order] = SplitAt("--quaternion", text, '=', "STREAM=wxyz or STREAM=xyzw");
  if (order != "wxyz" && order != "xyzw") {
    throw InputError(fmt::format("--quaternion: found '{}', expected wxyz or xyzw", order));
  }
  StreamOf(plan, "--quaternion", name).quaternion = order;
  plan.Told(name + ".quaternion");
}

void TellStreams(const ImportOptions& options, ImportPlan& plan) {
  const auto each = [](const std::vector<std::string>& texts, const auto& tell) {
    for (const auto& text : texts) tell(text);
  };
  each(options.streams, [&](const std::string& text) {
    const auto [name, file] = SplitAt("--stream", text, '=', "STREAM=FILE, as em0=tracker.csv");
    if (!exchange::IsTableStream(name)) {
      throw InputError(fmt::format("--stream: found the stream '{}', expected {}", name,
                                   exchange::TableStreamsText()));
    }
    plan.streams[name].file = file;
    plan.Told(name + ".file");
  });
  each(options.units, [&](const std::string& text) { TellUnit(plan, text); });
  each(options.offsets, [&](const std::string& text) { TellOffset(plan, text); });
  each(options.quaternions, [&](const std::string& text) { TellQuaternion(plan, text); });
  each(options.orientations, [&](const std::string& text) {
    const auto [name, kind] = SplitAt("--orientation", text, '=', "STREAM=KIND");
    StreamOf(plan, "--orientation", name).orientation = kind;
    plan.Told(name + ".orientation");
  });
  each(options.columns, [&](const std::string& text) {
    const std::string form = "STREAM.ROLE=COLUMN, as em0.x=Tx";
    const auto [place, column] = SplitAt("--column", text, '=', form);
    const auto [name, role] = SplitAt("--column", place, '.', form);
    StreamOf(plan, "--column", name).columns[role] = column;
  });
  each(options.skip_missing, [&](const std::string& name) {
    StreamOf(plan, "--skip-missing", name).skip_missing = true;
  });
  each(options.sets, [&](const std::string& text) {
    const std::string form = "STREAM.KEY=VALUE, as em0.position_noise_m=1e-4";
    const auto [place, value] = SplitAt("--set", text, '=', form);
    const auto [name, key] = SplitAt("--set", place, '.', form);
    exchange::TellSensor(plan, "--set", name, key, value);
  });
}

void TellInstrument(const ImportOptions& options, ImportPlan& plan) {
  const auto tell = [&](const auto& value, auto& place, const std::string& key) {
    if (!value) return;
    place = value;
    plan.Told(key);
  };
  tell(options.length_m, plan.length_m, "instrument.length_m");
  tell(options.diameter_m, plan.outer_diameter_m, "instrument.outer_diameter_m");
  tell(options.stiffness_Nm2, plan.bending_stiffness_Nm2, "instrument.bending_stiffness_Nm2");
  tell(options.mass_per_length_kg_m, plan.mass_per_length_kg_m, "instrument.mass_per_length_kg_m");
  tell(options.port, plan.p_RP, "port.position_m");
  tell(options.gravity, plan.gravity_m_s2, "gravity_m_s2");
}

void TellVideo(const ImportOptions& options, ImportPlan& plan) {
  if (options.video.empty()) return;
  if (!plan.video) plan.video.emplace();
  exchange::VideoPlan& video = *plan.video;
  video.file = options.video;
  const auto take = [](const fs::path& told, fs::path& place) {
    if (!told.empty()) place = told;
  };
  take(options.camera, video.camera);
  take(options.collar, video.collar);
  if (!options.pose.empty() || options.no_pose) {
    video.pose = options.pose;
    video.without_pose = options.no_pose;
    plan.Told("cam0.T_RC");
  }
  if (!options.times.empty()) {
    video.times.file = options.times;
    video.start.clear();
    video.rate_hz.reset();
  }
  if (!options.start.empty()) {
    video.start = options.start;
    plan.Told("cam0.start");
  }
  if (options.rate_hz) {
    video.rate_hz = options.rate_hz;
    plan.Told("cam0.frame_rate_hz");
  }
  video.link = video.link || options.link;
}

// A file of a mapped name takes the mapped one's place: the same mapping for another session.
void TellFiles(const ImportOptions& options, ImportPlan& plan) {
  for (const auto& file : options.files) {
    bool mapped = false;
    for (auto& [name, stream] : plan.streams) {
      if (stream.file.filename() != file.filename()) continue;
      stream.file = file;
      mapped = true;
    }
    if (!mapped) plan.files.push_back(file);
  }
}

template <class T>
void AddNumber(CLI::App& command, const std::string& name, T& value, const std::string& text) {
  command.add_option(name, value, text)->check(CLI::PositiveNumber);
}

void AddPlace(CLI::App& command, const std::string& name, std::optional<Eigen::Vector3d>& value,
              const std::string& description) {
  const auto take = [&value, name](const std::string& text) {
    value = ParseVector(text);
    if (!value) throw CLI::ValidationError(name, "'" + text + "' is not x,y,z");
  };
  command.add_option_function<std::string>(name, take, description)->type_name("X,Y,Z");
}

void AddList(CLI::App& command, const std::string& name, std::vector<std::string>& values,
             const std::string& form, const std::string& description) {
  command.add_option(name, values, description)->allow_extra_args(false)->type_name(form);
}

}  // namespace

void AddImportOptions(CLI::App& command, ImportOptions& options) {
  command.add_option("-o,--output", options.out, "Recording to make")
      ->required()
      ->type_name("RECORDING");
  AddList(command, "--stream", options.streams, "STREAM=FILE",
          "The table of a stream: " + exchange::TableStreamsText());
  command.add_option("--map", options.map, "A mapping file, as import.yaml of an earlier import")
      ->type_name("FILE.yaml");
  command
      .add_option("--settings", options.settings,
                  "Instrument, port and sensors; a recording.yaml is one")
      ->type_name("FILE.yaml");
  AddNumber(command, "--length", options.length_m, "Wrist to tip along the shaft (m)");
  AddNumber(command, "--diameter", options.diameter_m, "Outer diameter (m)");
  AddNumber(command, "--stiffness", options.stiffness_Nm2, "Bending stiffness E I (N m2)");
  command
      .add_option("--mass-per-length", options.mass_per_length_kg_m,
                  "Of the shaft (kg/m); 0: weight is not modelled")
      ->check(CLI::NonNegativeNumber);
  AddPlace(command, "--port", options.port, "The port's place in R (m)");
  AddPlace(command, "--gravity", options.gravity, "Gravity in R (m/s2)");
  AddList(command, "--set", options.sets, "STREAM.KEY=VALUE",
          "A setting of a sensor: em0.distance_from_tip_m=0.02, wrist0.position_noise_m=1e-4");
  AddList(command, "--unit", options.units, "STREAM=UNIT",
          "Unit of a stream's columns: em0=mm, em0=ms (its times), em0=deg, load0=mN");
  AddList(command, "--quaternion", options.quaternions, "STREAM=ORDER",
          "Order of a quaternion's columns: em0=wxyz or em0=xyzw");
  AddList(command, "--orientation", options.orientations, "STREAM=KIND",
          "quaternion, matrix, rotation-vector, or euler-zyx (any order of three axes)");
  AddList(command, "--offset", options.offsets, "STREAM=SECONDS",
          "Added to the times of a stream: em0=12.3");
  AddList(command, "--column", options.columns, "STREAM.ROLE=COLUMN",
          "A column by its name, or its number from 1: em0.x=Tx, em0.t=1");
  AddList(command, "--skip-missing", options.skip_missing, "STREAM",
          "Leave out rows of this stream with empty or NaN values, and count them");
  command.add_flag("--force", options.force, "Replace the folder of an earlier run");
}

void AddVideoOptions(CLI::App& command, ImportOptions& options) {
  command.add_option("video", options.video, "Video file")->required()->type_name("FILE");
  command.add_option("--camera", options.camera, "Camera: EuRoC, Kalibr, ROS or OpenCV")
      ->type_name("FILE");
  command.add_option("--collar", options.collar, "Tags on the instrument (a tags0/sensor.yaml)")
      ->type_name("FILE");
  auto* pose = command.add_option("--pose", options.pose,
                                  "The camera's pose: a file with T_RC, or a calibration.yaml");
  pose->type_name("FILE");
  command
      .add_flag("--no-pose", options.no_pose,
                "The camera's pose is not known: R is the camera's own frame")
      ->excludes(pose);
  auto* times = command.add_option("--times", options.times,
                                   "Times of the frames: one a line, or a table with a column");
  times->type_name("FILE");
  command.add_option("--start", options.start, "Time of the first frame: seconds or clock text")
      ->excludes(times)
      ->type_name("TIME");
  command.add_option("--rate", options.rate_hz, "Frames a second")
      ->check(CLI::PositiveNumber)
      ->excludes(times);
  command.add_flag("--link", options.link, "Link the video into the recording, do not copy it");
}

ImportPlan PlanOf(const ImportOptions& options) {
  ImportPlan plan;
  if (!options.map.empty()) exchange::ReadMapping(options.map, plan);
  if (!options.settings.empty()) exchange::ReadMapping(options.settings, plan);
  TellVideo(options, plan);
  TellFiles(options, plan);
  TellStreams(options, plan);
  TellInstrument(options, plan);
  return plan;
}

std::vector<fs::path> FilesOf(const ImportPlan& plan, const ImportOptions& options) {
  std::vector<fs::path> files = plan.files;
  const auto add = [&](const fs::path& file) {
    if (!file.empty()) files.push_back(file);
  };
  add(options.map);
  add(options.settings);
  for (const auto& [name, stream] : plan.streams) add(stream.file);
  if (plan.video) {
    const auto& video = *plan.video;
    for (const auto* file :
         {&video.file, &video.camera, &video.collar, &video.pose, &video.times.file}) {
      add(*file);
    }
  }
  return files;
}

std::string OptionFor(const std::string& key) {
  static const std::map<std::string, std::string> kOptions{
      {"instrument.length_m", "--length M"},
      {"instrument.outer_diameter_m", "--diameter M"},
      {"instrument.bending_stiffness_Nm2", "--stiffness NM2"},
      {"port.position_m", "--port X,Y,Z"},
      {"streams", "--stream STREAM=FILE"},
      {"video.camera", "--camera FILE"},
      {"video.collar", "--collar FILE"},
      {"video.pose", "--pose FILE"},
      {"video.without_pose", "--no-pose"},
      {"video.rate_hz", "--rate HZ"},
      {"video.times", "--times FILE"},
      {"video.start", "--start TIME"},
  };
  if (const auto found = kOptions.find(key); found != kOptions.end()) return found->second;
  if (key.starts_with("sensors.")) return fmt::format("--set {}=VALUE", key.substr(8));
  const auto dot = key.find('.');
  if (dot == std::string::npos) return "";
  const std::string stream = key.substr(0, dot), rest = key.substr(dot + 1);
  if (rest == "quaternion") return fmt::format("--quaternion {}=wxyz", stream);
  if (rest == "orientation") return fmt::format("--orientation {}=KIND", stream);
  if (rest == "skip_missing") return fmt::format("--skip-missing {}", stream);
  if (rest.starts_with("units.")) return fmt::format("--unit {}=UNIT", stream);
  if (rest.starts_with("columns.")) {
    return fmt::format("--column {}.{}=COLUMN", stream, rest.substr(8));
  }
  return "";
}

}  // namespace flextip
