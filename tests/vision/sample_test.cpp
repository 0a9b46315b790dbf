// The tracker on frames from a ray tracer outside the project, with the truth beside them.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "recording/recording_reader.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {
namespace {

const std::filesystem::path kData = FLEXTIP_SOURCE_DIR "/testdata/recordings";

std::map<TimeNs, Eigen::Vector3d> ReadSampleTruth() {
  std::ifstream in(kData / "rendered.truth.csv");
  std::map<TimeNs, Eigen::Vector3d> truth;
  std::string line;
  std::getline(in, line);  // the names
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    TimeNs t_ns = 0;
    Eigen::Vector3d p;
    if (fields >> t_ns >> p.x() >> p.y() >> p.z()) truth[t_ns] = p;
  }
  return truth;
}

Image ReadBgr(const std::filesystem::path& file) {
  const cv::Mat picture = cv::imread(file.string(), cv::IMREAD_COLOR);
  Image image(picture.cols, picture.rows, 3);
  std::copy(picture.datastart, picture.dataend, image.data.begin());
  return image;
}

// Gamma 2.2, and tags 0.02 mm above their stated places: corners alone are 0.85 mm too deep.
TEST(RenderedSample, TipIsRightToATwentiethOfAMillimetre) {
  const auto folder = kData / "rendered";
  const Recording recording = ReadRecording(folder).recording;
  const auto truth = ReadSampleTruth();
  const CameraCalibration& camera = recording.cam0->calibration;
  for (const double decimate : {1.0, 2.0}) {
    TrackerOptions options;
    options.detector.quad_decimate = decimate;
    TipTracker tracker(camera, *recording.tags0, options);
    Eigen::Vector3d squared = Eigen::Vector3d::Zero();
    int frames = 0;
    for (const auto& frame : recording.cam0->filenames) {
      const Image image = ReadBgr(folder / "cam0" / "data" / frame.value);
      const TipTrack track = tracker.Track(image, frame.t_ns);
      ASSERT_EQ(track.tip.status, TipStatus::kOk);
      const Eigen::Vector3d e_C =
          camera.T_RC.R.transpose() * (track.tip.p_RE - truth.at(frame.t_ns));
      squared += e_C.cwiseAbs2();
      ++frames;
    }
    ASSERT_EQ(frames, 8);
    EXPECT_LT(std::sqrt(squared.sum() / frames), 0.05e-3) << decimate;
    EXPECT_LT(std::sqrt((squared.x() + squared.y()) / frames), 0.02e-3) << decimate;
  }
}

}  // namespace
}  // namespace flextip
