#include <fmt/format.h>

#include "plausibility/faults/fault_list.h"

namespace flextip::plausibility {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

void AddStrain(FaultList& list, const std::string& kind, const std::string& looks,
               const std::string& mend, std::function<void(Vector4d&)> change) {
  list.Add("strain0." + kind, "strain0", looks, mend, [change = std::move(change)](Scene& scene) {
    for (Instant& now : scene.instants)
      if (now.strain_Nm) change(*now.strain_Nm);
  });
}

void AddStrainFaults(FaultList& list) {
  AddStrain(list, "unit", "moments look like N mm (or mNm)",
            "import with --unit strain0=Nmm, or divide the moments by 1000",
            [](Vector4d& m) { m *= 1e-3; });
  AddStrain(list, "unit", "moments look like N cm",
            "import with --unit strain0=Ncm, or divide the moments by 100",
            [](Vector4d& m) { m *= 1e-2; });
  AddStrain(list, "sign", "moments have the other sign: of the part before on the part beyond",
            "change the sign of all moments", [](Vector4d& m) { m = -m; });
  AddStrain(list, "columns", "the columns of y and z look swapped",
            "exchange m1_y with m1_z, and m2_y with m2_z",
            [](Vector4d& m) { m = Vector4d(m[1], m[0], m[3], m[2]); });
  for (int i = 0; i < 2; ++i) {
    AddStrain(list, "sign", fmt::format("the moments about {} have the other sign", "yz"[i]),
              fmt::format("change the sign of m1_{} and m2_{}", "yz"[i], "yz"[i]),
              [i](Vector4d& m) { m[i] = -m[i], m[i + 2] = -m[i + 2]; });
    AddStrain(list, "columns",
              "the columns of y and z look swapped, with a sign: turned by 90 degrees",
              "turn the gages' axes by 90 degrees about the shaft", [i](Vector4d& m) {
                const double s = i == 0 ? 1.0 : -1.0;
                m = Vector4d(s * m[1], -s * m[0], s * m[3], -s * m[2]);
              });
  }
  AddStrain(list, "stations", "the columns of the two stations look swapped",
            "exchange m1_y with m2_y, and m1_z with m2_z",
            [](Vector4d& m) { m = Vector4d(m[2], m[3], m[0], m[1]); });
  const double length = list.scene().instrument.length_m;
  list.Add("strain0.stations", "strain0", "the stations look measured from the tip",
           fmt::format("stations_from_wrist_m: [{:.4g}, {:.4g}] in strain0/sensor.yaml",
                       length - list.scene().station_m[1], length - list.scene().station_m[0]),
           [](Scene& s) {
             const double first = s.instrument.length_m - s.station_m[1];
             s.station_m[1] = s.instrument.length_m - s.station_m[0];
             s.station_m[0] = first;
           });
}

void AddLoad(FaultList& list, const std::string& kind, const std::string& looks,
             const std::string& mend, std::function<void(Vector3d&)> change) {
  list.Add("load0." + kind, "load0", looks, mend, [change = std::move(change)](Scene& scene) {
    for (Instant& now : scene.instants)
      if (now.load_N) change(*now.load_N);
  });
}

void AddLoadFaults(FaultList& list) {
  AddLoad(list, "unit", "forces look like mN", "import with --unit load0=mN, or divide by 1000",
          [](Vector3d& f) { f *= 1e-3; });
  AddLoad(list, "unit", "forces look like grams", "multiply the forces by 0.00981",
          [](Vector3d& f) { f *= 9.81e-3; });
  AddLoad(list, "unit", "forces look like kilograms", "multiply the forces by 9.81",
          [](Vector3d& f) { f *= 9.81; });
  AddLoad(list, "sign", "forces have the other sign: of the tip on what it touches",
          "change the sign of f_x, f_y and f_z", [](Vector3d& f) { f = -f; });
  for (int i = 0; i < 3; ++i) {
    AddLoad(list, "columns", fmt::format("the column f_{} has the other sign", "xyz"[i]),
            fmt::format("change the sign of f_{}", "xyz"[i]), [i](Vector3d& f) { f[i] = -f[i]; });
    const int j = (i + 1) % 3;
    AddLoad(list, "columns",
            fmt::format("the columns f_{} and f_{} look swapped", "xyz"[i], "xyz"[j]),
            fmt::format("exchange f_{} and f_{}", "xyz"[i], "xyz"[j]),
            [i, j](Vector3d& f) { std::swap(f[i], f[j]); });
  }
  list.Add("load0.frame", "load0", "forces look as if given in the wrist's frame W, not in R",
           "turn the forces by the wrist's orientation", [](Scene& scene) {
             for (Instant& now : scene.instants)
               if (now.load_N && now.wrist && now.wrist->q)
                 now.load_N = *now.wrist->q * *now.load_N;
           });
  if (!list.scene().camera) return;
  AddLoad(list, "frame", "forces look as if given in the camera's frame C, not in R",
          "turn the forces by the rotation of T_RC",
          [R = list.scene().camera->T_RC.R](Vector3d& f) { f = R * f; });
}

}  // namespace

void AddForceFaults(FaultList& list) {
  if (list.scene().Has("strain0")) AddStrainFaults(list);
  if (list.scene().Has("load0")) AddLoadFaults(list);
}

}  // namespace flextip::plausibility
