#include "targets/collar/design.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/error.h"
#include "vision/tags/cells.h"

namespace flextip {
namespace {

constexpr double kUsualOuter_m = 0.012;  // passes the common large port
constexpr double kTagStep_m = 0.0001;
constexpr double kEnd_m = 0.001;  // of the mount beyond the tags' plates, each side
constexpr double kRounding_m = 1e-9;

void CheckRange(const char* what, double found_m, double least_m, double most_m) {
  if (found_m >= least_m && found_m <= most_m) return;
  throw InputError(fmt::format("collar: {} of {:g} mm, expected {:g} to {:g} mm", what,
                               1e3 * found_m, 1e3 * least_m, 1e3 * most_m));
}

std::vector<int> IdsOf(const CollarWishes& wishes) {
  std::vector<int> ids = wishes.ids;
  if (ids.empty()) {
    for (int i = 0; i < wishes.faces; ++i) ids.push_back(i);
  }
  if (static_cast<int>(ids.size()) != wishes.faces) {
    throw InputError(
        fmt::format("collar: {} ids for {} faces, expected one a face", ids.size(), wishes.faces));
  }
  if (std::set<int>(ids.begin(), ids.end()).size() != ids.size()) {
    throw InputError("collar: an id is there twice, expected another on each face");
  }
  return ids;
}

void CheckWishes(const CollarWishes& w) {
  CheckRange("a shaft", w.shaft_diameter_m, 0.0005, 0.05);
  if (w.faces < 3 || w.faces > 16) {
    throw InputError(fmt::format("collar: {} faces, expected 3 to 16", w.faces));
  }
  if (w.tag_size_m) CheckRange("a tag", *w.tag_size_m, 0.001, 0.1);
  if (w.outer_m) CheckRange("an outer diameter", *w.outer_m, 0.001, 0.5);
  CheckRange("a distance from the tip", w.from_tip_m, 0.0, 0.5);
  CheckRange("paper", w.paper_m, 0.0, 0.002);
  CheckRange("a bore's clearance", w.bore_clearance_m, 0.0, 0.002);
}

/// The relations of a regular prism with the paper on its faces.
struct Prism {
  double half_angle, paper_m, least_apothem_m;

  explicit Prism(const CollarWishes& w)
      : half_angle(std::numbers::pi / w.faces),
        paper_m(w.paper_m),
        least_apothem_m(0.5 * (w.shaft_diameter_m + w.bore_clearance_m) + kLeastWall_m) {}

