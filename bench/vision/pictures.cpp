#include "bench/vision/pictures.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <regex>

#include "core/error.h"
#include "recording/recording_reader.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"

namespace flextip::bench {
namespace {

namespace fs = std::filesystem;

std::vector<double> NumbersOf(const std::string& line) {
  static const std::regex number("-?[0-9]+\\.?[0-9]*(e-?[0-9]+)?");
  std::vector<double> numbers;
  for (std::sregex_iterator it(line.begin(), line.end(), number), end; it != end; ++it) {
    numbers.push_back(std::stod(it->str()));
  }
  return numbers;
}

// Id and corners, be they on one line or on five; `origin_px` is where the file has a pixel's
// centre.
TagsFound ReadCorners(const fs::path& file, double origin_px) {
  std::string text = ReadTextFile(file);
  text = std::regex_replace(text, std::regex("36h11_id:_"), "");
  const std::vector<double> n = NumbersOf(text);
  TagsFound tags;
  for (std::size_t i = 0; i + 9 <= n.size(); i += 9) {
    TagCorners corners;
    for (std::size_t k = 0; k < 4; ++k) {
      corners[k] = Eigen::Vector2d(n[i + 1 + 2 * k], n[i + 2 + 2 * k]).array() - origin_px;
    }
    tags.emplace(static_cast<int>(n[i]), corners);
  }
  return tags;
}

PictureSet TagSet(const std::string& name, const std::vector<Picture>& pictures) {
  PictureSet set{name, {}, {}, pictures};
  set.camera.fu_px = set.camera.fv_px = 700;  // of no use here: only corners are compared
  for (const Picture& picture : pictures) {
    for (const auto& [id, corners] : picture.truth.corners_px) {
      const bool known = std::any_of(set.collar.tags.begin(), set.collar.tags.end(),
                                     [id = id](const CollarTag& tag) { return tag.id == id; });
      if (!known) set.collar.tags.push_back({id, 0.1, {}});
    }
  }
  return set;
}

}  // namespace

Image ReadGrey(const fs::path& file) {
  const cv::Mat picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (picture.empty()) throw InputError(file.string() + ": cannot be read as an image");
  Image image(picture.cols, picture.rows, 1);
  std::copy(picture.datastart, picture.dataend, image.data.begin());
  return image;
}

std::vector<PictureSet> RenderedPictures(const fs::path& recordings) {
  const fs::path folder = recordings / "rendered";
  const Recording recording = ReadRecording(folder).recording;
  PictureSet set{"rendered sample", recording.cam0->calibration, *recording.tags0, {}};
  std::map<TimeNs, Pose> truth;
  ReadLog log;
  CsvReader csv(recordings / "rendered.truth.csv",
                {"timestamp [ns]", "x", "y", "z", "qw", "qx", "qy", "qz"}, log);
  while (csv.Next()) {
    const auto at = [&](std::size_t column) { return csv.Number(column); };
    truth[csv.Integer(0)] =
        Pose::FromQuaternion({at(4), at(5), at(6), at(7)}, {at(1), at(2), at(3)});
  }
  const CameraModel camera(set.camera);
  for (const auto& frame : recording.cam0->filenames) {
    const Pose T_CE = set.camera.T_RC.Inverse() * truth.at(frame.t_ns);
    PictureTruth known{{}, T_CE};
    for (const auto& tag : TagsInView(camera, set.collar, T_CE, 80 * M_PI / 180)) {
      known.corners_px.insert(tag);
    }
    set.pictures.push_back({folder / "cam0" / "data" / frame.value, known});
  }
  return {set};
}

std::vector<PictureSet> TagPictures(const fs::path& data, const fs::path& visp) {
  std::vector<PictureSet> sets;
  const fs::path photos = data / "apriltag_photos";
  if (fs::exists(photos)) {
    std::vector<Picture> pictures;
    for (const auto& entry : fs::directory_iterator(photos)) {
      if (entry.path().extension() != ".jpg") continue;
      fs::path corners = entry.path();
      corners.replace_extension(".txt");
      pictures.push_back({entry.path(), {ReadCorners(corners, 0.5), {}}});
    }
    sets.push_back(TagSet("AprilTag's photographs", pictures));
  }
  const fs::path photo = visp / "AprilTag" / "AprilTag.pgm";
  if (fs::exists(photo)) {
    TagsFound corners = ReadCorners(photo.parent_path() / "ground_truth_detection.txt", 0.5);
    for (auto& [id, four] : corners) {  // rows come first there
      for (Eigen::Vector2d& c : four) c.reverseInPlace();
    }
    sets.push_back(TagSet("ViSP's photograph", {{photo, {corners, {}}}}));
  }
  const fs::path scene = visp / "AprilTag" / "benchmark" / "640x480" / "tag36_11_640x480.png";
  if (fs::exists(scene)) {
    const auto corners = ReadCorners(scene.parent_path() / "corners_tag36_11.txt", 0.5);
    sets.push_back(TagSet("ViSP's rendered scene", {{scene, {corners, {}}}}));
  }
  return sets;
}

}  // namespace flextip::bench
