#include "vision/tags/collar_search.h"

#include <algorithm>
#include <cmath>

#include "vision/grey.h"
#include "vision/tags/cells.h"

namespace flextip {
namespace {

constexpr double kMinCosine = 0.3;
constexpr int kMaxSteps = 20;  // either way
constexpr std::size_t kMaxPlaces = 150, kMinPlaces = 10;
constexpr double kMaxExtent_px = 4000;
constexpr float kMinVariance_grey2 = 25.0f;

// A part of the picture at 1/step of its resolution.
struct Reduced {
  int x0, y0, step, width, height;
  std::vector<float> grey;
};

// Takes means over squares, of at most 2 x 2 pixels each. Outside the picture its border goes on.
Reduced Reduce(const Image& image, Eigen::Vector2i low, Eigen::Vector2i high, int step) {
  Reduced r{
      low.x(), low.y(), step, (high.x() - low.x()) / step + 1, (high.y() - low.y()) / step + 1, {}};
  r.grey.resize(static_cast<std::size_t>(r.width) * r.height);
  const int second = step / 2;
  for (int j = 0; j < r.height; ++j) {
    const int y = std::clamp(r.y0 + j * step, 0, image.height_px - 1);
    const int y2 = std::min(y + second, image.height_px - 1);
    for (int i = 0; i < r.width; ++i) {
      const int x = std::clamp(r.x0 + i * step, 0, image.width_px - 1);
      const int x2 = std::min(x + second, image.width_px - 1);
      r.grey[static_cast<std::size_t>(j) * r.width + i] =
          0.25f * (GreyAt(image, x, y) + GreyAt(image, x2, y) + GreyAt(image, x, y2) +
                   GreyAt(image, x2, y2));
    }
  }
  return r;
}

// Returns a cell's whiteness mixed with that of its neighbours.
float Smoothed(const TagCells& tag, int column, int row) {
  float sum = 0, weight = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const TagCells::Colour colour = tag.At(column + dx, row + dy);
      if (colour == TagCells::kUnknown) continue;
      const float w = (dx == 0 ? 2.0f : 1.0f) * (dy == 0 ? 2.0f : 1.0f);
      sum += colour == TagCells::kWhite ? w : 0.0f;
      weight += w;
    }
  }
  return sum / weight;
}

using Place = CollarSearch::Place;

// A face's places in the reduced picture with values of mean 0 and square sum 1.
struct Template {
  std::vector<int> offsets;
  std::vector<float> values;
};

Template MakeTemplate(const std::vector<Place>& places, std::size_t every,
                      const Eigen::Vector2i& corner, const Reduced& reduced) {
  Template t;
  float mean = 0, square = 0;
  for (std::size_t i = 0; i < places.size(); i += every) {
    const Eigen::Vector2d at = (places[i].px - corner.cast<double>()) / reduced.step;
    t.offsets.push_back(static_cast<int>(at.y()) * reduced.width + static_cast<int>(at.x()));
    t.values.push_back(places[i].white);
    mean += places[i].white;
  }
  mean /= static_cast<float>(t.values.size());
  for (float& v : t.values) {
    v -= mean;
    square += v * v;
  }
  for (float& v : t.values) v /= std::sqrt(std::max(square, 1e-6f));
  return t;
}

float Correlation(const Template& t, const float* at) {
  float sum = 0, squares = 0, product = 0;
  for (std::size_t i = 0; i < t.values.size(); ++i) {
    const float grey = at[t.offsets[i]];
    sum += grey;
    squares += grey * grey;
    product += t.values[i] * grey;
  }
  const auto n = static_cast<float>(t.values.size());
  return product / std::sqrt(std::max(squares - sum * sum / n, kMinVariance_grey2 * n));
}

// Returns the mean correlation of the faces at all shifts, rows from the top.
std::vector<double> Correlate(const std::vector<Template>& templates, const Reduced& reduced,
                              int steps) {
  std::vector<double> scores;
  scores.reserve(static_cast<std::size_t>(2 * steps + 1) * (2 * steps + 1));
  for (int dy = -steps; dy <= steps; ++dy) {
    for (int dx = -steps; dx <= steps; ++dx) {
      double sum = 0;
      const float* at = reduced.grey.data() + dy * reduced.width + dx;
      for (const Template& t : templates) sum += Correlation(t, at);
      scores.push_back(sum / static_cast<double>(templates.size()));
    }
  }
  return scores;
}

// Returns the offset of the top of a parabola through values at -1, 0, 1.
double Peak(double before, double at, double after) {
  const double bend = before - 2 * at + after;
  return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
}

