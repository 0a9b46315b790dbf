#include "simulation/render/scene.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/rotation.h"

namespace flextip::simulation::render {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMargin_px = 4.0;
constexpr double kNear_m = 1e-3;
constexpr double kLeastStep_m = 1e-9;

// 1: as steel.
void SetGloss(double strength, Material& material) {
  material.gloss_wide = static_cast<float>(0.12 * strength);
  material.gloss_narrow = static_cast<float>(0.42 * strength);
}

Material Steel() {
  Material steel;
  steel.albedo = {0.27f, 0.26f, 0.255f};
  SetGloss(1.0, steel);
  return steel;
}

Material Print() {
  Material print;
  print.albedo = {0.86f, 0.87f, 0.87f};
  print.albedo_black = {0.035f, 0.035f, 0.035f};
  return print;
}

}  // namespace

Scene::Scene(const CameraModel& camera, int frame_number)
    : camera_(camera),
      T_CR_(camera.Calibration().T_RC.Inverse()),
      frame_(frame_number),
      width_px_(camera.Calibration().width_px),
      height_px_(camera.Calibration().height_px),
      tiles_across_((width_px_ + kTile_px - 1) / kTile_px),
      tiles_down_((height_px_ + kTile_px - 1) / kTile_px),
      tiles_(static_cast<std::size_t>(tiles_across_) * tiles_down_, 0) {}

void Scene::Finish() {
  materials_.insert(materials_.end(), face_materials_.begin(), face_materials_.end());
  FLEXTIP_CHECK(materials_.size() <= kMaxObjects + 1, "the objects fit their index");
  spans_.assign(tubes_.size(), std::vector<Span>(tiles_.size()));
  for (std::size_t i = 0; i < tubes_.size(); ++i) MarkTube(i);
  for (std::size_t i = 0; i < faces_.size(); ++i) MarkFace(i);
}

void Scene::AddShaft(const ShaftCurve& curve) {
  std::vector<Vector3d> points;
  for (const Vector3d& p : curve.points) {  // points that coincide say nothing
    const Vector3d x = T_CR_ * p;
    if (points.empty() || (x - points.back()).norm() > kLeastStep_m) points.push_back(x);
  }
  AddTube(Tube(points, T_CR_.R * curve.T_RE.R.col(0), 0.5 * curve.diameter_m, {}), Steel());
}

void Scene::AddInstrument(const ShaftCurve& curve, const CollarBody& collar,
                          const Hazards& hazards) {
  AddShaft(curve);
  Material print = Print();
  double bulge_per_m = 0;
  for (const Gloss& gloss : hazards.gloss) {
    if (!gloss.frames.Has(frame_)) continue;
    SetGloss(gloss.strength, print);
    bulge_per_m = gloss.bulge_per_m;
  }
  for (Face& face : collar.FacesSeen(T_CR_ * curve.T_RE)) {
    if (face.tag_id >= 0) face.bulge_per_m = bulge_per_m;
    AddStains(face, print, hazards.stains);
    AddFace(std::move(face), print);
  }
}

// A stain is the face again, in other colours, within the stain's rim. Among objects at the same
// depth the first is seen, so it comes before the face.
void Scene::AddStains(const Face& face, const Material& print, const std::vector<Stain>& stains) {
  for (const Stain& stain : stains) {
    if (face.tag_id < 0 || stain.tag_id != face.tag_id || !stain.frames.Has(frame_)) continue;
    Face film = face;
    film.disc_radius_m = stain.radius_m;
    film.disc_centre = stain.centre_m;
    Material material = print;
    const auto opacity = static_cast<float>(stain.opacity);
    const Eigen::Vector3f colour = stain.albedo_bgr.cast<float>();
    material.albedo += opacity * (colour - material.albedo);
    material.albedo_black += opacity * (colour - material.albedo_black);
    AddFace(std::move(film), material);
  }
}

void Scene::AddOther(const OtherInstrument& other, const CollarBody& collar) {
  if (!other.frames.Has(frame_)) return;
  const Vector3d moved_R = other.velocity_R * static_cast<double>(frame_ - other.frames.first);
  ShaftCurve curve = other.curve;
  curve.T_RE.p += moved_R;
  for (Vector3d& p : curve.points) p += moved_R;
  AddInstrument(curve, collar, {});
}

void Scene::AddTube(Tube tube, const Material& material) {
  tubes_.push_back(std::move(tube));
  materials_.push_back(material);
}

void Scene::AddFace(Face face, const Material& material) {
  faces_.push_back(std::move(face));
  face_materials_.push_back(material);
}

void Scene::AddOccluder(const Occluder& o) {
  if (frame_ < o.first_frame || frame_ > o.last_frame) return;
  const Vector3d moved_R = o.velocity_R * static_cast<double>(frame_ - o.first_frame);
  const Vector3d a = T_CR_ * (o.a_R + moved_R), b = T_CR_ * (o.b_R + moved_R);
  Material material;
  material.albedo = o.albedo_bgr.cast<float>();
  SetGloss(o.specular, material);
  const Vector3d axis = (b - a).normalized();
  if (o.kind == Occluder::Kind::kCapsule) {
    const Vector3d reach = o.radius_m * axis;  // a and b are the centres of the round ends
    AddTube(Tube({a - reach, b + reach}, axis, o.radius_m, {true, true}), material);
    return;
  }
  Face disc;
  const Eigen::Matrix<double, 3, 2> basis = NormalBasis(axis);
  disc.origin = a;
  disc.normal = axis;
  disc.ex = basis.col(0);
  disc.ey = basis.col(1);
  disc.two_sided = true;
  disc.disc_radius_m = o.radius_m;
  const double bound = 1.16 * o.radius_m;
  disc.polygon = {{-bound, -bound}, {bound, -bound}, {bound, bound}, {-bound, bound}};
  disc.Prepare();
  AddFace(disc, material);
}

