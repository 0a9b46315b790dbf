// cycles.csv: every cycle of a session, with every number exact (docs/formats.md).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "live/recorder/cycle_record.h"
#include "recording/read_log.h"

namespace flextip::live {

/// Makes the table's text row by row. A sample is written in the first cycle that was given it.
class CycleTableWriter {
 public:
  CycleTableWriter();
  ~CycleTableWriter();

  void Add(const CycleRecord& record);
  /// Returns the text since the last call, the header first.
  std::string TakeText();

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

/// Reads the table row by row.
class CycleTableReader {
 public:
  /// Throws InputError with file and line. A torn last line is skipped and logged.
  CycleTableReader(const std::filesystem::path& file, ReadLog& log);
  ~CycleTableReader();

  /// Returns the next cycle; empty after the last. `outputs` has no R_RW. Throws InputError.
  std::optional<CycleRecord> Next();

 private:
  struct Table;
  std::unique_ptr<Table> table_;
};

}  // namespace flextip::live
