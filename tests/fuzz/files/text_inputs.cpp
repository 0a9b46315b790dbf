// Tables, calibrations and camera files.
#include <cmath>
#include <string>

#include "recording/calibrations/file.h"
#include "recording/cameras/camera_file.h"
#include "recording/cameras/camera_formats.h"
#include "recording/text/csv.h"
#include "tests/fuzz/files/input_folder.h"
#include "tests/fuzz/files/inputs.h"

namespace flextip {

int CheckCsvInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("table.csv", TextOf(input));
  int rows = 0;
  for (const bool recorder : {true, false}) {
    const bool read = ReadsOrRefuses([&] {
      ReadLog log;
      CsvReader csv(file, log, {.from_recorder = recorder});
      while (csv.Next()) {
        for (std::size_t i = 0; i < csv.Columns().size(); ++i) {
          Require(csv.Text(i).size() <= input.size());
          if (!csv.Empty(i)) Require(std::abs(csv.Number(i)) <= 4e18);
        }
        ++rows;
      }
    });
    if (!read) rows = 0;
  }
  return rows > 0 ? 1 : 0;
}

int CheckCalibrationInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("calibration.yaml", TextOf(input));
  Calibration calibration;
  if (!ReadsOrRefuses([&] { calibration = ReadCalibration(file); })) return 0;
  for (const auto& [name, values] : calibration.numbers) {
    for (const double value : values) Require(std::abs(value) <= 1e12);
  }
  WriteCalibration(folder / "again.yaml", calibration);
  const Calibration again = ReadCalibration(folder / "again.yaml");
  Require(again.numbers == calibration.numbers && again.texts == calibration.texts);
  return 1;
}

int CheckCameraInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const auto file = folder.Write("camera.yaml", TextOf(input));
  ReadsOrRefuses([&] { GuessCameraFormat(file); });
  int understood = 0;
  for (const CameraFormat format :
       {CameraFormat::kEuroc, CameraFormat::kKalibr, CameraFormat::kRos, CameraFormat::kOpenCv}) {
    CameraDescription camera;
    if (!ReadsOrRefuses([&] { camera = ReadCameraDescription(file, format, {"", 640, 480}); }))
      continue;
    const CameraCalibration& c = camera.calibration;
    Require(c.fu_px > 0 && c.fu_px <= 1e6 && c.width_px > 0 && c.width_px <= 100'000);
    WriteCameraDescription(folder / "again.yaml", CameraFormat::kEuroc, camera);
    const auto again = ReadCameraDescription(folder / "again.yaml", CameraFormat::kEuroc);
    Require(again.calibration.fu_px == c.fu_px && again.calibration.width_px == c.width_px);
    understood = 1;
  }
  return understood;
}

}  // namespace flextip
