#include <fmt/format.h>

#include <numbers>

#include "plausibility/faults/fault_list.h"

namespace flextip::plausibility {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// The axis of a sensor that lies along the shaft in place of x.
struct NamedAxis {
  Vector3d axis;
  const char* name;
};

/// Returns the shortest turn from x to `axis`; about z where that is -x.
Quaterniond TurnTo(const Vector3d& axis) {
  if (axis.x() < -0.5) return Quaterniond(0.0, 0.0, 0.0, 1.0);
  return Quaterniond::FromTwoVectors(Vector3d::UnitX(), axis);
}

void AddAxes(FaultList& list, const std::string& stream, const std::string& columns) {
  const std::array<NamedAxis, 5> axes{{{Vector3d::UnitZ(), "z"},
                                       {Vector3d::UnitY(), "y"},
                                       {-Vector3d::UnitX(), "-x"},
                                       {-Vector3d::UnitY(), "-y"},
                                       {-Vector3d::UnitZ(), "-z"}}};
  for (const NamedAxis& a : axes) {
    for (int quarter = 0; quarter < 4; ++quarter) {
      const Eigen::AngleAxisd roll(quarter * std::numbers::pi / 2.0, Vector3d::UnitX());
      const Quaterniond turn = TurnTo(a.axis) * Quaterniond(roll);
      list.Add(stream + ".axis", stream,
               fmt::format("its {} axis lies along the shaft, not x", a.name),
               fmt::format("multiply {} of {} by w, x, y, z = {:.4g}, {:.4g}, {:.4g}, {:.4g} from "
                           "the right",
                           columns, stream, turn.w(), turn.x(), turn.y(), turn.z()),
               ForEachPlace(stream, [turn](Placed& x) {
                 if (x.q) x.q = *x.q * turn;
               }));
    }
  }
}

}  // namespace

void AddOrientationFaults(FaultList& list, const std::string& stream, const std::string& columns) {
  list.Add(stream + ".quaternion_order", stream, "quaternions look ordered x, y, z, w",
           fmt::format("import with --quaternion {}=xyzw, or put the columns {} in the order w, x, "
                       "y, z",
                       stream, columns),
           ForEachPlace(stream, [](Placed& x) {
             if (x.q) x.q = Quaterniond(x.q->z(), x.q->w(), x.q->x(), x.q->y());
           }));
  list.Add(stream + ".quaternion_inverse", stream, "orientations look inverted: of R in the sensor",
           fmt::format("change the sign of {}_x, {}_y and {}_z", columns, columns, columns),
           ForEachPlace(stream, [](Placed& x) {
             if (x.q) x.q = x.q->conjugate();
           }));
  if (stream != "em1") {  // of em1 the orientation alone counts
    list.Add(stream + ".inverse", stream, "poses look inverted: of R in the sensor",
             fmt::format("invert the poses of {}: T^-1 in place of T", stream),
             ForEachPlace(stream, [](Placed& x) {
               if (!x.q) return;
               x.q = x.q->conjugate();
               x.p = -(*x.q * x.p);
             }));
  }
  AddAxes(list, stream, columns);
}

}  // namespace flextip::plausibility
