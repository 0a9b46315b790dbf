// A recording that grows while control runs, by a thread of its own.
#pragma once

#include <array>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "live/recorder/cycle_record.h"
#include "live/recorder/cycle_table.h"
#include "live/recorder/stream_file.h"

namespace flextip::live {

/// RECORDING as the other commands open it, and RECORDING/session0: the session file and those it
/// names, cycles.csv and events.csv. Whole lines are appended, so that a crash costs a torn line at
/// most. What finds no room (a disk that stands for seconds) is dropped and counted.
class Recorder {
 public:
  /// Makes the files in `folder`, which is there and empty. Throws WorkError where the disk
  /// refuses. `session` must outlive the recorder. `wait`: as the cycle is told.
  Recorder(const std::filesystem::path& folder, const Session& session, bool wait = false);
  /// Writes what is left.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Takes a sample from the thread that delivers its stream. Never waits.
  void Take(StreamName stream, const Arrived<AnySample>& sample);
  /// Takes a cycle from the cycle's thread. Never waits, never allocates.
  void Take(const CycleRecord& record);
  /// Takes an event from any thread.
  void TakeEvent(TimeNs t_ns, const std::string& what);

  /// Writes what is left and the settings with their rates. Throws WorkError where the disk has
  /// refused, now or earlier.
  void Finish();

  /// Returns the number of samples and cycles that were dropped.
  long Dropped() const;

 private:
  void Run(const std::stop_token& stop);
  void WriteAll();
  void WriteCycle(const CycleRecord& record);
  void NoteChanges(const CycleRecord& record);

  std::filesystem::path folder_;
  const Session& session_;
  std::array<Ring<Arrived<AnySample>>, kStreams> samples_;
  Ring<CycleRecord> cycles_;
  std::mutex events_mutex_;
  std::vector<std::pair<TimeNs, std::string>> events_;

  // Of the recorder's own thread.
  std::vector<StreamFile> streams_;
  StreamFile commands_;
  CycleTableWriter table_;
  LineFile cycles_file_, events_file_;
  std::string last_change_;
  FoundCause last_cause_;
  std::string problem_;
  std::jthread thread_;
};

}  // namespace flextip::live
