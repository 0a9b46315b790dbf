// Hours without fault: how often a supervisor stops what is right.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "bench/fault_campaign/base.h"

namespace flextip::bench {

/// A healthy run: another path, speed, tissue and instrument each time, all within tolerance.
struct HealthyRun {
  Base base;
  simulation::LoopSetup setup;
};
HealthyRun DrawHealthyRun(std::uint64_t first_seed, int number);

/// The runs of one case under one kind of supervision.
struct HealthyRecord {
  std::string kind;
  int runs = 0, without_equilibrium = 0;
  double simulated_s = 0.0;
  int stops = 0;           ///< begins of a hold or fault
  int votes = 0;           ///< begins of a sensor being out
  int off_path = 0;        ///< runs that leave the path by more than 2 mm
  int limited_cycles = 0;  ///< with the reaction limit
  /// Of stops and time those in runs that keep within 2 mm of the path without supervision.
  int fine_stops = 0;
  double fine_s = 0.0;
  std::map<std::string, int> stops_by_name;
  std::map<std::string, int> fine_stops_by_setting;  ///< "rod-track, vision: tip_jump"
  std::vector<std::string> examples;  ///< "press, rod-track, vision: tip_jump at 1.2 s, run 17"
};
struct HealthyBatch {
  std::string name;
  std::vector<HealthyRecord> records;
};

/// Runs from the number `first` on, until `duration_s` is simulated, each under every kind.
HealthyBatch RunHealthy(std::uint64_t first_seed, int first, double duration_s,
                        const std::vector<SupervisionKind>& kinds);

std::string JsonLine(const HealthyBatch& one);
std::vector<HealthyBatch> ReadHealthyBatchs(const std::filesystem::path& file);

}  // namespace flextip::bench
