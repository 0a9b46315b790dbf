#include "workspace/map_scenario.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "recording/text/yaml_map.h"

namespace flextip {
namespace {

/// Index of `found` among the names.
template <class Names>
std::size_t OneOf(const YamlMap& map, const std::string& key, const Names& names,
                  const std::string& fallback) {
  const std::string found = fallback.empty() ? map.Text(key) : map.TextOr(key, fallback);
  std::string known;
  for (std::size_t i = 0; i < std::size(names); ++i) {
    if (found == names[i]) return i;
    known += (i > 0 ? ", " : "") + std::string(names[i]);
  }
  throw map.Error(key, fmt::format("found '{}', expected one of {}", found, known));
}

constexpr const char* kArms[] = {"planar", "three_joint"};

/// Reads a file's sections and remembers them, to find the keys nobody asked for.
template <int N>
class Reader {
 public:
  explicit Reader(const YamlMap& top) : top_(top) {}

  MapScenario<N> Read() {
    ReadArm();
    ReadInstrument();
    ReadErrors();
    ReadForce();
    scenario_.setup.gain = top_.PositiveOr("gain", 1.0);
    ReadGrid();
    if (top_.Has("tolerance")) ReadTolerance();
    if (top_.Has("plan")) ReadPlan();
    top_.RefuseUnknown();
    for (const YamlMap& section : sections_) section.RefuseUnknown();
    return std::move(scenario_);
  }

 private:
  YamlMap Section(const YamlMap& map, const std::string& key) {
    sections_.push_back(map.Map(key));
    return sections_.back();
  }

  /// [x, y, z] of the file in A; x must be zero in the plane.
  static VectorN<N> Vector(const YamlMap& map, const std::string& key) {
    const Eigen::Vector3d v = map.Vector3(key);
    if constexpr (N == 3) {
      return v;
    } else {
      if (v.x() == 0.0) return {v.z(), v.y()};
      throw map.Error(
          key, fmt::format("found x = {}, expected 0: a planar arm moves in y and z", v.x()));
    }
  }

  static void ReadLimit(const YamlMap& map, const std::string& key, double& low, double& high) {
    if (!map.Has(key)) return;
    const auto limits = map.Numbers(key, 2);
    if (!(limits[0] < limits[1]))
      throw map.Error(key, fmt::format("found [{}, {}], expected the smaller angle first",
                                       limits[0], limits[1]));
    low = limits[0];
    high = limits[1];
  }

  void ReadArm() {
    const YamlMap map = Section(top_, "arm");
    map.Text("kind");
    PlanarArm& links = LinksOf(scenario_.setup.truth.arm);
    if (map.Has("links_m")) {
      const auto lengths = map.Numbers("links_m", 2);
      if (!(lengths[0] > 0.0 && lengths[1] > 0.0))
        throw map.Error("links_m", fmt::format("found [{}, {}], expected two positive lengths",
                                               lengths[0], lengths[1]));
      links.link1_m = lengths[0];
      links.link2_m = lengths[1];
    }
    LinkLimits& limits = links.limits;
    ReadLimit(map, "joint1_rad", limits.joint1_min, limits.joint1_max);
    ReadLimit(map, "joint2_rad", limits.joint2_min, limits.joint2_max);
    ReadLimit(map, "sum_rad", limits.sum_min, limits.sum_max);
    if constexpr (N == 3) {
      double& base = scenario_.setup.truth.arm.base_max_rad;
      base = map.PositiveOr("base_max_rad", base);
    }
  }

  void ReadInstrument() {
    scenario_.setup.truth.shaft_m = Section(top_, "instrument").Positive("length_m");
    scenario_.setup.truth.p_port = Vector(Section(top_, "port"), "position_m");
  }

  BeliefError<N> ReadBeliefError(const YamlMap& map) {
    BeliefError<N> error;
    if (map.Has("port_m")) error.port_m = Vector(map, "port_m");
    if (map.Has("links_m")) {
      const auto links = map.Numbers("links_m", 2);
      error.links_m = {links[0], links[1]};
    }
    if (map.Has("joints_rad")) {
      const auto joints = map.Numbers("joints_rad", N);
      error.joints_rad = VectorN<N>::Map(joints.data());
    }
    error.shaft_m = map.NumberOr("shaft_m", 0.0);
    return error;
  }

  void ReadErrors() {
    if (!top_.Has("errors")) return;
    const YamlMap map = Section(top_, "errors");
    scenario_.setup.error = ReadBeliefError(map);
    const BeliefError<N>& error = scenario_.setup.error;
    const PlanarArm& links = LinksOf(scenario_.setup.truth.arm);
    if (!(links.link1_m + error.links_m[0] > 0.0 && links.link2_m + error.links_m[1] > 0.0))
      throw map.Error("links_m", "leaves a believed link without length");
    if (!(scenario_.setup.truth.shaft_m + error.shaft_m > 0.0))
      throw map.Error("shaft_m", "leaves the believed shaft without length");
  }

  void ReadForce() {
    if (!top_.Has("tip_force")) return;
    const YamlMap map = Section(top_, "tip_force");
    scenario_.setup.force =
        TipForce<N>{.bending_stiffness_Nm2 = map.Positive("bending_stiffness_Nm2"),
                    .force_N = Vector(map, "force_N")};
  }

