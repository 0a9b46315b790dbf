#include <fmt/format.h>

#include <utility>

#include "core/linear_algebra.h"
#include "core/median.h"
#include "plausibility/faults/fault.h"
#include "plausibility/relations/shaft_curve.h"

namespace flextip::plausibility {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kFewest = 10;

/// The shaft at each instant: bent where directions are known, else straight.
std::vector<ShaftCurve> CurvesOf(const Scene& scene) {
  std::vector<ShaftCurve> curves;
  for (const Instant& now : scene.instants) {
    auto curve = CurveToEm(scene, now);
    if (!curve) curve = CurveToTip(scene, now);
    const auto straight_to = [&](const Vector3d& p) {
      curve = ShaftCurve{{now.wrist->p, p}, (now.wrist->p - p).norm()};
    };
    if (!curve && now.em0) straight_to(now.em0->p);
    if (!curve && now.tip) straight_to(now.tip->p);
    if (curve && curve->length_m > 0.0) curves.push_back(std::move(*curve));
  }
  return curves;
}

/// The point that the shafts pass nearest to, all instants together.
std::optional<Vector3d> CommonPoint(const std::vector<ShaftCurve>& curves) {
  constexpr int kIterations = 30;
  constexpr double kPull = 1e-6, kDone_m = 1e-6;
  if (curves.size() < kFewest) return {};
  Vector3d p = Vector3d::Zero();
  for (const ShaftCurve& c : curves)
    p += c.points[c.points.size() / 2] / static_cast<double>(curves.size());
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Matrix3d A = kPull * Matrix3d::Identity();
    Vector3d b = kPull * p;
    for (const ShaftCurve& c : curves) {
      Vector3d along = Vector3d::UnitX();
      const Vector3d at = c.Nearest(p, &along);
      const Matrix3d across = Matrix3d::Identity() - along * along.transpose();
      A += across;
      b += across * at;
    }
    const Vector3d next = Ldlt(A).Solve(b);
    const bool done = (next - p).norm() < kDone_m;
    p = next;
    if (done) break;
  }
  return p;
}

/// How long the shaft is from the wrist to what is seen of its end (m).
std::vector<double> LengthsSeen(const Scene& scene) {
  std::vector<double> lengths;
  for (const Instant& now : scene.instants) {
    if (const auto curve = CurveToTip(scene, now)) {
      lengths.push_back(curve->length_m);
    } else if (const auto to_em = CurveToEm(scene, now)) {
      lengths.push_back(to_em->length_m + scene.em0_from_tip_m);
    } else if (now.tip) {
      lengths.push_back((now.tip->p - now.wrist->p).norm());
    } else if (now.em0) {
      lengths.push_back((now.em0->p - now.wrist->p).norm() + scene.em0_from_tip_m);
    }
  }
  return lengths;
}

/// The curve's bend goes with the length that is assumed: it is found again with what was found.
std::optional<double> LengthOf(const Scene& scene) {
  constexpr int kIterations = 4;
  Scene changed = scene;
  // Straight lines begin, whatever the stated length is.
  std::vector<double> straight;
  for (const Instant& now : scene.instants) {
    if (now.tip) {
      straight.push_back((now.tip->p - now.wrist->p).norm());
    } else if (now.em0) {
      straight.push_back((now.em0->p - now.wrist->p).norm() + scene.em0_from_tip_m);
    }
  }
  if (straight.size() < kFewest) return {};
  changed.instrument.length_m = Median(std::move(straight));
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const std::vector<double> lengths = LengthsSeen(changed);
    if (lengths.size() < kFewest) break;
    changed.instrument.length_m = Median(lengths);
  }
  return changed.instrument.length_m;
}

}  // namespace

std::vector<Fault> SearchedFaultsOf(const Scene& scene) {
  std::vector<Fault> faults;
  if (const auto p = CommonPoint(CurvesOf(scene))) {
    faults.push_back(
        {"port.place", "port",
         fmt::format("port: the shaft passes {:.0f} mm beside it", 1e3 * (*p - scene.p_RP).norm()),
         fmt::format("port: position_m: [{:.4f}, {:.4f}, {:.4f}] in recording.yaml "
                     "(where wrist and tip sensors have the shaft turn)",
                     p->x(), p->y(), p->z()),
         [p = *p](Scene& s) { s.p_RP = p; }});
  }
  if (const auto length = LengthOf(scene)) {
    faults.push_back({"instrument.length", "length",
                      fmt::format("length: {:.4g} m are stated, the sensors see {:.3f} m from "
                                  "wrist to tip",
                                  scene.instrument.length_m, *length),
                      fmt::format("length_m: {:.3f} in recording.yaml", *length),
                      [length = *length](Scene& s) { s.instrument.length_m = length; }});
  }
  return faults;
}

}  // namespace flextip::plausibility
