// What is told of files to be imported: the content of a mapping file. Whatever is left empty is
// taken from the files, or assumed and said.
#pragma once

#include <Eigen/Dense>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time_series.h"
#include "exchange/import_log.h"

namespace flextip::exchange {

/// A sensor's stream, and the table or the topic of a bag that holds it.
struct StreamPlan {
  std::filesystem::path file;                  ///< a table; empty for a topic
  std::string topic;                           ///< of the plan's bags
  std::string separator;                       ///< comma, semicolon, tab, blank
  std::string decimal;                         ///< point, comma
  std::optional<bool> header;                  ///< whether the table names its columns
  std::map<std::string, std::string> columns;  ///< role -> name, or number from 1
  std::map<std::string, std::string> units;    ///< time, length, angle, force, moment -> "mm"
  std::string orientation;  ///< quaternion, matrix, rotation-vector, euler-zyx (any three axes)
  std::string quaternion;   ///< wxyz or xyzw: the order of its four columns in the file
  std::string axis;         ///< x, -x, y, ...: the sensor's axis along the shaft toward the tip
  std::optional<TimeNs> offset_ns;  ///< is added to every time
};

/// Settings of a sensor.yaml.
struct SensorSettings {
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, std::string> texts;
};

/// A camera with its frames: those of a video, or the pictures of a bag's topic.
struct CameraPlan {
  std::filesystem::path video;
  std::string topic;             ///< of pictures in the plan's bags; in place of a video
  std::filesystem::path camera;  ///< lens and resolution; of a topic its CameraInfo may tell them
  std::filesystem::path pose;    ///< a file with T_RC, in place of the one in `camera`
  bool link = false;             ///< do not copy the video
  StreamPlan times;              ///< its `file` holds the frames' times; else start and rate count
  std::string start;             ///< seconds or clock text of the first frame
  std::optional<double> rate_hz;
  std::optional<TimeNs> offset_ns;
};

struct ImportPlan {
  std::map<std::string, StreamPlan> streams;  ///< wrist0, em0, ...
  std::vector<std::filesystem::path> tables;  ///< files whose streams are to be found
  std::vector<std::filesystem::path> bags;    ///< their topics are streams too
  std::map<std::string, CameraPlan> cameras;  ///< cam0, cam1
  std::filesystem::path session;  ///< a folder of the dVRK's recorder: bags and cameras come of it
  std::filesystem::path collar;   ///< the tags, as a tags0/sensor.yaml
  std::filesystem::path arm;      ///< whose joints they are: an arm.yaml or a URDF
  std::map<std::string, SensorSettings> sensors;  ///< of each stream
  std::optional<double> length_m, outer_diameter_m, bending_stiffness_Nm2, mass_per_length_kg_m,
      stiffness_taper;
  std::optional<Eigen::Vector3d> p_RP, gravity_m_s2;
  std::map<std::string, std::vector<double>> tolerances;
  Assumptions assumed;  ///< of an earlier import with the same mapping

  /// Forgets that `key`, or a part of it, was assumed: it is told now.
  void Told(const std::string& key);
};

/// Whether joints are imported and no shaft: an arm is told, and nothing of an instrument or port.
bool IsOfArmAlone(const ImportPlan& plan);

/// Every file that the plan names.
std::vector<std::filesystem::path> FilesOf(const ImportPlan& plan);

}  // namespace flextip::exchange
