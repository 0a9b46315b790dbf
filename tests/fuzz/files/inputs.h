// What is asked of the readers of files for any bytes: they read, or they refuse by one InputError
// whose line a terminal can show; what was read is within its bounds, and what is written of it
// reads again. Each returns 1 where the input was read, and aborts where a promise is broken.
#pragma once

#include <cstdint>
#include <span>

namespace flextip {

/// The parts of the input are "STREAM\n", sensor.yaml and data.csv; or recording.yaml alone.
int CheckRecordingInput(std::span<const std::uint8_t> input);
/// An arm.yaml, or a URDF where it begins with '<'.
int CheckArmInput(std::span<const std::uint8_t> input);
int CheckCsvInput(std::span<const std::uint8_t> input);
int CheckScenarioInput(std::span<const std::uint8_t> input);
int CheckSessionInput(std::span<const std::uint8_t> input);
int CheckModelInput(std::span<const std::uint8_t> input);
int CheckArmModelInput(std::span<const std::uint8_t> input);
int CheckMapInput(std::span<const std::uint8_t> input);
int CheckMeshInput(std::span<const std::uint8_t> input);
int CheckCalibrationInput(std::span<const std::uint8_t> input);
/// In every format that camera files have.
int CheckCameraInput(std::span<const std::uint8_t> input);
int CheckCornersInput(std::span<const std::uint8_t> input);
/// The parts are "STREAM\n" and a table, or one mapping.
int CheckImportInput(std::span<const std::uint8_t> input);
/// One bag, of ROS 2 or of ROS 1; what an import makes of it reads as a recording.
int CheckMcapInput(std::span<const std::uint8_t> input);
int CheckRosBagInput(std::span<const std::uint8_t> input);
int CheckImageInput(std::span<const std::uint8_t> input);
int CheckVideoInput(std::span<const std::uint8_t> input);
/// The times beside a video.
int CheckSideCarInput(std::span<const std::uint8_t> input);
/// A table of a result, and the paths over time in it.
int CheckTableInput(std::span<const std::uint8_t> input);
/// A result's JSON: summary, diagnosis, figure.
int CheckResultInput(std::span<const std::uint8_t> input);

}  // namespace flextip
