// Shifts of the collar found in rendered frames.
#include "vision/tags/collar_search.h"

#include <gtest/gtest.h>

#include <random>

#include "core/draw_vector.h"
#include "core/error.h"
#include "tests/vision/scope_scene.h"

namespace flextip {
namespace {

TEST(CollarSearch, FindsShiftsOf30Pixels) {
  const CameraCalibration camera = ScopeCamera();
  const CameraModel model(camera);
  const CollarSearch search(model, ScopeCollar());
  const simulation::Laparoscope scope(camera, ScopeCollar(), ScopeOptions(camera));
  const Pose T_CR = camera.T_RC.Inverse();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 25; ++i) {
    const Eigen::Vector2d turn = 0.5 * DrawVector<2>(unit, random);
    const Pose T_RE = ScopePose(turn.x(), turn.y());
    const Image image = scope.Render(ScopeShaft(T_RE), i);
    const Eigen::Vector2d shift_px = 30 * DrawVector<2>(unit, random);
    const Pose expected = search.Shifted(T_CR * T_RE, -shift_px);
    const CollarSearch::Match match = search.Find(image, expected, 32);
    EXPECT_LT((match.shift_px - shift_px).norm(), 1.5) << shift_px.transpose();
    EXPECT_GT(match.correlation, 0.5);
  }
}

// The middle of the tags in view, projected, moves by what was asked for.
TEST(CollarSearch, ShiftsThePoseByPixels) {
  const CameraModel model(ScopeCamera());
  const CollarSearch search(model, ScopeCollar());
  const Pose T_CE = ScopeCamera().T_RC.Inverse() * ScopePose(0.2, 0.3);
  const auto middle = [&](const Pose& pose) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int id : {0, 1, 5}) sum += ScopeCollar().tags[id].T_EG.p / 3;
    return *model.Project(pose * sum);
  };
  for (const Eigen::Vector2d& shift_px : {Eigen::Vector2d(12, -7), Eigen::Vector2d(-30, 3)}) {
    const Pose moved = search.Shifted(T_CE, shift_px);
    EXPECT_EQ(moved.R, T_CE.R);
    const Eigen::Vector2d step = middle(moved) - middle(T_CE);
    EXPECT_LT((step - shift_px).norm(), 0.02 * shift_px.norm());
  }
}

TEST(CollarSearch, NothingIsFoundWhereNothingIs) {
  const CameraCalibration camera = ScopeCamera();
  const CameraModel model(camera);
  const CollarSearch search(model, ScopeCollar());
  const Pose T_CE = camera.T_RC.Inverse() * ScopePose(0.2, 0.3);
  EXPECT_LT(search.Find(Image(320, 240, 1), T_CE, 30).correlation, 0.1);
  Pose behind = T_CE;
  behind.p.z() = -0.1;
  EXPECT_EQ(search.Find(Image(320, 240, 1), behind, 30).correlation, 0);
  const simulation::Laparoscope scope(camera, ScopeCollar(), ScopeOptions(camera));
  const Image empty = scope.Render(ScopeShaft(ScopePose(0, 0, {0.5, 0, 0})), 0);
  EXPECT_LT(search.Find(empty, T_CE, 30).correlation, 0.35);
}

// Partly or wholly outside of the picture.
TEST(CollarSearch, StaysWithinThePicture) {
  const CameraCalibration camera = ScopeCamera();
  const CameraModel model(camera);
  const CollarSearch search(model, ScopeCollar());
  const Pose T_CE = camera.T_RC.Inverse() * ScopePose(0.2, 0.3);
  for (const double x_m : {-0.03, 0.025, 0.06}) {
    Pose aside = T_CE;
    aside.p += Eigen::Vector3d(x_m, -x_m, 0);
    EXPECT_LE(search.Find(Image(320, 240, 1), aside, 60).correlation, 1);
  }
}

TEST(CollarSearch, RefusesTagsThatDoNotExist) {
  const CameraModel model(ScopeCamera());
  EXPECT_THROW(CollarSearch(model, ScopeCollar(0, 585)), InputError);
}

}  // namespace
}  // namespace flextip
