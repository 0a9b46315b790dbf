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

/// A sensor's stream and the table it is in.
struct StreamPlan {
  std::filesystem::path file;
  std::string separator;                       ///< comma, semicolon, tab, blank
  std::string decimal;                         ///< point, comma
  std::optional<bool> header;                  ///< whether the table names its columns
  std::map<std::string, std::string> columns;  ///< role -> name, or number from 1
  std::map<std::string, std::string> units;    ///< time, length, angle, force, moment -> "mm"
  std::string orientation;  ///< quaternion, matrix, rotation-vector, euler-zyx (any three axes)
  std::string quaternion;   ///< wxyz or xyzw: the order of its four columns in the file
  std::optional<TimeNs> offset_ns;  ///< is added to every time
  bool skip_missing = false;        ///< leave out rows with empty or NaN values
};

/// Settings of a sensor.yaml.
struct SensorSettings {
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, std::string> texts;
};

struct VideoPlan {
  std::filesystem::path file, camera, collar;
  std::filesystem::path pose;  ///< a file with the camera's T_RC
  bool without_pose = false;   ///< R is the camera's own frame
  bool link = false;           ///< do not copy the video
  StreamPlan times;            ///< file of times; its `file` is empty where start and rate count
  std::string start;           ///< s or clock text of the first frame
  std::optional<double> rate_hz;
  std::optional<TimeNs> offset_ns;
};

struct ImportPlan {
  std::map<std::string, StreamPlan> streams;  ///< wrist0, em0, ...
  std::vector<std::filesystem::path> files;   ///< tables whose streams are to be found
  std::optional<VideoPlan> video;
  std::map<std::string, SensorSettings> sensors;  ///< of each stream
  std::optional<double> length_m, outer_diameter_m, bending_stiffness_Nm2, mass_per_length_kg_m,
      stiffness_taper;
  std::optional<Eigen::Vector3d> p_RP, gravity_m_s2;
  std::map<std::string, std::vector<double>> tolerances;
  Assumptions assumed;  ///< of an earlier import with the same mapping

  /// Forgets that `key`, or a part of it, was assumed: it is told now.
  void Told(const std::string& key);
};

}  // namespace flextip::exchange
