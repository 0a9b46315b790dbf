#include "apps/import/options.h"

#include <fmt/format.h>

#include <map>

#include "apps/common/length_option.h"
#include "apps/common/vector_option.h"
#include "exchange/streams/names.h"

namespace flextip {
namespace {

template <class T>
void AddNumber(CLI::App& command, const std::string& name, T& value, const std::string& unit,
               const std::string& text) {
  command.add_option(name, value, text)
      ->check(CLI::PositiveNumber)
      ->type_name(unit)
      ->group("Instrument");
}

void AddPlace(CLI::App& command, const std::string& name, std::optional<Eigen::Vector3d>& value,
              const std::string& description) {
  const auto take = [&value, name](const std::string& text) {
    value = ParsePlace(text);
    if (!value) throw CLI::ValidationError(name, "'" + text + "' is not x,y,z");
  };
  command.add_option_function<std::string>(name, take, description)
      ->type_name("X,Y,Z")
      ->group("Instrument");
}

void AddList(CLI::App& command, const std::string& group, const std::string& name,
             std::vector<std::string>& values, const std::string& form,
             const std::string& description) {
  command.add_option(name, values, description)
      ->allow_extra_args(false)
      ->type_name(form)
      ->group(group);
}

void AddFileOptions(CLI::App& command, ImportOptions& options) {
  command.add_option("-o,--output", options.out, "Recording to make")
      ->required()
      ->type_name("RECORDING")
      ->group("Files");
  const bool bags = options.format != "csv" && options.format != "video";
  AddList(command, "Files", "--stream", options.streams, bags ? "STREAM=TOPIC" : "STREAM=FILE",
          (bags ? "The topic, or the table, of a stream: " : "The table of a stream: ") +
              exchange::TableStreamsText() + ", cam0, cam1");
  command.add_option("--map", options.map, "A mapping file, as import.yaml of an earlier import")
      ->type_name("FILE.yaml")
      ->group("Files");
  command
      .add_option("--settings", options.settings,
                  "Instrument, port and sensors; a recording.yaml is one")
      ->type_name("FILE.yaml")
      ->group("Files");
  if (bags) {
    command
        .add_option("--arm", options.arm,
                    "Whose joints they are: an arm.yaml or a URDF. Without instrument and port the "
                    "joints alone are imported")
        ->type_name("FILE")
        ->group("Files");
  }
  command.add_flag("--force", options.force, "Replace the folder of an earlier run")
      ->group("Files");
  command
      .add_flag("--no-check", options.no_check,
                "Do not check whether the recording can be what it says")
      ->group("Files");
}

void AddInstrumentOptions(CLI::App& command, ImportOptions& options) {
  AddLength(command, "--length", options.length_m, "Wrist to tip along the shaft: 0.6 or 600mm")
      ->check(CLI::PositiveNumber)
      ->group("Instrument");
  AddLength(command, "--diameter", options.diameter_m, "Outer diameter")
      ->check(CLI::PositiveNumber)
      ->group("Instrument");
  AddNumber(command, "--stiffness", options.stiffness_Nm2, "NM2", "Bending stiffness E I");
  command
      .add_option("--mass-per-length", options.mass_per_length_kg_m,
                  "Of the shaft (kg/m); 0: weight is not modelled")
      ->check(CLI::NonNegativeNumber)
      ->group("Instrument");
  AddPlace(command, "--port", options.port, "The port's place in R: 0.28,0,0 or 280mm,0,0");
  AddPlace(command, "--gravity", options.gravity, "Gravity in R (m/s2)");
}

void AddReadingOptions(CLI::App& command, ImportOptions& options) {
  const std::string group = "What the files do not say";
  AddList(command, group, "--set", options.sets, "STREAM.KEY=VALUE",
          "A setting of a sensor: em0.distance_from_tip_m=0.02, wrist0.position_noise_m=1e-4");
  AddList(command, group, "--unit", options.units, "STREAM=UNIT",
          "Unit of a stream's values: em0=mm, em0=ms (its times), em0=deg, load0=mN");
  AddList(command, group, "--axis", options.axes, "STREAM=AXIS",
          "The sensor's axis that points along the shaft toward the tip: em0=z, wrist0=-z");
  AddList(command, group, "--offset", options.offsets, "STREAM=SECONDS",
          "Added to the times of a stream: em0=12.3");
  AddList(command, group, "--quaternion", options.quaternions, "STREAM=ORDER",
          "Order of a quaternion's columns: em0=wxyz or em0=xyzw");
  AddList(command, group, "--orientation", options.orientations, "STREAM=KIND",
          "quaternion, matrix, rotation-vector, or euler-zyx (any order of three axes)");
  AddList(command, group, "--column", options.columns, "STREAM.ROLE=COLUMN",
          "A column by its name, or its number from 1: em0.x=Tx, em0.t=1");
}

void AddCameraOptions(CLI::App& command, ImportOptions& options) {
  const std::string group = "Cameras (of the right eye with cam1= before the value)";
  AddList(command, group, "--camera", options.cameras, "FILE",
          "Lens: a file of EuRoC, Kalibr, ROS or OpenCV");
  AddList(command, group, "--pose", options.poses, "FILE",
          "The camera's pose: a file with T_RC, or the calibration.yaml of calibrate hand-eye");
  command.add_option("--collar", options.collar, "Tags on the instrument, as a tags0/sensor.yaml")
      ->type_name("FILE")
      ->group(group);
  AddList(command, group, "--times", options.times, "FILE",
          "Times of a video's frames: one a line, a table, or the dVRK recorder's .json");
  AddList(command, group, "--start", options.starts, "TIME",
          "Time of a video's first frame: seconds or clock text");
  command.add_option("--rate", options.rate_hz, "Frames a second")
      ->check(CLI::PositiveNumber)
      ->type_name("HZ")
      ->group(group);
  command.add_flag("--link", options.link, "Link videos into the recording, do not copy them")
      ->group(group);
}

}  // namespace

void AddImportOptions(CLI::App& command, ImportOptions& options) {
  AddFileOptions(command, options);
  AddInstrumentOptions(command, options);
  AddReadingOptions(command, options);
  AddCameraOptions(command, options);
}

std::string OptionFor(const std::string& key) {
  static const std::map<std::string, std::string> kOptions{
      {"instrument.length_m", "--length M"},
      {"instrument.outer_diameter_m", "--diameter M"},
      {"instrument.bending_stiffness_Nm2", "--stiffness NM2"},
      {"port.position_m", "--port X,Y,Z"},
      {"streams", "--stream STREAM=FILE"},
  };
  static const std::map<std::string, std::string> kCameraOptions{{"camera", "--camera {}FILE"},
                                                                 {"times", "--times {}FILE"},
                                                                 {"start", "--start {}TIME"},
                                                                 {"rate_hz", "--rate HZ"}};
  if (const auto found = kOptions.find(key); found != kOptions.end()) return found->second;
  const auto dot = key.find('.');
  if (dot == std::string::npos) return "";
  const std::string first = key.substr(0, dot), rest = key.substr(dot + 1);
  if (first == "sensors") return fmt::format("--set {}=VALUE", rest);
  if (first == "topics") return fmt::format("--stream {}=TOPIC", rest);
  if (first == "cameras") {
    const auto found = kCameraOptions.find(rest.substr(rest.find('.') + 1));
    if (found == kCameraOptions.end()) return "";
    return fmt::format(fmt::runtime(found->second), rest.starts_with("cam1") ? "cam1=" : "");
  }
  if (rest == "quaternion") return fmt::format("--quaternion {}=wxyz", first);
  if (rest == "orientation") return fmt::format("--orientation {}=KIND", first);
  if (rest.starts_with("units.")) return fmt::format("--unit {}=UNIT", first);
  if (rest.starts_with("columns."))
    return fmt::format("--column {}.{}=COLUMN", first, rest.substr(8));
  return "";
}

}  // namespace flextip
