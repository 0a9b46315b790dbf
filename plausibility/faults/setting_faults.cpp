#include <fmt/format.h>

#include "plausibility/faults/fault_list.h"
#include "plausibility/limits/limits.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector3d;

void AddEmDistance(FaultList& list) {
  const double length = list.scene().instrument.length_m, given = list.scene().em0_from_tip_m;
  list.Add("em0.distance", "em0",
           fmt::format("distance_from_tip_m: {:.4g} looks measured from the wrist", given),
           fmt::format("distance_from_tip_m: {:.4g} in em0/sensor.yaml", length - given),
           [](Scene& s) { s.em0_from_tip_m = s.instrument.length_m - s.em0_from_tip_m; });
  for (const LengthUnit& unit : kLengthUnits) {
    list.Add("em0.distance", "em0",
             fmt::format("distance_from_tip_m: {:.4g} looks like {}", given, unit.name),
             fmt::format("distance_from_tip_m: {:.4g} in em0/sensor.yaml", given * unit.factor),
             [factor = unit.factor](Scene& s) { s.em0_from_tip_m *= factor; });
  }
}

void AddPort(FaultList& list) {
  const Vector3d p = list.scene().p_RP;
  const auto mend = [](const Vector3d& x) {
    return fmt::format("port: position_m: [{:.6g}, {:.6g}, {:.6g}] in recording.yaml", x.x(), x.y(),
                       x.z());
  };
  for (const LengthUnit& unit : kLengthUnits) {
    if (!list.IsLarge(p)) break;
    list.Add("port.unit", "port", fmt::format("its position looks like {}", unit.name),
             mend(unit.factor * p), [factor = unit.factor](Scene& s) { s.p_RP *= factor; });
  }
  if (!list.scene().camera) return;
  const Pose T_RC = list.scene().camera->T_RC;
  list.Add("port.frame", "port", "its position looks given in the camera's frame C", mend(T_RC * p),
           [T_RC](Scene& s) { s.p_RP = T_RC * s.p_RP; });
}

void AddShaft(FaultList& list) {
  const Instrument& instrument = list.scene().instrument;
  for (const LengthUnit& unit : kLengthUnits) {
    list.Add("instrument.length_unit", "length",
             fmt::format("length_m: {:.4g} looks like {}", instrument.length_m, unit.name),
             fmt::format("length_m: {:.4g} in recording.yaml", instrument.length_m * unit.factor),
             [factor = unit.factor](Scene& s) { s.instrument.length_m *= factor; });
  }
  struct StiffnessUnit {
    double factor;
    const char* name;
  };
  const double EI = instrument.bending_stiffness_Nm2, diameter = instrument.outer_diameter_m;
  for (const StiffnessUnit& of :
       {StiffnessUnit{1e-6, "N mm2"}, StiffnessUnit{1e-4, "N cm2"},
        StiffnessUnit{1e-3, "mN m2 or kN mm2"}, StiffnessUnit{1e3, "kN m2"}}) {
    if (!IsShaftsStiffness(EI * of.factor, diameter)) continue;
    list.Add("instrument.stiffness", "stiffness",
             fmt::format("bending_stiffness_Nm2: {:.4g} looks like {}", EI, of.name),
             fmt::format("bending_stiffness_Nm2: {:.4g} in recording.yaml", EI * of.factor),
             [factor = of.factor](Scene& s) { s.instrument.bending_stiffness_Nm2 *= factor; });
  }
}

}  // namespace

void AddSensorFaults(FaultList& list) {
  if (list.scene().Has("em1")) {
    list.Add("em0.swapped", "em0", "em0 and em1 look swapped: em0 is at the port",
             "exchange the folders em0 and em1", [](Scene& scene) {
               for (Instant& now : scene.instants) std::swap(now.em0, now.em1);
             });
  }
  if (list.scene().Has("em0")) {
    list.Add("em0.swapped", "em0", "em0 and wrist0 look swapped",
             "exchange the poses of em0 and wrist0", [](Scene& scene) {
               for (Instant& now : scene.instants)
                 if (now.em0) std::swap(now.em0, now.wrist);
             });
  }
  if (!list.scene().Has("vision0")) return;
  list.Add("vision0.direction", "vision0", "directions point from the tip to the wrist",
           "change the sign of the columns d_RE", [](Scene& scene) {
             for (Instant& now : scene.instants)
               if (now.tip && now.tip->d) now.tip->d = -*now.tip->d;
           });
  if (!list.scene().camera) return;
  list.Add("vision0.direction", "vision0", "directions look as if given in the camera's frame C",
           "multiply the columns d_RE by the rotation of T_RC",
           [R_RC = list.scene().camera->T_RC.R](Scene& scene) {
             for (Instant& now : scene.instants)
               if (now.tip && now.tip->d) now.tip->d = R_RC * *now.tip->d;
           });
}

void AddSettingFaults(FaultList& list) {
  if (list.scene().Has("em0")) AddEmDistance(list);
  AddPort(list);
  AddShaft(list);
}

void AddCameraFaults(FaultList& list) {
  if (!list.scene().camera) return;
  const auto add = [&](const std::string& id, const std::string& looks, const std::string& mend,
                       std::function<void(Pose&)> change) {
    list.Add(id, "cam0", looks, mend,
             [change = std::move(change)](Scene& scene) { change(scene.camera->T_RC); });
  };
  add("cam0.inverse", "T_RC looks inverted: of R in the camera",
      "write the inverse of T_RC in cam0/sensor.yaml", [](Pose& T) { T = T.Inverse(); });
  for (const LengthUnit& unit : kLengthUnits) {
    if (!list.IsLarge(list.scene().camera->T_RC.p)) break;
    add("cam0.unit", fmt::format("the translation of T_RC looks like {}", unit.name),
        fmt::format("multiply the last column of T_RC by {}", unit.factor),
        [factor = unit.factor](Pose& T) { T.p *= factor; });
    add("cam0.unit", fmt::format("T_RC looks inverted, with its translation in {}", unit.name),
        "write the inverse of T_RC in metres", [factor = unit.factor](Pose& T) {
          T.p *= factor;
          T = T.Inverse();
        });
  }
  add("cam0.axes", "T_RC looks made for a camera that looks along -z with y up",
      "change the sign of the second and third column of T_RC's rotation", [](Pose& T) {
        T.R.col(1) = -T.R.col(1).eval();
        T.R.col(2) = -T.R.col(2).eval();
      });
}

}  // namespace flextip::plausibility
