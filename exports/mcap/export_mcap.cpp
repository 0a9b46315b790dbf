#include "exports/mcap/export_mcap.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/error.h"
#include "exports/mcap/camera_messages.h"
#include "exports/mcap/messages.h"
#include "exports/mcap/writer.h"

namespace flextip::exports {
namespace {

namespace fs = std::filesystem;

constexpr const char* kWorld = "R";
constexpr std::size_t kPathPoses = 2000;  // of a path that a viewer draws

/// A message that is made when its turn comes: pictures are not held in memory.
struct Pending {
  TimeNs t_ns = 0;
  std::uint16_t channel = 0;
  std::function<std::string()> make;
};

class Export {
 public:
  explicit Export(const fs::path& file) : writer_(file) {}

  std::uint16_t Channel(const std::string& topic, const MessageSchema& schema) {
    content.topics.push_back({topic, schema.name});
    return writer_.AddChannel(topic, schema.name, schema.text);
  }
  void Add(TimeNs t_ns, std::uint16_t channel, std::function<std::string()> make) {
    pending_.push_back({t_ns, channel, std::move(make)});
    ++content.topics[channel - 1u].messages;
  }

  void AddTable(const TimedTable& table) {
    if (table.cells.names.size() < 2) return;
    const auto channel = Channel("/" + table.name, TableSchema(table));
    for (std::size_t row = 0; row < table.cells.t_ns.size(); ++row) {
      Add(table.cells.t_ns[row], channel, [&table, row] { return RowMessage(table, row); });
    }
  }

  void AddTrajectory(const Trajectory& path) {
    if (path.has_turn) {
      const auto poses = Channel("/" + path.name + "/pose", PoseSchema());
      for (const TimedPose& pose : path.poses) {
        Add(pose.t_ns, poses, [&pose] { return PoseMessage(pose, kWorld); });
      }
    }
    const auto whole = Channel("/" + path.name + "/path", PathSchema());
    Add(path.poses.front().t_ns, whole, [&path] {
      const std::size_t every = 1 + path.poses.size() / kPathPoses;
      std::vector<TimedPose> thinned;
      for (std::size_t i = 0; i < path.poses.size(); i += every) thinned.push_back(path.poses[i]);
      return PathMessage(thinned, kWorld);
    });
  }

  void AddCamera(RecordedCamera& camera, const std::vector<TimedTable>& tables) {
    const TimeNs first_ns = camera.Times().front();
    const std::string name = "/" + camera.Name();
    const auto transform = Channel(name + "/transform", TransformSchema());
    Add(first_ns, transform, [&camera, first_ns] {
      return TransformMessage(first_ns, kWorld, camera.Name(), camera.Calibration().T_RC);
    });
    const auto calibration = Channel(name + "/calibration", CameraSchema());
    const auto pictures = Channel(name + "/image", ImageSchema());
    const auto drawn = Channel(name + "/annotations", AnnotationsSchema());
    for (const TimeNs t_ns : camera.Times()) {
      Add(t_ns, calibration,
          [&camera, t_ns] { return CameraMessage(t_ns, camera.Name(), camera.Calibration()); });
      Add(t_ns, pictures, [&camera, t_ns] { return camera.NextImage(t_ns); });
      Add(t_ns, drawn, [&camera, &tables, t_ns] {
        return AnnotationsMessage(t_ns, camera.Annotate(tables, t_ns));
      });
    }
  }

  void Write(const std::function<void(std::size_t, std::size_t)>& progress) {
    const bool negative =
        std::any_of(pending_.begin(), pending_.end(), [](const Pending& p) { return p.t_ns < 0; });
    if (negative) throw InputError("MCAP has no times before 1970, and a table begins there");
    std::stable_sort(pending_.begin(), pending_.end(),
                     [](const Pending& a, const Pending& b) { return a.t_ns < b.t_ns; });
    for (const Pending& message : pending_) {
      writer_.Add(message.channel, message.t_ns, message.make());
      if (progress) progress(writer_.Messages(), pending_.size());
    }
    writer_.Finish();
    content.messages = writer_.Messages();
  }

  McapContent content;

 private:
  McapWriter writer_;
  std::vector<Pending> pending_;
};

}  // namespace

McapContent ExportMcap(const fs::path& folder, const std::vector<fs::path>& more,
                       const fs::path& file,
                       const std::function<void(std::size_t, std::size_t)>& progress) {
  std::vector<TimedTable> tables = ReadTimedTables(folder);
  for (const fs::path& result : more) {
    const std::string name = (fs::absolute(result) / "").parent_path().filename().string();
    for (TimedTable& table : ReadTimedTables(result)) {
      table.name = name + "/" + table.name;
      tables.push_back(std::move(table));
    }
  }
  std::vector<RecordedCamera> cameras = CamerasOf(folder);
  std::vector<Trajectory> paths;
  for (const TimedTable& table : tables) {
    for (Trajectory& path : TrajectoriesIn(table)) paths.push_back(std::move(path));
  }
  Export all(file);
  for (const TimedTable& table : tables) all.AddTable(table);
  for (const Trajectory& path : paths) all.AddTrajectory(path);
  for (RecordedCamera& camera : cameras) all.AddCamera(camera, tables);
  all.Write(progress);
  return std::move(all.content);
}

}  // namespace flextip::exports
