#include <fmt/format.h>

#include "plausibility/faults/fault_list.h"

namespace flextip::plausibility {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr const char* kAxes = "xyz";

/// Returns whether most of a stream's positions are larger than an instrument's in metres.
bool AreLarge(const FaultList& list, const std::string& stream) {
  std::size_t large = 0, all = 0;
  for (const Instant& now : list.scene().instants) {
    std::optional<Vector3d> p;
    if (stream == "wrist0" && now.wrist) p = now.wrist->p;
    if (stream == "em0" && now.em0) p = now.em0->p;
    if (stream == "command0" && now.command) p = now.command;
    if (stream == "vision0" && now.tip) p = now.tip->p;
    if (!p) continue;
    ++all;
    if (list.IsLarge(*p)) ++large;
  }
  return 2 * large > all;
}

void AddUnits(FaultList& list, const std::string& stream, const std::string& columns) {
  if (!AreLarge(list, stream)) return;
  for (const LengthUnit& unit : kLengthUnits) {
    list.Add(stream + ".unit", stream, fmt::format("positions look like {}", unit.name),
             fmt::format("import with --unit {}={}, or multiply the columns {} by {}", stream,
                         unit.option, columns, unit.factor),
             ForEachPlace(stream, [factor = unit.factor](Placed& x) { x.p *= factor; }));
  }
}

void AddOrders(FaultList& list, const std::string& stream, const std::string& columns) {
  constexpr std::array<std::array<int, 3>, 5> kOrders{
      {{1, 0, 2}, {0, 2, 1}, {2, 1, 0}, {1, 2, 0}, {2, 0, 1}}};
  for (const auto& order : kOrders) {
    list.Add(stream + ".columns", stream,
             fmt::format("position columns look swapped: {}{}{} in place of xyz", kAxes[order[0]],
                         kAxes[order[1]], kAxes[order[2]]),
             fmt::format("swap the columns {} of {}", columns, stream),
             ForEachPlace(
                 stream,
                 [order](Placed& x) {
                   const Vector3d p = x.p;
                   for (int i = 0; i < 3; ++i) x.p[order[static_cast<std::size_t>(i)]] = p[i];
                 },
                 false));
  }
}

/// The orientation of axes that are mirrored along axis `i`.
Quaterniond Mirrored(const Quaterniond& q, int i) {
  Quaterniond m = q;
  for (int j = 0; j < 3; ++j)
    if (j != i) m.vec()[j] = -m.vec()[j];
  return m;
}

void AddSigns(FaultList& list, const std::string& stream, const std::string& columns) {
  for (int i = 0; i < 3; ++i) {
    list.Add(stream + ".mirrored", stream,
             fmt::format("axes look left-handed: {} points the other way", kAxes[i]),
             fmt::format("change the sign of {}_{} and mirror the orientation with it", columns,
                         kAxes[i]),
             ForEachPlace(stream, [i](Placed& x) {
               x.p[i] = -x.p[i];
               if (x.q) x.q = Mirrored(*x.q, i);
             }));
    list.Add(stream + ".columns", stream,
             fmt::format("column {}_{} has the wrong sign", columns, kAxes[i]),
             fmt::format("change the sign of {}_{}", columns, kAxes[i]),
             ForEachPlace(
                 stream, [i](Placed& x) { x.p[i] = -x.p[i]; }, false));
  }
}

void AddCameraFrame(FaultList& list, const std::string& stream) {
  if (!list.scene().camera) return;
  const Pose T_RC = list.scene().camera->T_RC;
  const Quaterniond q_RC = T_RC.Quaternion();
  const auto to_R = ForEachPlace(stream, [T_RC, q_RC](Placed& x) {
    x.p = T_RC * x.p;
    if (x.q) x.q = q_RC * *x.q;
  });
  const std::string looks = "poses look as if given in the camera's frame C, not in R";
  const std::string mend =
      fmt::format("multiply the poses of {} by T_RC of cam0/sensor.yaml from the left", stream);
  list.Add(stream + ".frame", stream, looks, mend, to_R);
  if (stream != "vision0") return;
  list.Add(stream + ".frame", stream, looks, mend + ", turn the covariances with it",
           [to_R, T_RC](Scene& scene) {
             to_R(scene);
             for (Instant& now : scene.instants)
               if (now.tip && now.tip->sight) now.tip->sight = T_RC.R * *now.tip->sight;
           });
}

void AddWristFrame(FaultList& list, const std::string& stream) {
  if (stream != "em0" && stream != "vision0") return;
  list.Add(stream + ".frame", stream, "poses look as if given in the wrist's frame W, not in R",
           fmt::format("multiply the poses of {} by the wrist's pose from the left", stream),
           [stream](Scene& scene) {
             for (Instant& now : scene.instants) {
               if (!now.wrist || !now.wrist->q) continue;
               const Quaterniond q = *now.wrist->q;
               if (stream == "em0" && now.em0) {
                 now.em0->p = now.wrist->p + q * now.em0->p;
                 if (now.em0->q) now.em0->q = q * *now.em0->q;
               }
               if (stream == "vision0" && now.tip) {
                 now.tip->p = now.wrist->p + q * now.tip->p;
                 if (now.tip->d) now.tip->d = q * *now.tip->d;
               }
             }
           });
}

}  // namespace

void AddPositionFaults(FaultList& list, const std::string& stream, const std::string& columns) {
  AddUnits(list, stream, columns);
  AddOrders(list, stream, columns);
  AddSigns(list, stream, columns);
  AddCameraFrame(list, stream);
  AddWristFrame(list, stream);
  // The port is a common origin of trackers and robots.
  list.Add(stream + ".frame", stream,
           "positions look as if given from the port, not from R's origin",
           fmt::format("add the port's position to the columns {} of {}", columns, stream),
           ForEachPlace(stream, [p = list.scene().p_RP](Placed& x) { x.p += p; }));
}

}  // namespace flextip::plausibility
