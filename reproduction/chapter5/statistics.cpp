#include "reproduction/chapter5/statistics.h"

#include <geos_c.h>

#include <algorithm>
#include <array>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <memory>

#include "core/check.h"
#include "core/error.h"

namespace flextip::reproduction {
namespace {

/// One thread's handle to the polygon library.
class Geos {
 public:
  Geos() : context_(GEOS_init_r(), &GEOS_finish_r) {}

  GEOSGeometry* Polygon(const std::array<Eigen::Vector2d, 4>& corners) const {
    GEOSContextHandle_t geos = context_.get();
    GEOSCoordSequence* ring = GEOSCoordSeq_create_r(geos, 5, 2);
    for (unsigned i = 0; i < 5; ++i) {
      GEOSCoordSeq_setXY_r(geos, ring, i, corners[i % 4].x(), corners[i % 4].y());
    }
    return GEOSGeom_createPolygon_r(geos, GEOSGeom_createLinearRing_r(geos, ring), nullptr, 0);
  }

  /// Takes the polygons over.
  double UnionArea(std::vector<GEOSGeometry*> polygons) const {
    GEOSContextHandle_t geos = context_.get();
    const auto destroy = [geos](GEOSGeometry* geometry) { GEOSGeom_destroy_r(geos, geometry); };
    using Geometry = std::unique_ptr<GEOSGeometry, decltype(destroy)>;
    const Geometry all(GEOSGeom_createCollection_r(geos, GEOS_MULTIPOLYGON, polygons.data(),
                                                   static_cast<unsigned>(polygons.size())),
                       destroy);
    const Geometry together(all ? GEOSUnaryUnion_r(geos, all.get()) : nullptr, destroy);
    double area = 0.0;
    if (!together || GEOSArea_r(geos, together.get(), &area) != 1) {
      throw WorkError("the union of the projected path's polygons failed");
    }
    return area;
  }

 private:
  std::unique_ptr<GEOSContextHandle_HS, decltype(&GEOS_finish_r)> context_;
};

}  // namespace

double SweptArea(const std::vector<Eigen::Vector3d>& tips, double wall_x_m) {
  double area = 0.0;
  for (std::size_t i = 1; i < tips.size(); ++i) {
    const double before = tips[i - 1].x() - wall_x_m, now = tips[i].x() - wall_x_m;
    if (before <= 0.0 || now <= 0.0) continue;
    area += 0.5 * (before + now) * (tips[i] - tips[i - 1]).tail<2>().norm();
  }
  return area;
}

double OutlineArea(const std::vector<Eigen::Vector3d>& tips, double wall_x_m, int along) {
  FLEXTIP_CHECK(along == 1 || along == 2, "an axis across the wall's normal");
  constexpr double kUnit = 1e-3;  // the library's tolerances suit numbers of the order of one
  constexpr double kNarrowest = 1e-7;
  const Geos geos;
  std::vector<GEOSGeometry*> polygons;
  for (std::size_t i = 1; i < tips.size(); ++i) {
    Eigen::Vector2d a((tips[i - 1][3 - along]) / kUnit, (tips[i - 1].x() - wall_x_m) / kUnit);
    Eigen::Vector2d b((tips[i][3 - along]) / kUnit, (tips[i].x() - wall_x_m) / kUnit);
    if (a.y() <= 0.0 || b.y() <= 0.0 || std::abs(a.x() - b.x()) < kNarrowest) continue;
    if (a.x() > b.x()) std::swap(a, b);
    polygons.push_back(
        geos.Polygon({Eigen::Vector2d(a.x(), 0.0), Eigen::Vector2d(b.x(), 0.0), b, a}));
  }
  if (polygons.empty()) return 0.0;
  return kUnit * kUnit * geos.UnionArea(std::move(polygons));
}

Incursion MeasureIncursion(const std::vector<Eigen::Vector3d>& tips, double wall_x_m,
                           bool outline) {
  Incursion incursion;
  if (tips.empty()) return incursion;
  int inside = 0;
  for (const auto& p : tips) {
    const double depth = p.x() - wall_x_m;
    inside += depth > 0.0;
    incursion.max_depth_m = std::max(incursion.max_depth_m, depth);
  }
  incursion.time_part = static_cast<double>(inside) / static_cast<double>(tips.size());
  incursion.swept_area_m2 = SweptArea(tips, wall_x_m);
  if (!outline) return incursion;
  incursion.outline_area_m2 = OutlineArea(tips, wall_x_m, 1) + OutlineArea(tips, wall_x_m, 2);
  return incursion;
}

double StudentP(const MeanSd& a, const MeanSd& b) {
  FLEXTIP_CHECK(a.count > 1 && b.count > 1, "two numbers in each sample");
  const double freedom = a.count + b.count - 2;
  const double pooled = ((a.count - 1) * a.sd * a.sd + (b.count - 1) * b.sd * b.sd) / freedom;
  const double error = std::sqrt(pooled * (1.0 / a.count + 1.0 / b.count));
  const double difference = std::abs(a.mean - b.mean);
  if (error == 0.0) return difference == 0.0 ? 1.0 : 0.0;
  const boost::math::students_t distribution(freedom);
  return 2.0 * boost::math::cdf(boost::math::complement(distribution, difference / error));
}

double LargestP(const std::vector<MeanSd>& samples) {
  double largest = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t j = i + 1; j < samples.size(); ++j) {
      largest = std::max(largest, StudentP(samples[i], samples[j]));
    }
  }
  return largest;
}

}  // namespace flextip::reproduction
