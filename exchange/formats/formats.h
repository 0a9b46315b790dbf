// One file and one function for each format of other programs. A function takes the plan, completes
// it with what it found, and adds streams to the recording.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "exchange/bags/bags.h"
#include "exchange/describe.h"
#include "exchange/import_log.h"
#include "exchange/import_plan.h"
#include "recording/recording.h"

namespace flextip::exchange {

/// What the formats make of their files.
struct Streams {
  Recording recording;                  ///< streams only; the settings come later
  std::map<std::string, long> skipped;  ///< rows left out of each stream
  std::vector<StreamLine> others;       ///< streams that are written, and no part of `recording`
  std::shared_ptr<const Bags> bags;     ///< those of the plan, open
  /// Each writes something into the recording's folder: a video, pictures, joints.
  std::vector<std::function<void(const std::filesystem::path&)>> writers;
};

/// Tables. FindTables: the streams of `plan.tables`. Throws InputError; what nothing tells is
/// collected in `log`, as by all functions here.
void FindTables(ImportPlan& plan, ImportLog& log);
void ReadTables(ImportPlan& plan, Streams& streams, ImportLog& log);

/// Bags of ROS 1 and ROS 2. FindTopics: the topics that are streams and cameras.
void FindTopics(ImportPlan& plan, Streams& streams, ImportLog& log);
void ReadBags(ImportPlan& plan, Streams& streams, ImportLog& log);

/// Videos with their frames' times, lens and pose, and the collar.
void ReadVideos(ImportPlan& plan, Streams& streams, ImportLog& log);

/// Adds the bag and the videos of a session folder of the dVRK's recorder to the plan. Throws
/// InputError for a folder without index.json, and for an index of another kind.
void AddDvrkSession(const std::filesystem::path& folder, ImportPlan& plan, ImportLog& log);

}  // namespace flextip::exchange
