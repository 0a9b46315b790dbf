#include <utility>

#include "testdata/broken/changes.h"
#include "testdata/broken/groups.h"

namespace flextip::broken {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

}  // namespace

std::vector<BrokenWay> VisionWays() {
  return {
      {"vision0 in mm",
       "vision0.unit",
       {"vision0"},
       [](Recording& r, Rng&) { EachTip(r, [](Vector3d& p, Vector3d&) { p *= 1e3; }); }},
      {"vision0 in the camera's frame",
       "vision0.frame",
       {"vision0", "cam0"},
       [](Recording& r, Rng&) {
         const Pose T_CR = r.cam0->calibration.T_RC.Inverse();
         EachTip(r, [&](Vector3d& p, Vector3d& d) { p = T_CR * p, d = T_CR.R * d; });
       }},
      {"vision0 direction backward",
       "vision0.direction",
       {"vision0"},
       [](Recording& r, Rng&) { EachTip(r, [](Vector3d&, Vector3d& d) { d = -d; }); }},
      {"vision0 clock by seconds",
       "vision0.clock",
       {"vision0"},
       [](Recording& r, Rng& rng) {
         ShiftTimes(r.vision0->tips, Either(rng, Uniform(rng, 0.6, 3.0)));
       }},
      {"vision0 clock from 0",
       "vision0.clock",
       {"vision0"},
       [](Recording& r, Rng&) {
         ShiftTimes(r.vision0->tips, -1e-9 * static_cast<double>(r.vision0->tips.front().t_ns));
       }},
      {"vision0 clock from 0, the robot's a third of the recording later",
       "vision0.clock",
       {"vision0"},
       [](Recording& r, Rng& rng) {
         const double late_s = Uniform(rng, 0.3, 0.5) * DurationOf(r);
         ShiftAll(r, late_s - 1e-9 * static_cast<double>(r.wrist0->samples.front().t_ns));
         FromZero(r.vision0->tips);
       }},
      {"vision0 y mirrored",
       "vision0.mirrored",
       {"vision0"},
       [](Recording& r, Rng&) {
         EachTip(r, [](Vector3d& p, Vector3d& d) { p.y() = -p.y(), d.y() = -d.y(); });
       }},
      {"vision0 columns y and z",
       "vision0.columns",
       {"vision0"},
       [](Recording& r, Rng&) {
         EachTip(r, [](Vector3d& p, Vector3d&) { std::swap(p.y(), p.z()); });
       }},
      {"vision0 covariance too small",
       "vision0.noise",
       {"vision0"},
       [](Recording& r, Rng&) {
         for (auto& s : r.vision0->tips) s.value.covariance_m2 /= 36.0;
       }},
      {"vision0 frozen",
       "vision0.frozen",
       {"vision0"},
       [](Recording& r, Rng& rng) { Freeze(r.vision0->tips, Uniform(rng, 0.3, 0.7)); }},
      {"vision0 repeated",
       "vision0.repeated",
       {"vision0"},
       [](Recording& r, Rng&) { Repeat(r.vision0->tips, 3); }},
  };
}

std::vector<BrokenWay> CameraWays() {
  const auto camera = [](Recording& r) -> CameraCalibration& { return r.cam0->calibration; };
  return {
      {"cam0 T_RC identity",
       "cam0.identity",
       {"cam0"},
       [=](Recording& r, Rng&) { camera(r).T_RC = Pose(); }},
      {"vision0 tracked by a camera without a pose",
       "cam0.identity",
       {"cam0", "vision0"},
       [=](Recording& r, Rng&) {
         const Pose T_CR = camera(r).T_RC.Inverse();
         EachTip(r, [&](Vector3d& p, Vector3d& d) { p = T_CR * p, d = T_CR.R * d; });
         for (auto& s : r.vision0->tips) {
           Matrix3d& C = s.value.covariance_m2;
           C = T_CR.R * C * T_CR.R.transpose();
         }
         camera(r).T_RC = Pose();
       }},
      {"cam0 T_RC inverted",
       "cam0.inverse",
       {"cam0"},
       [=](Recording& r, Rng&) { camera(r).T_RC = camera(r).T_RC.Inverse(); }},
      {"cam0 T_RC in mm",
       "cam0.unit",
       {"cam0"},
       [=](Recording& r, Rng&) { camera(r).T_RC.p *= 1e3; }},
      {"cam0 looks along -z",
       "cam0.axes",
       {"cam0"},
       [=](Recording& r, Rng&) {
         Matrix3d turn = Matrix3d::Identity();
         turn(1, 1) = turn(2, 2) = -1.0;
         camera(r).T_RC.R = camera(r).T_RC.R * turn;
       }},
      {"cam0 focal length in mm",
       "cam0.focal_length",
       {"cam0"},
       [=](Recording& r, Rng& rng) {
         camera(r).fu_px = camera(r).fv_px = Uniform(rng, 3.0, 30.0);
       }},
      {"cam0 principal point outside",
       "cam0.principal_point",
       {"cam0"},
       [=](Recording& r, Rng&) {
         std::swap(camera(r).fu_px, camera(r).cu_px), camera(r).cu_px *= 2;
       }},
      {"cam0 of twice the resolution",
       "cam0.resolution",
       {"cam0"},
       [=](Recording& r, Rng&) { camera(r).width_px /= 2, camera(r).height_px /= 2; }},
      {"cam0 of half the resolution",
       "cam0.resolution",
       {"cam0"},
       [=](Recording& r, Rng&) { camera(r).width_px *= 2, camera(r).height_px *= 2; }},
      {"tags0 too large",
       "tags0.size",
       {"tags0"},
       [](Recording& r, Rng&) {
         for (auto& tag : r.tags0->tags) tag.size_m *= 1.5;
       }},
      {"tags0 in mm",
       "tags0.unit",
       {"tags0"},
       [](Recording& r, Rng&) {
         for (auto& tag : r.tags0->tags) tag.size_m *= 1e3;
       }},
  };
}

}  // namespace flextip::broken
