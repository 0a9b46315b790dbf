#include "plausibility/ways.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/median.h"
#include "plausibility/relations.h"

namespace flextip::plausibility {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

using Change = std::function<void(Placed&)>;

/// Applies a change to every place of a stream, and to vision0's `directions`.
std::function<void(Scene&)> ForEach(const std::string& stream, Change change,
                                    bool directions = true) {
  return [stream, change = std::move(change), directions](Scene& scene) {
    for (Instant& now : scene.instants) {
      if (stream == "wrist0" && now.wrist) change(*now.wrist);
      if (stream == "em0" && now.em0) change(*now.em0);
      if (stream == "em1" && now.em1) change(*now.em1);
      if (stream == "command0" && now.command) {
        Placed placed{*now.command, {}};
        change(placed);
        now.command = placed.p;
      }
      if (stream == "vision0" && now.tip) {
        Placed placed{now.tip->p, {}};
        change(placed);
        if (now.tip->d && directions) {
          // Positions change linearly, and a direction as the difference of two.
          Placed ahead{now.tip->p + *now.tip->d, {}};
          change(ahead);
          now.tip->d = (ahead.p - placed.p).normalized();
        }
        now.tip->p = placed.p;
      }
    }
  };
}

struct Unit {
  double factor;  ///< from the numbers to metres
  const char *name, *option;
};
constexpr std::array<Unit, 3> kUnits{
    {{1e-3, "millimetres", "mm"}, {1e-2, "centimetres", "cm"}, {0.0254, "inches", "inch"}}};

/// The orientation of axes that are mirrored along axis `i`.
Quaterniond Mirrored(const Quaterniond& q, int i) {
  Quaterniond m = q;
  for (int j = 0; j < 3; ++j)
    if (j != i) m.vec()[j] = -m.vec()[j];
  return m;
}

class Ways {
 public:
  explicit Ways(const Scene& scene) : scene_(scene) {}

  std::vector<Way> Take() { return std::move(ways_); }

  void AddAll() {
    if (scene_.instants.empty()) return;
    Oriented("wrist0", "p_RW", "q_RW", scene_.instants.front().wrist->q.has_value());
    if (scene_.Has("command0")) Positions("command0", "p_RW");
    if (scene_.Has("em0")) {
      Oriented("em0", "p_RS", "q_RS", true);
      EmDistance();
    }
    if (scene_.Has("em1")) {
      Orientations("em1", "q_RS");
      Swap();
    }
    if (scene_.Has("vision0")) {
      Positions("vision0", "p_RE");
      TipDirection();
    }
    Port();
    Shaft();
    if (scene_.Has("strain0")) Strain();
    if (scene_.Has("load0")) Load();
    if (scene_.camera) Camera();
  }

 private:
  void Add(const std::string& id, const std::string& stream, const std::string& looks,
           const std::string& mend, std::function<void(Scene&)> undo) {
    ways_.push_back({id, stream, stream + ": " + looks, mend, false, std::move(undo)});
  }

  /// Numbers of another unit than metres are larger than an instrument.
  bool Large(const Vector3d& p) const { return p.norm() > 2.0 * scene_.instrument.length_m; }
  bool AreLarge(const std::string& stream) const {
    std::size_t large = 0, all = 0;
    for (const Instant& now : scene_.instants) {
      std::optional<Vector3d> p;
      if (stream == "wrist0" && now.wrist) p = now.wrist->p;
      if (stream == "em0" && now.em0) p = now.em0->p;
      if (stream == "command0" && now.command) p = *now.command;
      if (stream == "vision0" && now.tip) p = now.tip->p;
      if (!p) continue;
      ++all;
      if (Large(*p)) ++large;
    }
    return 2 * large > all;
  }