// In steps, between them by parabolas.
CollarSearch::Match BestShift(const std::vector<double>& scores, int steps) {
  const int across = 2 * steps + 1;
  const int best =
      static_cast<int>(std::max_element(scores.begin(), scores.end()) - scores.begin());
  const int dx = best % across - steps, dy = best / across - steps;
  CollarSearch::Match match{Eigen::Vector2d(dx, dy), scores[best]};
  if (std::max(std::abs(dx), std::abs(dy)) < steps) {
    match.shift_px.x() += Peak(scores[best - 1], scores[best], scores[best + 1]);
    match.shift_px.y() += Peak(scores[best - across], scores[best], scores[best + across]);
  }
  return match;
}

}  // namespace

CollarSearch::CollarSearch(const CameraModel& camera, const TagCollar& collar) : camera_(camera) {
  for (const CollarTag& tag : collar.tags) {
    const TagCells cells = ReadTagCells(collar.family, tag.id);
    const double cell_m = tag.size_m / cells.border_cells;
    Face face{tag, cells.border_cells, {}, {}};
    for (int row = 0; row < cells.cells; ++row) {
      for (int column = 0; column < cells.cells; ++column) {
        if (cells.At(column, row) == TagCells::kUnknown) continue;
        const double x = (column + 0.5 - 0.5 * cells.cells) * cell_m;
        const double y = (row + 0.5 - 0.5 * cells.cells) * cell_m;
        face.x_E.push_back(tag.T_EG * Eigen::Vector3d(x, y, 0));
        face.white.push_back(Smoothed(cells, column, row));
      }
    }
    faces_.push_back(std::move(face));
  }
}

// Returns the places of the faces that are seen from T_CE.
CollarSearch::Seen CollarSearch::Look(const Pose& T_CE) const {
  Seen seen;
  for (const Face& face : faces_) {
    const Pose T_CG = T_CE * face.tag.T_EG;
    Eigen::Matrix<double, 2, 3> J;
    const bool faces_camera = T_CG.R.col(2).dot(T_CG.p) > kMinCosine * T_CG.p.norm();
    if (!faces_camera || !camera_.Project(T_CG.p, &J)) continue;
    seen.cell_px = std::max(seen.cell_px, J(0, 0) * face.tag.size_m / face.border_cells);
    std::vector<Place> places;
    for (std::size_t i = 0; i < face.x_E.size(); ++i) {
      const auto px = camera_.Project(T_CE * face.x_E[i]);
      if (!px) continue;
      places.push_back({*px, face.white[i]});
      seen.low = seen.low.cwiseMin(*px);
      seen.high = seen.high.cwiseMax(*px);
    }
    if (places.size() < kMinPlaces) continue;
    seen.places += places.size();
    seen.faces.push_back(std::move(places));
  }
  return seen;
}

CollarSearch::Match CollarSearch::Find(const Image& image, const Pose& T_CE,
                                       double radius_px) const {
  const Seen seen = Look(T_CE);
  if (seen.faces.empty() || (seen.high - seen.low).maxCoeff() > kMaxExtent_px) return {};
  const int step = std::max(
      {1, static_cast<int>(seen.cell_px / 2), static_cast<int>(std::ceil(radius_px / kMaxSteps))});
  const int steps = static_cast<int>(std::ceil(radius_px / step));
  const int reach = (steps + 1) * step;
  const Eigen::Vector2i corner = seen.low.cast<int>() - Eigen::Vector2i::Constant(reach);
  const Reduced reduced =
      Reduce(image, corner, seen.high.cast<int>() + Eigen::Vector2i::Constant(reach + step), step);
  std::vector<Template> templates;
  const std::size_t every = std::max<std::size_t>(1, seen.places / kMaxPlaces);
  for (const auto& places : seen.faces) {
    templates.push_back(MakeTemplate(places, every, corner, reduced));
  }
  Match match = BestShift(Correlate(templates, reduced, steps), steps);
  match.shift_px *= step;
  return match;
}

Pose CollarSearch::Shifted(const Pose& T_CE, const Eigen::Vector2d& shift_px) const {
  Eigen::Vector3d sum_C = Eigen::Vector3d::Zero();
  int seen = 0;
  for (const Face& face : faces_) {
    const Pose T_CG = T_CE * face.tag.T_EG;
    if (T_CG.R.col(2).dot(T_CG.p) <= kMinCosine * T_CG.p.norm()) continue;
    sum_C += T_CG.p;
    ++seen;
  }
  Eigen::Matrix<double, 2, 3> J;
  if (seen == 0 || !camera_.Project(sum_C / seen, &J)) return T_CE;
  Pose shifted = T_CE;
  shifted.p.head<2>() += J.leftCols<2>().inverse() * shift_px;
  return shifted;
}

}  // namespace flextip
