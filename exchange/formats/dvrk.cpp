// Sessions of the dVRK's recorder (jhu-dvrk/data_collection): index.json, videos with side-cars, a
// bag of ROS 2.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "exchange/formats/formats.h"
#include "exchange/formats/side_car.h"
#include "exchange/streams/names.h"
#include "recording/text/text.h"

namespace flextip::exchange {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct SessionVideo {
  std::string stream, file;
};

// Versions differ: a list of files, or a list of streams with a list of segments each.
std::vector<SessionVideo> VideosOf(const Json& index) {
  std::vector<SessionVideo> videos;
  for (const Json& video : index.value("videos", Json::array())) {
    const std::string file = video.at("file");
    videos.push_back({video.value("name", fs::path(file).stem().string()), file});
  }
  for (const Json& stream : index.value("streams", Json::array())) {
    for (const Json& video : stream.value("videos", Json::array())) {
      videos.push_back({stream.at("name"), video.at("file")});
    }
  }
  return videos;
}

std::string BagOf(const Json& index) {
  if (index.contains("rosbags") && index["rosbags"].is_string()) return index["rosbags"];
  if (index.contains("rosbag") && index["rosbag"].is_object()) return index["rosbag"].at("name");
  return "";
}

// cam1 for a right eye, else cam0.
std::string CameraNamed(const std::string& stream) {
  for (const auto& word : WordsOf(stream)) {
    if (word == "right") return "cam1";
  }
  return "cam0";
}

// Adds a video unless something speaks against it, which is returned.
std::string AddVideo(const fs::path& folder, const SessionVideo& video, ImportPlan& plan,
                     ImportLog& log) {
  const fs::path file = folder / video.file;
  const fs::path side_car = fs::path(file).replace_extension(".json");
  if (!fs::exists(file)) return "is not in the folder";
  if (!fs::exists(side_car)) return "has no side-car with the times of its frames";
  const SideCar times = ReadSideCar(side_car);
  if (!times.side_by_side.empty()) {
    return "holds both eyes side by side: split it with the recorder's extract -S, then import "
           "each eye as a video";
  }
  const std::string name = CameraNamed(video.stream);
  CameraPlan& camera = plan.cameras[name];
  if (!camera.video.empty()) {
    if (camera.video.filename() == video.file) return "";
    return fmt::format("is not used: {} is {}", name, camera.video.filename().string());
  }
  camera.video = file;
  camera.times.file = side_car;
  log.Assume(name + ".video", fmt::format("{}, by its name", video.file));
  if (times.latency_ns != 0) {
    log.Warn(fmt::format("{}: the latency that {} states, {:.6g} s, is taken off its times", name,
                         side_car.filename().string(), 1e-9 * double(times.latency_ns)));
  }
  return "";
}

// A video without a lens cannot be a camera of the recording.
void DropUncalibrated(ImportPlan& plan, ImportLog& log) {
  for (auto camera = plan.cameras.begin(); camera != plan.cameras.end();) {
    if (!camera->second.camera.empty() || camera->second.video.empty()) {
      ++camera;
      continue;
    }
    log.Warn(fmt::format("{}: {} is left out, since no file tells its lens (--camera)",
                         camera->first, camera->second.video.string()));
    log.assumed.erase(camera->first + ".video");
    camera = plan.cameras.erase(camera);
  }
}

}  // namespace

void AddDvrkSession(const fs::path& folder, ImportPlan& plan, ImportLog& log) {
  const fs::path index_file = folder / "index.json";
  if (!fs::exists(index_file)) {
    throw InputError::At(folder.string(), 0,
                         "holds no index.json, expected a session of the dVRK's recorder");
  }
  std::vector<SessionVideo> videos;
  std::string bag;
  try {
    const Json index = Json::parse(ReadTextFile(index_file));
    videos = VideosOf(index);
    bag = BagOf(index);
  } catch (const Json::exception& error) {
    throw InputError::At(index_file.string(), 0,
                         "is no index of the dVRK's recorder, expected videos or streams, and "
                         "rosbags");
  }
  for (const auto& video : videos) {
    const std::string problem = AddVideo(folder, video, plan, log);
    if (!problem.empty()) log.Warn(fmt::format("{} {}", (folder / video.file).string(), problem));
  }
  DropUncalibrated(plan, log);
  if (!bag.empty()) plan.bags.push_back(folder / bag);
  if (bag.empty()) log.Warn(fmt::format("{}: names no bag", index_file.string()));
}

}  // namespace flextip::exchange