  void Positions(const std::string& stream, const std::string& columns) {
    for (const Unit& unit : kUnits) {
      if (!AreLarge(stream)) break;
      Add(stream + ".unit", stream, fmt::format("positions look like {}", unit.name),
          fmt::format("import with --unit {}={}, or multiply the columns {} by {}", stream,
                      unit.option, columns, unit.factor),
          ForEach(stream, [factor = unit.factor](Placed& x) { x.p *= factor; }));
    }
    constexpr std::array<std::array<int, 3>, 5> kOrders{
        {{1, 0, 2}, {0, 2, 1}, {2, 1, 0}, {1, 2, 0}, {2, 0, 1}}};
    for (const auto& order : kOrders) {
      Add(stream + ".columns", stream,
          fmt::format("position columns look swapped: {}{}{} in place of xyz", "xyz"[order[0]],
                      "xyz"[order[1]], "xyz"[order[2]]),
          fmt::format("swap the columns {} of {}", columns, stream),
          ForEach(
              stream,
              [order](Placed& x) {
                const Vector3d p = x.p;
                for (int i = 0; i < 3; ++i) x.p[order[static_cast<std::size_t>(i)]] = p[i];
              },
              false));
    }
    for (int i = 0; i < 3; ++i) {
      Add(stream + ".mirrored", stream,
          fmt::format("axes look left-handed: {} points the other way", "xyz"[i]),
          fmt::format("change the sign of {}_{} and mirror the orientation with it", columns,
                      "xyz"[i]),
          ForEach(stream, [i](Placed& x) {
            x.p[i] = -x.p[i];
            if (x.q) x.q = Mirrored(*x.q, i);
          }));
      Add(stream + ".columns", stream,
          fmt::format("column {}_{} has the wrong sign", columns, "xyz"[i]),
          fmt::format("change the sign of {}_{}", columns, "xyz"[i]),
          ForEach(
              stream, [i](Placed& x) { x.p[i] = -x.p[i]; }, false));
    }
    if (scene_.camera) {
      const Pose T_RC = scene_.camera->T_RC;
      const Quaterniond q_RC = T_RC.Quaternion();
      const auto to_R = ForEach(stream, [T_RC, q_RC](Placed& x) {
        x.p = T_RC * x.p;
        if (x.q) x.q = q_RC * *x.q;
      });
      const std::string looks = "poses look as if given in the camera's frame C, not in R";
      const std::string mend =
          fmt::format("multiply the poses of {} by T_RC of cam0/sensor.yaml from the left", stream);
      Add(stream + ".frame", stream, looks, mend, to_R);
      if (stream == "vision0") {
        Add("vision0.frame", stream, looks, mend + ", turn the covariances with it",
            [to_R, T_RC](Scene& scene) {
              to_R(scene);
              for (Instant& now : scene.instants)
                if (now.tip && now.tip->sight) now.tip->sight = T_RC.R * *now.tip->sight;
            });
      }
    }
    // The port is a common origin of trackers and robots.
    Add(stream + ".frame", stream, "positions look as if given from the port, not from R's origin",
        fmt::format("add the port's position to the columns {} of {}", columns, stream),
        ForEach(stream, [p = scene_.p_RP](Placed& x) { x.p += p; }));
    if (stream == "em0" || stream == "vision0") {
      Add(stream + ".frame", stream, "poses look as if given in the wrist's frame W, not in R",
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
  }

  void Orientations(const std::string& stream, const std::string& columns) {
    Add(stream + ".quaternion_order", stream, "quaternions look ordered x, y, z, w",
        fmt::format(
            "import with --quaternion {}=xyzw, or put the columns {} in the order w, x, y, z",
            stream, columns),
        ForEach(stream, [](Placed& x) {
          if (x.q) x.q = Quaterniond(x.q->z(), x.q->w(), x.q->x(), x.q->y());
        }));
    Add(stream + ".quaternion_inverse", stream, "orientations look inverted: of R in the sensor",
        fmt::format("change the sign of {}_x, {}_y and {}_z", columns, columns, columns),
        ForEach(stream, [](Placed& x) {
          if (x.q) x.q = x.q->conjugate();
        }));
    // The half turn that takes one axis to x, and its opposite.
    struct AxisName {
      Vector3d axis;
      const char* name;
    };
    const std::array<AxisName, 5> axes{{{Vector3d::UnitZ(), "z"},
                                        {Vector3d::UnitY(), "y"},
                                        {-Vector3d::UnitX(), "-x"},
                                        {-Vector3d::UnitY(), "-y"},
                                        {-Vector3d::UnitZ(), "-z"}}};
    for (const AxisName& a : axes) {
      for (int quarter = 0; quarter < 4; ++quarter) {
        const Quaterniond to_axis = a.axis.x() < -0.5
                                        ? Quaterniond(0.0, 0.0, 0.0, 1.0)
                                        : Quaterniond::FromTwoVectors(Vector3d::UnitX(), a.axis);
        const Eigen::AngleAxisd roll(quarter * std::numbers::pi / 2.0, Vector3d::UnitX());
        const Quaterniond turn = to_axis * Quaterniond(roll);
        Add(stream + ".axis", stream,
            fmt::format("its {} axis lies along the shaft, not x", a.name),
            fmt::format("multiply {} of {} by w, x, y, z = {:.4g}, {:.4g}, {:.4g}, {:.4g} from the "
                        "right",
                        columns, stream, turn.w(), turn.x(), turn.y(), turn.z()),
            ForEach(stream, [turn](Placed& x) {
              if (x.q) x.q = *x.q * turn;
            }));
      }
    }
  }

  void Oriented(const std::string& stream, const std::string& places, const std::string& columns,
                bool oriented) {
    Positions(stream, places);
    if (!oriented) return;
    Orientations(stream, columns);
    Add(stream + ".inverse", stream, "poses look inverted: of R in the sensor",
        fmt::format("invert the poses of {}: T^-1 in place of T", stream),
        ForEach(stream, [](Placed& x) {
          if (!x.q) return;
          x.q = x.q->conjugate();
          x.p = -(*x.q * x.p);
        }));
  }

  void EmDistance() {
    const double length = scene_.instrument.length_m, given = scene_.em0_from_tip_m;
    Add("em0.distance", "em0",
        fmt::format("distance_from_tip_m: {:.4g} looks measured from the wrist", given),
        fmt::format("distance_from_tip_m: {:.4g} in em0/sensor.yaml", length - given),
        [](Scene& scene) {
          scene.em0_from_tip_m = scene.instrument.length_m - scene.em0_from_tip_m;
        });
    for (const Unit& unit : kUnits) {
      Add("em0.distance", "em0",
          fmt::format("distance_from_tip_m: {:.4g} looks like {}", given, unit.name),
          fmt::format("distance_from_tip_m: {:.4g} in em0/sensor.yaml", given * unit.factor),
          [factor = unit.factor](Scene& scene) { scene.em0_from_tip_m *= factor; });
    }
  }

  void Swap() {
    Add("em0.swapped", "em0", "em0 and em1 look swapped: em0 is at the port",
        "exchange the folders em0 and em1", [](Scene& scene) {
          for (Instant& now : scene.instants) std::swap(now.em0, now.em1);
        });
    Add("em0.swapped", "em0", "em0 and wrist0 look swapped", "exchange the poses of em0 and wrist0",
        [](Scene& scene) {
          for (Instant& now : scene.instants)
            if (now.em0) std::swap(now.em0, now.wrist);
        });
  }

  void TipDirection() {
    Add("vision0.direction", "vision0", "directions point from the tip to the wrist",
        "change the sign of the columns d_RE", [](Scene& scene) {
          for (Instant& now : scene.instants)
            if (now.tip && now.tip->d) now.tip->d = -*now.tip->d;
        });
    if (!scene_.camera) return;
    const Matrix3d R_RC = scene_.camera->T_RC.R;
    Add("vision0.direction", "vision0", "directions look as if given in the camera's frame C",
        "multiply the columns d_RE by the rotation of T_RC", [R_RC](Scene& scene) {
          for (Instant& now : scene.instants)
            if (now.tip && now.tip->d) now.tip->d = R_RC * *now.tip->d;
        });
  }

  void Port() {
    const Vector3d p = scene_.p_RP;
    const auto mend = [](const Vector3d& x) {
      return fmt::format("port: position_m: [{:.6g}, {:.6g}, {:.6g}] in recording.yaml", x.x(),
                         x.y(), x.z());
    };
    for (const Unit& unit : kUnits) {
      if (!Large(p)) break;
      Add("port.unit", "port", fmt::format("its position looks like {}", unit.name),
          mend(unit.factor * p), [factor = unit.factor](Scene& s) { s.p_RP *= factor; });
    }
    if (!scene_.camera) return;
    const Pose T_RC = scene_.camera->T_RC;
    Add("port.frame", "port", "its position looks given in the camera's frame C", mend(T_RC * p),
        [T_RC](Scene& s) { s.p_RP = T_RC * s.p_RP; });
  }

  void Shaft() {
    const double length = scene_.instrument.length_m;
    for (const Unit& unit : kUnits) {
      Add("instrument.length_unit", "length",
          fmt::format("length_m: {:.4g} looks like {}", length, unit.name),
          fmt::format("length_m: {:.4g} in recording.yaml", length * unit.factor),
          [factor = unit.factor](Scene& s) { s.instrument.length_m *= factor; });
    }
    struct Stiffness {
      double factor;
      const char* name;
    };
    for (const Stiffness& of : {Stiffness{1e-6, "N mm2"}, Stiffness{1e-4, "N cm2"},
                                Stiffness{1e-3, "mN m2 or kN mm2"}, Stiffness{1e3, "kN m2"}}) {
      Add("instrument.stiffness", "stiffness",
          fmt::format("bending_stiffness_Nm2: {:.4g} looks like {}",
                      scene_.instrument.bending_stiffness_Nm2, of.name),
          fmt::format("bending_stiffness_Nm2: {:.4g} in recording.yaml",
                      scene_.instrument.bending_stiffness_Nm2 * of.factor),
          [factor = of.factor](Scene& s) { s.instrument.bending_stiffness_Nm2 *= factor; });
    }
  }

  void StrainWay(const std::string& kind, const std::string& looks, const std::string& mend,
                 std::function<void(Eigen::Vector4d&)> change) {
    Add("strain0." + kind, "strain0", looks, mend, [change = std::move(change)](Scene& scene) {
      for (Instant& now : scene.instants)
        if (now.strain_Nm) change(*now.strain_Nm);
    });
  }

  void Strain() {
    StrainWay("unit", "moments look like N mm (or mNm)",
              "import with --unit strain0=Nmm, or divide the moments by 1000",
              [](Eigen::Vector4d& m) { m *= 1e-3; });
    StrainWay("unit", "moments look like N cm", "divide the moments by 100",
              [](Eigen::Vector4d& m) { m *= 1e-2; });
    StrainWay("sign", "moments have the other sign: of the part before on the part beyond",
              "change the sign of all moments", [](Eigen::Vector4d& m) { m = -m; });
    StrainWay("columns", "the columns of y and z look swapped",
              "exchange m1_y with m1_z, and m2_y with m2_z",
              [](Eigen::Vector4d& m) { m = Eigen::Vector4d(m[1], m[0], m[3], m[2]); });
    for (int i = 0; i < 2; ++i) {
      StrainWay("sign", fmt::format("the moments about {} have the other sign", "yz"[i]),
                fmt::format("change the sign of m1_{} and m2_{}", "yz"[i], "yz"[i]),
                [i](Eigen::Vector4d& m) { m[i] = -m[i], m[i + 2] = -m[i + 2]; });
      StrainWay("columns", "the columns of y and z look swapped, with a sign: turned by 90 degrees",
                "turn the gages' axes by 90 degrees about the shaft", [i](Eigen::Vector4d& m) {
                  const double s = i == 0 ? 1.0 : -1.0;
                  m = Eigen::Vector4d(s * m[1], -s * m[0], s * m[3], -s * m[2]);
                });
    }
    StrainWay("stations", "the columns of the two stations look swapped",
              "exchange m1_y with m2_y, and m1_z with m2_z",
              [](Eigen::Vector4d& m) { m = Eigen::Vector4d(m[2], m[3], m[0], m[1]); });
    Add("strain0.stations", "strain0", "the stations look measured from the tip",
        fmt::format("stations_from_wrist_m: [{:.4g}, {:.4g}] in strain0/sensor.yaml",
                    scene_.instrument.length_m - scene_.station_m[1],
                    scene_.instrument.length_m - scene_.station_m[0]),
        [](Scene& scene) {
          const double first = scene.instrument.length_m - scene.station_m[1];
          scene.station_m[1] = scene.instrument.length_m - scene.station_m[0];
          scene.station_m[0] = first;
        });
  }

  void LoadWay(const std::string& kind, const std::string& looks, const std::string& mend,
               std::function<void(Vector3d&)> change) {
    Add("load0." + kind, "load0", looks, mend, [change = std::move(change)](Scene& scene) {
      for (Instant& now : scene.instants)
        if (now.load_N) change(*now.load_N);
    });
  }

  void Load() {
    LoadWay("unit", "forces look like mN", "import with --unit load0=mN, or divide by 1000",
            [](Vector3d& f) { f *= 1e-3; });
    LoadWay("unit", "forces look like grams", "multiply the forces by 0.00981",
            [](Vector3d& f) { f *= 9.81e-3; });
    LoadWay("unit", "forces look like kilograms", "multiply the forces by 9.81",
            [](Vector3d& f) { f *= 9.81; });
    LoadWay("sign", "forces have the other sign: of the tip on what it touches",
            "change the sign of f_x, f_y and f_z", [](Vector3d& f) { f = -f; });
    for (int i = 0; i < 3; ++i) {
      LoadWay("columns", fmt::format("the column f_{} has the other sign", "xyz"[i]),
              fmt::format("change the sign of f_{}", "xyz"[i]), [i](Vector3d& f) { f[i] = -f[i]; });
      const int j = (i + 1) % 3;
      LoadWay("columns", fmt::format("the columns f_{} and f_{} look swapped", "xyz"[i], "xyz"[j]),
              fmt::format("exchange f_{} and f_{}", "xyz"[i], "xyz"[j]),
              [i, j](Vector3d& f) { std::swap(f[i], f[j]); });
    }
    Add("load0.frame", "load0", "forces look as if given in the wrist's frame W, not in R",
        "turn the forces by the wrist's orientation", [](Scene& scene) {
          for (Instant& now : scene.instants)
            if (now.load_N && now.wrist && now.wrist->q) now.load_N = *now.wrist->q * *now.load_N;
        });
    if (!scene_.camera) return;
    LoadWay("frame", "forces look as if given in the camera's frame C, not in R",
            "turn the forces by the rotation of T_RC",
            [R = scene_.camera->T_RC.R](Vector3d& f) { f = R * f; });
  }

  void Camera() {
    const auto way = [&](const std::string& id, const std::string& looks, const std::string& mend,
                         std::function<void(Pose&)> change) {
      Add(id, "cam0", looks, mend,
          [change = std::move(change)](Scene& scene) { change(scene.camera->T_RC); });
    };
    way("cam0.inverse", "T_RC looks inverted: of R in the camera",
        "write the inverse of T_RC in cam0/sensor.yaml", [](Pose& T) { T = T.Inverse(); });
    for (const Unit& unit : kUnits) {
      if (!Large(scene_.camera->T_RC.p)) break;
      way("cam0.unit", fmt::format("the translation of T_RC looks like {}", unit.name),
          fmt::format("multiply the last column of T_RC by {}", unit.factor),
          [factor = unit.factor](Pose& T) { T.p *= factor; });
      way("cam0.unit", fmt::format("T_RC looks inverted, with its translation in {}", unit.name),
          "write the inverse of T_RC in metres", [factor = unit.factor](Pose& T) {
            T.p *= factor;
            T = T.Inverse();
          });
    }
    way("cam0.axes", "T_RC looks made for a camera that looks along -z with y up",
        "change the sign of the second and third column of T_RC's rotation", [](Pose& T) {
          T.R.col(1) = -T.R.col(1).eval();
          T.R.col(2) = -T.R.col(2).eval();
        });
  }

  const Scene& scene_;
  std::vector<Way> ways_;
};

/// The point that the bent shaft passes nearest to, all instants together.
std::optional<Vector3d> CommonPoint(const Scene& scene) {
  std::vector<ShaftCurve> curves;
  for (const Instant& now : scene.instants) {
    auto curve = CurveToEm(scene, now);
    if (!curve) curve = CurveToTip(scene, now);
    if (!curve && now.em0)
      curve = ShaftCurve{{now.wrist->p, now.em0->p}, (now.wrist->p - now.em0->p).norm()};
    if (!curve && now.tip)
      curve = ShaftCurve{{now.wrist->p, now.tip->p}, (now.wrist->p - now.tip->p).norm()};
    if (curve && curve->length_m > 0.0) curves.push_back(std::move(*curve));
  }
  if (curves.size() < 10) return {};
  Vector3d p = Vector3d::Zero();
  for (const ShaftCurve& c : curves)
    p += c.points[c.points.size() / 2] / static_cast<double>(curves.size());
  for (int iteration = 0; iteration < 30; ++iteration) {
    Matrix3d A = 1e-6 * Matrix3d::Identity();
    Vector3d b = 1e-6 * p;
    for (const ShaftCurve& c : curves) {
      Vector3d along = Vector3d::UnitX();
      const Vector3d at = c.Nearest(p, &along);
      const Matrix3d across = Matrix3d::Identity() - along * along.transpose();
      A += across;
      b += across * at;
    }
    const Vector3d next = A.ldlt().solve(b);
    const bool done = (next - p).norm() < 1e-6;
    p = next;
    if (done) break;
  }
  return p;
}

}  // namespace

std::vector<Way> WaysFor(const Scene& scene) {
  Ways ways(scene);
  ways.AddAll();
  return ways.Take();
}

std::vector<Way> SearchedWaysFor(const Scene& scene) {
  std::vector<Way> ways;
  if (const auto p = CommonPoint(scene)) {
    ways.push_back(
        {"port.place", "port",
         fmt::format("port: the shaft passes {:.0f} mm beside it", 1e3 * (*p - scene.p_RP).norm()),
         fmt::format("port: position_m: [{:.4f}, {:.4f}, {:.4f}] in recording.yaml "
                     "(where wrist and tip sensors have the shaft turn)",
                     p->x(), p->y(), p->z()),
         true, [p = *p](Scene& s) { s.p_RP = p; }});
  }
  // How long the shaft is from the wrist to what is seen of its end.
  std::vector<double> lengths;
  for (const Instant& now : scene.instants) {
    if (now.tip) {
      const auto curve = CurveToTip(scene, now);
      lengths.push_back(curve && scene.instrument.length_m < 3.0
                            ? curve->length_m
                            : (now.tip->p - now.wrist->p).norm());
    } else if (now.em0) {
      lengths.push_back((now.em0->p - now.wrist->p).norm() + scene.em0_from_tip_m);
    }
  }
  // With directions scaled by a wrong length the curve is bent: twice more with the new one.
  if (lengths.size() >= 10) {
    double length = Median(lengths);
    for (int iteration = 0; iteration < 3; ++iteration) {
      Scene changed = scene;
      changed.instrument.length_m = length;
      std::vector<double> again;
      for (const Instant& now : changed.instants) {
        if (const auto curve = CurveToTip(changed, now)) {
          again.push_back(curve->length_m);
        } else if (const auto to_em = CurveToEm(changed, now)) {
          again.push_back(to_em->length_m + scene.em0_from_tip_m);
        }
      }
      if (again.size() < 10) break;
      length = Median(again);
    }
    ways.push_back({"instrument.length", "length",
                    fmt::format("length: {:.4g} m are stated, the sensors see {:.3f} m from wrist "
                                "to tip",
                                scene.instrument.length_m, length),
                    fmt::format("length_m: {:.3f} in recording.yaml", length), true,
                    [length](Scene& s) { s.instrument.length_m = length; }});
  }
  return ways;
}

}  // namespace flextip::plausibility
