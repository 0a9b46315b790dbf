// What stands before the tissue in one frame, and where in the image it may be.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "simulation/render/collar.h"
#include "simulation/render/face.h"
#include "simulation/render/laparoscope.h"
#include "simulation/render/light.h"
#include "simulation/render/tube.h"
#include "vision/camera_model.h"

namespace flextip::simulation::render {

/// Objects are numbered from 1; 0 is the tissue. A set of objects is a mask of bits.
using ObjectMask = std::uint64_t;
constexpr int kMaxObjects = 63;
inline ObjectMask Bit(int object) { return ObjectMask{1} << object; }

/// Where a ray meets an object.
struct Meeting {
  double depth = 0;
  Eigen::Vector3d normal;
  bool white = true;  ///< of a tag's cell
};

/// The objects of one frame in the camera's frame, and for each tile of the image those that may
/// be seen in it (with some pixels to spare).
class Scene {
 public:
  static constexpr int kTile_px = 8;

  /// An empty scene. What is added must be finished before it is traced.
  Scene(const CameraModel& camera, int frame_number);
  void AddInstrument(const ShaftCurve& curve, const CollarBody& collar, const Hazards& hazards);
  void AddOther(const OtherInstrument& other, const CollarBody& collar);
  void AddOccluder(const Occluder& occluder);
  void Finish();

  /// Places along the tubes from which to search; one a tube.
  using Guesses = std::vector<double>;
  Guesses NewGuesses() const { return Guesses(tubes_.size(), 0.0); }
  void SetGuesses(int tile, Guesses& guesses) const;

  int TilesAcross() const { return tiles_across_; }
  ObjectMask InTile(int tile) const { return tiles_[tile]; }

  /// The nearest of `candidates` along the ray, 0 where it meets none.
  int Trace(const Eigen::Vector3d& ray, ObjectMask candidates, Guesses& guesses,
            Meeting& nearest) const;

  /// The flat face that an object is, or null.
  const Face* FaceOf(int object) const;
  const Material& MaterialOf(int object) const { return materials_[object]; }

 private:
  struct Span {
    float low = 1e9f, high = -1e9f;
  };
  void AddTube(Tube tube, const Material& material);
  void AddFace(Face face, const Material& material);
  void AddShaft(const ShaftCurve& curve);
  void AddStains(const Face& face, const Material& print, const std::vector<Stain>& stains);
  void MarkTube(std::size_t tube);
  void MarkFace(std::size_t face);
  void MarkBox(Eigen::Vector2d low, Eigen::Vector2d high, int object, std::size_t tube, float s);

  const CameraModel& camera_;
  Pose T_CR_;
  int frame_;
  int width_px_, height_px_, tiles_across_, tiles_down_;
  std::vector<Tube> tubes_;  // objects 1 to tubes_.size()
  std::vector<Face> faces_;  // objects from tubes_.size() + 1
  std::vector<Material> materials_ = {{}}, face_materials_;
  std::vector<ObjectMask> tiles_;
  std::vector<std::vector<Span>> spans_;  // of each tube in each tile, along the tube (m)
};

}  // namespace flextip::simulation::render