  double OuterOf(double apothem_m) const {
    return 2.0 * (apothem_m + paper_m) / std::cos(half_angle);
  }
  double FaceOf(double apothem_m) const {
    return 2.0 * (apothem_m + paper_m) * std::tan(half_angle);
  }
  double FaceOfOuter(double outer_m) const { return outer_m * std::sin(half_angle); }
  /// Returns the least distance from the axis to a face that is as wide as `plate_m`.
  double ApothemFor(double plate_m) const {
    return std::max(least_apothem_m, 0.5 * plate_m / std::tan(half_angle) - paper_m);
  }
};

/// Throws where the shaft alone needs more than the outer diameter that was asked for.
void CheckOuter(const CollarWishes& w, const Prism& prism) {
  const double least_m = prism.OuterOf(prism.least_apothem_m);
  if (!w.outer_m || *w.outer_m >= least_m - kRounding_m) return;
  throw InputError(fmt::format(
      "collar: {} faces around a shaft of {:g} mm with walls of {:g} mm are {:.2f} mm "
      "over their corners, more than the {:g} mm allowed; allow more, or take more "
      "faces",
      w.faces, 1e3 * w.shaft_diameter_m, 1e3 * kLeastWall_m, 1e3 * least_m, 1e3 * *w.outer_m));
}

/// `plates` is a tag's side with its rim over its size.
double TagSize(const CollarWishes& w, const Prism& prism, double plates) {
  const double outer_m =
      w.outer_m.value_or(std::max(kUsualOuter_m, prism.OuterOf(prism.least_apothem_m)));
  const double face_m = prism.FaceOfOuter(outer_m);
  const double most_m = kTagStep_m * std::floor(face_m / plates / kTagStep_m + 1e-6);
  if (!w.tag_size_m) {
    if (most_m >= 0.001) return most_m;
    throw InputError(fmt::format(
        "collar: a face of {:.2f} mm carries no tag of 1 mm and more; take fewer faces, or allow "
        "a larger outer diameter",
        1e3 * face_m));
  }
  if (!w.outer_m || *w.tag_size_m * plates <= face_m + kRounding_m) return *w.tag_size_m;
  throw InputError(fmt::format(
      "collar: a {} tag of {:g} mm is {:.2f} mm wide with its white rim, and a face of {} within "
      "{:g} mm is {:.2f} mm wide; take a tag of {:.1f} mm, fewer faces, or allow {:.2f} mm",
      w.family, 1e3 * *w.tag_size_m, 1e3 * plates * *w.tag_size_m, w.faces, 1e3 * outer_m,
      1e3 * face_m, 1e3 * most_m, 1e3 * plates * *w.tag_size_m / std::sin(prism.half_angle)));
}

/// Returns a tag's pose in E: x toward the tip, z into the face whose normal is at `angle`.
Pose TagPose(double angle, double from_axis_m, double from_tip_m) {
  const Eigen::Vector3d out(0.0, std::cos(angle), std::sin(angle));
  Pose T_EG;
  T_EG.R.col(0) = Eigen::Vector3d::UnitX();
  T_EG.R.col(1) = Eigen::Vector3d::UnitX().cross(out);
  T_EG.R.col(2) = -out;
  T_EG.p = from_axis_m * out - from_tip_m * Eigen::Vector3d::UnitX();
  return T_EG;
}

}  // namespace

CollarDesign DesignCollar(const CollarWishes& wishes) {
  CheckWishes(wishes);
  const std::vector<int> ids = IdsOf(wishes);
  int cells = 0, border_cells = 1;
  for (const int id : ids) {
    const TagCells tag = ReadTagCells(wishes.family, id);
    cells = tag.cells;
    border_cells = tag.border_cells;
  }
  const Prism prism(wishes);
  CheckOuter(wishes, prism);
  CollarDesign d{.wishes = wishes};
  d.tag_size_m = TagSize(wishes, prism, static_cast<double>(cells) / border_cells);
  d.cell_m = d.tag_size_m / border_cells;
  d.plate_m = d.cell_m * cells;
  d.bore_m = wishes.shaft_diameter_m + wishes.bore_clearance_m;
  const double apothem_m = prism.ApothemFor(d.plate_m);
  d.across_m = 2.0 * apothem_m;
  d.outer_m = prism.OuterOf(apothem_m);
  d.face_m = prism.FaceOf(apothem_m);
  d.strip_face_m = 2.0 * (apothem_m + 0.5 * wishes.paper_m) * std::tan(prism.half_angle);
  d.length_m = d.plate_m + 2.0 * kEnd_m;
  if (wishes.from_tip_m < 0.5 * d.length_m) {
    throw InputError(fmt::format(
        "collar: {:.2f} mm long with its middle {:g} mm from the tip, it would reach past the "
        "tip; its middle must be {:.2f} mm away or more",
        1e3 * d.length_m, 1e3 * wishes.from_tip_m, 0.5e3 * d.length_m));
  }
  d.collar.family = wishes.family;
  for (int i = 0; i < wishes.faces; ++i) {
    d.collar.tags.push_back(
        {ids[static_cast<std::size_t>(i)], d.tag_size_m,
         TagPose(2.0 * prism.half_angle * i, apothem_m + wishes.paper_m, wishes.from_tip_m)});
  }
  return d;
}

}  // namespace flextip
