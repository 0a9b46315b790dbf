// loop0/cycles.csv: every cycle of a supervised simulation, as the controller was given it and what
// it did (docs/formats.md).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "pipeline/instrument_controller.h"
#include "recording/read_log.h"

namespace flextip::simulation {

/// In R (m, N).
struct LoopCycle {
  TimeNs t_ns = 0;
  SensorReadings sensors;  ///< as given: latencies taken off, faults in; a tip by a picture, too
  std::optional<Eigen::Vector3d> p_RE_desired, d_RE_desired;
  bool resume = false;
  ControlStatus status = ControlStatus::kNoWrist;
  Eigen::Vector3d p_RW_command = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_RE_used = Eigen::Vector3d::Zero();
  Supervision supervision;
};

/// Returns the inputs of a cycle, without pictures.
ControllerInputs InputsOf(const LoopCycle& cycle);
/// Takes what came of it.
void TakeCommand(const ControllerCommand& command, LoopCycle& cycle);
/// Returns whether both have the same command and findings, bit for bit.
bool SameCommand(const LoopCycle& a, const LoopCycle& b);

class LoopTableWriter {
 public:
  LoopTableWriter();
  ~LoopTableWriter();
  LoopTableWriter(LoopTableWriter&&) noexcept;

  void Add(const LoopCycle& cycle);
  const std::string& Text() const;

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

class LoopTableReader {
 public:
  /// Throws InputError with file and line.
  LoopTableReader(const std::filesystem::path& file, ReadLog& log);
  ~LoopTableReader();

  /// Returns the next cycle; empty after the last. Throws InputError.
  std::optional<LoopCycle> Next();

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

}  // namespace flextip::simulation
