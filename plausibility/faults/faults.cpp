#include <utility>

#include "plausibility/faults/fault_list.h"

namespace flextip::plausibility {

std::vector<Fault> FaultsOf(const Scene& scene) {
  FaultList list(scene);
  if (scene.instants.empty()) return {};
  AddPositionFaults(list, "wrist0", "p_RW");
  if (scene.instants.front().wrist->q) AddOrientationFaults(list, "wrist0", "q_RW");
  if (scene.Has("command0")) AddPositionFaults(list, "command0", "p_RW");
  if (scene.Has("em0")) {
    AddPositionFaults(list, "em0", "p_RS");
    AddOrientationFaults(list, "em0", "q_RS");
  }
  if (scene.Has("em1")) AddOrientationFaults(list, "em1", "q_RS");
  if (scene.Has("vision0")) AddPositionFaults(list, "vision0", "p_RE");
  AddSensorFaults(list);
  AddForceFaults(list);
  AddSettingFaults(list);  // moments in another unit look like a stiffness in another: rarer
  AddCameraFaults(list);
  return list.Take();
}

std::function<void(Scene&)> ForEachPlace(const std::string& stream,
                                         std::function<void(Placed&)> change, bool directions) {
  const auto point = [change](Eigen::Vector3d& p) {
    Placed placed{p, {}};
    change(placed);
    p = placed.p;
  };
  return [stream, change = std::move(change), point, directions](Scene& scene) {
    for (Instant& now : scene.instants) {
      if (stream == "wrist0" && now.wrist) change(*now.wrist);
      if (stream == "em0" && now.em0) change(*now.em0);
      if (stream == "em1" && now.em1) change(*now.em1);
      if (stream == "command0" && now.command) point(*now.command);
      if (stream != "vision0" || !now.tip) continue;
      Eigen::Vector3d ahead = now.tip->p + now.tip->d.value_or(Eigen::Vector3d::Zero());
      point(now.tip->p);
      if (!now.tip->d || !directions) continue;
      point(ahead);
      now.tip->d = (ahead - now.tip->p).normalized();
    }
  };
}

}  // namespace flextip::plausibility