  void ReadGrid() {
    scenario_.spacing_m = std::max(0.0025, LeastSpacing_m());
    if (top_.Has("grid")) {
      const YamlMap map = Section(top_, "grid");
      scenario_.spacing_m = Spacing(map, scenario_.spacing_m);
      if (map.Has("slices")) ReadSlices(map);
    }
    if (scenario_.slices.empty()) scenario_.slices.emplace_back("zy", Slice<N>{});
  }

  /// So that a typing error does not ask for a billion points.
  double LeastSpacing_m() const { return scenario_.setup.truth.shaft_m / 400.0; }

  double Spacing(const YamlMap& map, double fallback) const {
    const double spacing = map.PositiveOr("spacing_m", fallback);
    const double least = LeastSpacing_m();
    if (spacing < least)
      throw map.Error("spacing_m", fmt::format("found {}, expected at least {:.3g} (the shaft's "
                                               "length over 400)",
                                               spacing, least));
    return spacing;
  }

  void ReadSlices(const YamlMap& grid) {
    if (N == 2) throw grid.Error("slices", "a planar arm has one plane only");
    for (const YamlMap& map : grid.Maps("slices")) {
      sections_.push_back(map);
      constexpr const char* kPlanes[] = {"zy", "zx", "xy"};
      constexpr int kRight[] = {2, 2, 0}, kUp[] = {1, 0, 1};
      const std::size_t plane = OneOf(map, "plane", kPlanes, "");
      const double offset = map.NumberOr("offset_m", 0.0);
      scenario_.slices.emplace_back(
          fmt::format("{} at {:.4g} mm", kPlanes[plane], 1000.0 * offset),
          Slice<N>{.right = kRight[plane], .up = kUp[plane], .offset_m = offset});
    }
    if (scenario_.slices.empty()) throw grid.Error("slices", "found none, expected at least one");
  }

  void ReadTolerance() {
    const YamlMap map = Section(top_, "tolerance");
    ToleranceTask<N>& task = scenario_.tolerance.emplace();
    const YamlMap bounds = Section(map, "bounds");
    task.question.bounds.half_width = ReadBeliefError(bounds);
    const auto half_width = task.question.bounds.half_width.AsVector();
    if ((half_width.array() < 0.0).any() || half_width.isZero(0.0))
      throw map.Error("bounds", "expected numbers that are not negative, some of them positive");
    constexpr const char* kShapes[] = {"box", "ellipsoid"};
    task.question.bounds.shape = BoundShape(OneOf(map, "shape", kShapes, "box"));
    if (map.Has("norm") == map.Has("angle_deg"))
      throw map.Error("tolerance", "expected a limit: either norm or angle_deg");
    const bool angle = map.Has("angle_deg");
    task.question.measure = angle ? Measure::kAngle : Measure::kNorm;
    task.question.limit =
        angle ? map.Positive("angle_deg") * std::numbers::pi / 180.0 : map.Positive("norm");
    if (map.Has("part")) {
      const YamlMap part = Section(map, "part");
      task.question.part_min = Vector(part, "min_m");
      task.question.part_max = Vector(part, "max_m");
      if ((task.question.part_min.array() > task.question.part_max.array()).any())
        throw map.Error("part", "min_m is above max_m");
    }
    task.spacing_m = Spacing(map, std::max(0.005, scenario_.spacing_m));
  }

  void ReadPlan() {
    const YamlMap map = Section(top_, "plan");
    PlanTask<N> task{.start = Vector(map, "start_m"), .goal = Vector(map, "goal_m")};
    const Slice<N>& slice = scenario_.slices.front().second;
    for (const auto& [key, p] :
         {std::pair("start_m", task.start), std::pair("goal_m", task.goal)}) {
      const Eigen::Vector2d in_plane = slice.InPlane(p);
      if ((slice.Point(in_plane.x(), in_plane.y()) - p).norm() > 1e-9)
        throw map.Error(
            key, fmt::format("is not in the first slice ({})", scenario_.slices.front().first));
    }
    constexpr const char* kFaults[] = {"norm", "angle", "stray"};
    task.options.fault = MotionFault(OneOf(map, "error", kFaults, "stray"));
    task.options.weight = map.NonNegativeOr("weight", 10.0);
    task.options.spacing_m = Spacing(map, std::max(0.005, scenario_.spacing_m));
    task.follow.move_m = map.PositiveOr("move_m", task.follow.move_m);
    task.follow.gain = map.PositiveOr("gain", task.follow.gain);
    scenario_.plan = task;
  }

  YamlMap top_;
  std::vector<YamlMap> sections_;
  MapScenario<N> scenario_;
};

}  // namespace

AnyMapScenario ReadMapScenario(const std::filesystem::path& file) {
  const YamlMap top = YamlMap::Load(file);
  if (!top.Has("arm") && top.Has("controllers"))
    throw top.Error("controllers", "a map steers nothing: this is a scenario of flextip simulate");
  const std::size_t kind = OneOf(top.Map("arm"), "kind", kArms, "");
  if (kind == 0) return Reader<2>(top).Read();
  return Reader<3>(top).Read();
}

}  // namespace flextip
