// One reader and one writer for each sensor's folder. `folder` is RECORDING/wrist0 and so on;
// readers throw InputError with file and line, and log skipped data.
#pragma once

#include <filesystem>

#include "recording/read_log.h"
#include "recording/recording.h"
#include "recording/text/csv.h"

namespace flextip {

WristStream ReadWrist(const std::filesystem::path& folder, ReadLog& log);
void WriteWrist(const std::filesystem::path& folder, const WristStream& stream);

CommandStream ReadCommand(const std::filesystem::path& folder, ReadLog& log);
void WriteCommand(const std::filesystem::path& folder, const CommandStream& stream);

/// Reads an EM sensor. A sensor on the shaft is `length_m` from the tip at most; a sensor on the
/// port (`on_port`) needs no distance.
EmStream ReadEm(const std::filesystem::path& folder, double length_m, bool on_port, ReadLog& log);
void WriteEm(const std::filesystem::path& folder, const EmStream& stream);

/// Reads strain gages. The stations lie along the shaft, within `length_m`, the first one nearer to
/// the wrist.
StrainStream ReadStrain(const std::filesystem::path& folder, double length_m, ReadLog& log);
void WriteStrain(const std::filesystem::path& folder, const StrainStream& stream);

LoadStream ReadLoad(const std::filesystem::path& folder, ReadLog& log);
void WriteLoad(const std::filesystem::path& folder, const LoadStream& stream);

CameraStream ReadCamera(const std::filesystem::path& folder, bool check_frames, ReadLog& log);
void WriteCamera(const std::filesystem::path& folder, const CameraStream& stream);

/// Reads a collar's sensor.yaml, alone.
TagCollar ReadCollarFile(const std::filesystem::path& file, ReadLog& log);
TagCollar ReadTags(const std::filesystem::path& folder, ReadLog& log);
void WriteTags(const std::filesystem::path& folder, const TagCollar& collar);

VisionStream ReadVision(const std::filesystem::path& folder, ReadLog& log);
void WriteVision(const std::filesystem::path& folder, const VisionStream& stream);

/// Reads joints0, joints_command0 or joints_seen0. The columns q1 [rad], q2 [rad], q3 [m] ... must
/// be those of the arm's joints; an absent `joint_noise` is allowed for what was commanded.
JointStream ReadJoints(const std::filesystem::path& folder, const Arm& arm, ReadLog& log);
void WriteJoints(const std::filesystem::path& folder, const JointStream& stream);

/// Reads efforts of the arm's first joints, tau1 [Nm], tau2 [Nm], tau3 [N] ...
TorqueStream ReadTorque(const std::filesystem::path& folder, const Arm& arm, ReadLog& log);
void WriteTorque(const std::filesystem::path& folder, const TorqueStream& stream);

PoseStream ReadPose(const std::filesystem::path& folder, ReadLog& log);
void WritePose(const std::filesystem::path& folder, const PoseStream& stream);

/// Reads the arm that a folder's streams of joints name in their sensor.yaml. Throws InputError
/// where they name different files, or one that is not there; nothing, with a warning, where none
/// is named and none is there.
std::optional<Arm> ReadArmOf(const std::filesystem::path& recording, ReadLog& log);

/// Writes parts of a vision table, for rows that come one by one.
const std::vector<std::string>& VisionColumns();  ///< without the time
void AddVisionRow(CsvWriter& csv, const Sample<TipObservation>& tip);
void WriteVisionSettings(const std::filesystem::path& folder, const VisionStream& stream);

}  // namespace flextip
