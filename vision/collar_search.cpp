#include "vision/collar_search.h"

#include <algorithm>
#include <cmath>

#include "vision/tag_cells.h"

namespace flextip {
namespace {

constexpr double kMinCosine = 0.3;
constexpr int kMaxSteps = 20;  // either way
constexpr int kMaxPlaces = 150;

// A part of the picture at 1/step of its resolution.
struct Reduced {
  int x0, y0, step, width, height;
  std::vector<float> grey;
};

float GreyAt(const Image& image, int x, int y) {
  const std::uint8_t* at = image.Row(y) + static_cast<std::ptrdiff_t>(x) * image.channels;
  return image.channels == 1 ? at[0] : 0.114f * at[0] + 0.587f * at[1] + 0.299f * at[2];
}

// Means over squares, of at most 2 x 2 pixels each; outside the picture its border goes on.
Reduced Reduce(const Image& image, Eigen::Vector2i low, Eigen::Vector2i high, int step) {
  Reduced r{low.x(), low.y(), step, (high.x() - low.x()) / step + 1, (high.y() - low.y()) / step + 1,
            {}};
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

// A cell's whiteness mixed with its neighbours'.
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

// The offset of a parabola's top through values at -1, 0, 1.
double Peak(double before, double at, double after) {
  const double bend = before - 2 * at + after;
  return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
}

}  // namespace

CollarSearch::CollarSearch(const CameraModel& camera, const TagCollar& collar) : camera_(camera) {
  for (const CollarTag& tag : collar.tags) {
    const TagCells cells = ReadTagCells(collar.family, tag.id);
    const double cell_m = tag.size_m / cells.border_cells;
    Face face{tag, {}, {}};
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

CollarSearch::Match CollarSearch::Find(const Image& image, const Pose& T_CE,
                                       double radius_px) const {
  struct Place {
    Eigen::Vector2d px;
    float white;
  };
  std::vector<std::vector<Place>> seen;
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  double cell_px = 0;
  for (const Face& face : faces_) {
    const Pose T_CG = T_CE * face.tag.T_EG;
    Eigen::Matrix<double, 2, 3> J;
    if (T_CG.R.col(2).dot(T_CG.p) < kMinCosine * T_CG.p.norm() || !camera_.Project(T_CG.p, &J)) {
      continue;
    }
    cell_px = std::max(cell_px, J(0, 0) * face.tag.size_m / 9);
    std::vector<Place> places;
    for (std::size_t i = 0; i < face.x_E.size(); ++i) {
      const auto px = camera_.Project(T_CE * face.x_E[i]);
      if (!px) continue;
      places.push_back({*px, face.white[i]});
      low = low.cwiseMin(*px);
      high = high.cwiseMax(*px);
    }
    if (places.size() > 10) seen.push_back(std::move(places));
  }
  Match match;
  if (seen.empty() || (high - low).maxCoeff() > 4000) return match;
  const int step = std::max({1, static_cast<int>(cell_px / 2),
                             static_cast<int>(std::ceil(radius_px / kMaxSteps))});
  const int steps = static_cast<int>(std::ceil(radius_px / step));
  const int reach = steps * step + step;
  const Eigen::Vector2i corner = low.cast<int>() - Eigen::Vector2i(reach, reach);
  const Reduced r = Reduce(image, corner, high.cast<int>() + Eigen::Vector2i(reach + step, reach + step), step);

  std::vector<Template> templates;
  std::size_t total = 0;
  for (const auto& places : seen) total += places.size();
  const std::size_t every = std::max<std::size_t>(1, total / kMaxPlaces);
  for (const auto& places : seen) {
    Template t;
    float mean = 0, square = 0;
    for (std::size_t i = 0; i < places.size(); i += every) {
      const Eigen::Vector2d at = (places[i].px - corner.cast<double>()) / step;
      t.offsets.push_back(static_cast<int>(at.y()) * r.width + static_cast<int>(at.x()));
      t.values.push_back(places[i].white);
      mean += places[i].white;
    }
    mean /= static_cast<float>(t.values.size());
    for (float& v : t.values) {
      v -= mean;
      square += v * v;
    }
    for (float& v : t.values) v /= std::sqrt(std::max(square, 1e-6f));
    templates.push_back(std::move(t));
  }

  const int across = 2 * steps + 1;
  std::vector<double> scores(static_cast<std::size_t>(across) * across);
  const auto score = [&](int dx, int dy) -> double& {
    return scores[static_cast<std::size_t>(dy + steps) * across + dx + steps];
  };
  Eigen::Vector2i best(0, 0);
  for (int dy = -steps; dy <= steps; ++dy) {
    for (int dx = -steps; dx <= steps; ++dx) {
      double sum = 0;
      for (const Template& t : templates) {
        const float* at = r.grey.data() + dy * r.width + dx;
        float s = 0, s2 = 0, st = 0;
        for (std::size_t i = 0; i < t.values.size(); ++i) {
          const float grey = at[t.offsets[i]];
          s += grey;
          s2 += grey * grey;
          st += t.values[i] * grey;
        }
        const float variance = s2 - s * s / static_cast<float>(t.values.size());
        sum += st / std::sqrt(std::max(variance, 25.0f * static_cast<float>(t.values.size())));
      }
      score(dx, dy) = sum / static_cast<double>(templates.size());
      if (score(dx, dy) > score(best.x(), best.y())) best = {dx, dy};
    }
  }
  match.correlation = score(best.x(), best.y());
  Eigen::Vector2d fine = best.cast<double>();
  if (best.cwiseAbs().maxCoeff() < steps) {
    const double at = match.correlation;
    fine.x() += Peak(score(best.x() - 1, best.y()), at, score(best.x() + 1, best.y()));
    fine.y() += Peak(score(best.x(), best.y() - 1), at, score(best.x(), best.y() + 1));
  }
  match.shift_px = fine * step;
  return match;
}

Pose CollarSearch::Shifted(const Pose& T_CE, const Eigen::Vector2d& shift_px) const {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Face& face : faces_) centre += face.tag.T_EG.p / static_cast<double>(faces_.size());
  const Eigen::Vector3d x_C = T_CE * centre;
  Eigen::Matrix<double, 2, 3> J;
  if (!camera_.Project(x_C, &J)) return T_CE;
  Pose shifted = T_CE;
  shifted.p.head<2>() += J.leftCols<2>().inverse() * shift_px;
  return shifted;
}

}  // namespace flextip
