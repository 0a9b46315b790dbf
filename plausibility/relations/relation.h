// A relation between streams: a misfit, 1 at the limit of what a bent shaft, a registration or a
// latency can make of it.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "plausibility/scene.h"

namespace flextip::plausibility {

struct Relation {
  std::string name;                ///< "em0.place"
  std::vector<std::string> about;  ///< what could be wrong: "em0", "em0.q", "port", "length", ...
  double misfit = 0.0;
  std::string text;  ///< "em0 is 241 m from where ..., 0.19 m would be plausible"

  bool Violated() const { return misfit > 1.0; }
  bool IsAbout(const std::string& subject) const;
};

/// Returns one number for all: the sum of the squares, each limited.
double TotalMisfit(const std::vector<Relation>& relations);
std::size_t CountViolated(const std::vector<Relation>& relations);
/// Returns the violated relation with the largest misfit that is about `subject` (any where empty),
/// or null.
const Relation* WorstOf(const std::vector<Relation>& relations, const std::string& subject = "");

/// Gathers the relations of one scene. Those about a subject in Scene::unknown are left out.
class RelationList {
 public:
  explicit RelationList(const Scene& scene) : scene_(scene) {}

  const Scene& scene() const { return scene_; }
  void Add(const std::string& name, std::vector<std::string> about, double misfit,
           std::string text);
  std::vector<Relation> Take() { return std::move(relations_); }

 private:
  const Scene& scene_;
  std::vector<Relation> relations_;
};

inline constexpr std::size_t kFewestInstants = 6;  ///< that a relation needs

/// Returns the values at the instants that have one.
std::vector<double> ValuesOf(const Scene& scene,
                             const std::function<std::optional<double>(const Instant&)>& of);
/// Returns the angle between two vectors (rad); 0 where one is zero.
double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b);
/// "4.2 m", "18 mm".
std::string MetresText(double m);
/// "35 degrees".
std::string DegreesText(double rad);

}  // namespace flextip::plausibility