void Scene::MarkBox(Vector2d low, Vector2d high, int object, std::size_t tube, float s) {
  const auto tile = [](double px, int count) {
    return static_cast<int>(
        std::clamp(std::floor(px / kTile_px), -1.0, static_cast<double>(count)));
  };
  const int x0 = std::max(tile(low.x(), tiles_across_), 0),
            y0 = std::max(tile(low.y(), tiles_down_), 0);
  const int x1 = std::min(tile(high.x(), tiles_across_), tiles_across_ - 1);
  const int y1 = std::min(tile(high.y(), tiles_down_), tiles_down_ - 1);
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * tiles_across_ + x;
      tiles_[i] |= Bit(object);
      if (tube >= tubes_.size()) continue;
      spans_[tube][i].low = std::min(spans_[tube][i].low, s);
      spans_[tube][i].high = std::max(spans_[tube][i].high, s);
    }
  }
}

void Scene::MarkTube(std::size_t index) {
  const Tube& tube = tubes_[index];
  const CameraCalibration& c = camera_.Calibration();
  const double focal_px = std::max(c.fu_px, c.fv_px);
  const int steps = static_cast<int>(std::lround(tube.LengthM() / tube.StepM()));
  Vector2d last(-1e9, -1e9);
  for (int k = 0; k <= steps; ++k) {
    Vector3d x, t;
    tube.Curve(k * tube.StepM(), x, t);
    if (x.z() < std::max(kNear_m, 1.5 * tube.RadiusM())) continue;
    const auto px = camera_.Project(x);
    if (!px) continue;
    const double jump = (*px - last).norm();
    if (jump < 3.0 && k != steps) continue;
    // A sphere of the tube's radius, seen off the axis, is stretched by 1/cos^2 at most.
    const double stretch = x.squaredNorm() / (x.z() * x.z());
    const double radius_px = 1.1 * stretch * focal_px * tube.RadiusM() / (x.z() - tube.RadiusM());
    const double reach = radius_px + kMargin_px + std::min(jump, 100.0);
    MarkBox(px->array() - reach, px->array() + reach, static_cast<int>(index) + 1, index,
            static_cast<float>(k * tube.StepM()));
    last = *px;
  }
}

void Scene::MarkFace(std::size_t index) {
  const Face& face = faces_[index];
  const int object = static_cast<int>(tubes_.size() + index) + 1;
  Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  bool whole_image = false;
  constexpr int kPieces = 8;  // the lens bends the sides
  for (std::size_t i = 0; i < face.polygon.size(); ++i) {
    const Vector2d a = face.polygon[i], b = face.polygon[(i + 1) % face.polygon.size()];
    for (int k = 0; k < kPieces; ++k) {
      const Vector2d at = a + (b - a) * k / kPieces;
      const Vector3d x = face.origin + at.x() * face.ex + at.y() * face.ey;
      const auto px = x.z() > kNear_m ? camera_.Project(x) : std::nullopt;
      whole_image |= !px;
      if (!px) continue;
      low = low.cwiseMin(*px);
      high = high.cwiseMax(*px);
    }
  }
  if (whole_image) {
    low.setZero();
    high = {static_cast<double>(width_px_), static_cast<double>(height_px_)};
  }
  MarkBox(low.array() - kMargin_px, high.array() + kMargin_px, object, tubes_.size(), 0);
}

void Scene::SetGuesses(int tile, Guesses& guesses) const {
  for (std::size_t i = 0; i < tubes_.size(); ++i) {
    guesses[i] = 0.5 * (spans_[i][tile].low + spans_[i][tile].high);
  }
}

const Face* Scene::FaceOf(int object) const {
  const auto i = static_cast<std::size_t>(object);
  return i > tubes_.size() ? &faces_[i - tubes_.size() - 1] : nullptr;
}

int Scene::Trace(const Vector3d& ray, ObjectMask candidates, Guesses& guesses,
                 Meeting& nearest) const {
  int found = 0;
  nearest.depth = 1e30;
  for (ObjectMask rest = candidates & ~ObjectMask{1}; rest != 0; rest &= rest - 1) {
    const int object = __builtin_ctzll(rest);
    if (const Face* face = FaceOf(object)) {
      double depth = 0;
      Vector2d at;
      if (!face->Intersect(ray, depth, at) || depth >= nearest.depth) continue;
      nearest = {depth, face->NormalAt(at), face->White(at)};
    } else {
      Tube::Hit hit;
      if (!tubes_[object - 1].Intersect(ray, guesses[object - 1], hit)) continue;
      if (hit.depth >= nearest.depth) continue;
      nearest = {hit.depth, hit.normal, true};
    }
    found = object;
  }
  return found;
}

}  // namespace flextip::simulation::render
