#include "plausibility/relations/relation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace flextip::plausibility {

bool Relation::IsAbout(const std::string& subject) const {
  return std::find(about.begin(), about.end(), subject) != about.end();
}

double TotalMisfit(const std::vector<Relation>& relations) {
  constexpr double kMost = 8.0;
  double sum = 0.0;
  for (const Relation& r : relations) {
    const double m = std::min(r.misfit, kMost);
    sum += m * m;
  }
  return sum;
}

std::size_t CountViolated(const std::vector<Relation>& relations) {
  return static_cast<std::size_t>(std::count_if(relations.begin(), relations.end(),
                                                [](const Relation& r) { return r.Violated(); }));
}

const Relation* WorstOf(const std::vector<Relation>& relations, const std::string& subject) {
  const Relation* worst = nullptr;
  for (const Relation& r : relations) {
    if (!r.Violated() || (!subject.empty() && !r.IsAbout(subject))) continue;
    if (worst == nullptr || r.misfit > worst->misfit) worst = &r;
  }
  return worst;
}

void RelationList::Add(const std::string& name, std::vector<std::string> about, double misfit,
                       std::string text) {
  constexpr double kInfinite = 1e6;
  for (const std::string& subject : about)
    if (scene_.unknown.contains(subject)) return;
  relations_.push_back(
      {name, std::move(about), std::isfinite(misfit) ? misfit : kInfinite, std::move(text)});
}

std::vector<double> ValuesOf(const Scene& scene,
                             const std::function<std::optional<double>(const Instant&)>& of) {
  std::vector<double> values;
  for (const Instant& now : scene.instants) {
    if (const auto value = of(now)) values.push_back(*value);
  }
  return values;
}

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double norms = a.norm() * b.norm();
  if (!(norms > 0.0)) return 0.0;
  return std::acos(std::clamp(a.dot(b) / norms, -1.0, 1.0));
}

std::string MetresText(double m) {
  if (std::abs(m) >= 1.0) return fmt::format("{:.3g} m", m);
  return fmt::format("{:.3g} mm", 1e3 * m);
}

std::string DegreesText(double rad) {
  return fmt::format("{:.0f} degrees", rad * 180.0 / std::numbers::pi);
}

}  // namespace flextip::plausibility
