// The tables of flextip track, written as the frames come, so that memory does not grow with their
// number and an interrupted run can go on.
#pragma once

#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "core/tag_collar.h"
#include "pipeline/track_totals.h"
#include "recording/recording.h"
#include "recording/text/csv.h"

namespace flextip {

/// FOLDER/vision0, FOLDER/tags0 and FOLDER/frames.csv. Rows reach the disk every ten frames, and
/// with them FOLDER/unfinished.json: how far the tables are whole, the sums and the state up to
/// there.
class TrackTables {
 public:
  /// Goes on where `resume` finds an unfinished run of the same `input`, else from the beginning.
  /// Throws InputError where the unfinished run was of another input, WorkError where the disk
  /// refuses.
  TrackTables(const std::filesystem::path& folder, const std::string& input, bool resume);

  TrackSums sums;

  /// `p_RE`: the true tip, to be scored against.
  void Add(TimeNs t_ns, const TipTrack& track, const std::optional<Eigen::Vector3d>& p_RE,
           const Pose& T_RC);
  /// Whether so many frames have come that they are to be saved: the same in every run.
  bool IsSaveDue() const;
  /// `state`: of what makes the frames, handed out by `state` when a run goes on.
  void Save(const std::string& state);
  const std::string& state() const { return state_; }
  /// Writes both sensor.yaml beside the tables and takes unfinished.json away. Without a camera's
  /// pose the comment says that the tips are in the camera's frame.
  void Finish(const TagCollar& collar, double rate_hz, bool camera_has_pose);

 private:
  void Resume();
  void AddFrame(TimeNs t_ns, const TipTrack& track, const std::optional<Eigen::Vector3d>& p_RE);

  std::filesystem::path folder_, mark_;
  std::string input_, state_;
  /// One of the files, and its rows that are not yet there.
  struct GrowingTable {
    std::string name;
    CsvWriter rows;
    std::ofstream stream = {};
  };
  GrowingTable vision_, tags_, frames_;
};

}  // namespace flextip
