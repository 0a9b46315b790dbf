// Follows the tip in a video or a folder of pictures: follow_tip VIDEO CAMERA.yaml COLLAR.yaml
#include <fmt/format.h>

#include <flextip/core/error.h>
#include <flextip/pipeline/instrument_tracker.h>
#include <flextip/recording/cameras/camera_file.h>
#include <flextip/recording/frames/frame_source.h>
#include <flextip/recording/streams/sensor_streams.h>

using namespace flextip;

int main(int argc, char** argv) try {
  if (argc != 4) throw InputError("usage: follow_tip VIDEO CAMERA.yaml COLLAR.yaml");
  ReadLog log;
  InstrumentTrackerSetup setup;
  setup.cameras = {ReadCameraCalibration(argv[2], &log)};
  setup.collar = ReadCollarFile(argv[3], log);
  setup.with_model = false;  // nothing is known of the wrist here
  InstrumentTracker tracker(setup);

  const auto frames = OpenPlainFrames(argv[1], setup.cameras.front(), {});
  while (const auto frame = frames->Next()) {
    const Image* const pictures[] = {&frame->image};
    const TipTrack track = tracker.Follow(pictures, frame->t_ns, {});
    const Eigen::Vector3d p_mm = 1e3 * track.tip.p_RE;
    fmt::print("{:.3f} s: tip {:.2f} {:.2f} {:.2f} mm, {}\n", 1e-9 * double(frame->t_ns), p_mm.x(),
               p_mm.y(), p_mm.z(), Name(track.tip.status));
  }
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 2;
}
