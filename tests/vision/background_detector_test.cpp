// The detector on its thread against the detector.
#include "vision/tags/background_detector.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/vision/scope_scene.h"

namespace flextip {
namespace {

Image Picture() {
  const CameraCalibration camera = ScopeCamera();
  const simulation::Laparoscope scope(camera, ScopeCollar(), ScopeOptions(camera));
  return scope.Render(ScopeShaft(ScopePose(0.1, 0.25)), 0);
}

// Waits for a result; none after 10 s.
std::optional<BackgroundDetector::Found> Wait(BackgroundDetector& detector) {
  for (int i = 0; i < 2000; ++i) {
    if (auto found = detector.Take()) return found;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return {};
}

TEST(BackgroundDetector, FindsWhatTheDetectorFinds) {
  const Image image = Picture();
  const auto tags = TagDetector().Detect(image);
  ASSERT_FALSE(tags.empty());
  BackgroundDetector background{TagDetectorOptions{}};
  EXPECT_FALSE(background.Take());
  for (const TimeNs t_ns : {12, 34}) {
    ASSERT_TRUE(background.Submit(image, t_ns));
    const auto found = Wait(background);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->t_ns, t_ns);
    EXPECT_FALSE(background.Take());  // once
    ASSERT_EQ(found->tags.size(), tags.size());
    for (std::size_t i = 0; i < tags.size(); ++i) {
      EXPECT_EQ(found->tags[i].id, tags[i].id);
      EXPECT_EQ(found->tags[i].corners_px, tags[i].corners_px);
    }
  }
}

// A picture that takes far longer to search than to hand over.
Image Large() {
  const Image tile = Picture();
  Image large(4 * tile.width_px, 4 * tile.height_px, 1);
  for (int y = 0; y < large.height_px; ++y) {
    for (int x = 0; x < large.width_px; ++x) {
      large.Row(y)[x] = tile.Row(y % tile.height_px)[x % tile.width_px];
    }
  }
  return large;
}

TEST(BackgroundDetector, RefusesWhileBusy) {
  const Image large = Large();
  BackgroundDetector background{TagDetectorOptions{}};
  ASSERT_TRUE(background.Submit(large, 1));
  EXPECT_FALSE(background.Submit(large, 2));
  const auto found = Wait(background);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->t_ns, 1);
  EXPECT_TRUE(background.Submit(large, 3));
}

TEST(BackgroundDetector, EndsWhileBusyAndMovesWhileBusy) {
  const Image large = Large();
  BackgroundDetector background{TagDetectorOptions{}};
  ASSERT_TRUE(background.Submit(large, 1));
  BackgroundDetector moved = std::move(background);
  const auto found = Wait(moved);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->t_ns, 1);
  { BackgroundDetector idle{TagDetectorOptions{}}; }
  ASSERT_TRUE(moved.Submit(large, 2));
}

}  // namespace
}  // namespace flextip
