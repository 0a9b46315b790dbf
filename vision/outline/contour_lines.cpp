#include "vision/outline/contour_lines.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "core/median.h"

namespace flextip {
namespace {

// Unknowns: pose 6, bend 2, inset, left offset and slope, right offset and slope, and of the end an
// offset, a slope and a curvature.
constexpr int kPose = 6, kOther = 10, kAll = kPose + kOther;
using VectorAll = Eigen::Matrix<double, kAll, 1>;
using MatrixAll = Eigen::Matrix<double, kAll, kAll>;

constexpr double kLeastEvidence = 0.7;  // an edge must halve the squared residuals
constexpr float kEnough = 2.0f;         // more evidence makes no better edge
constexpr double kInward = 0.02;        // evidence that a pixel further in is worth
constexpr int kSideAverage = 2, kEndAverage = 1;
constexpr double kTukey = 4.685, kCounts = 0.2;
constexpr int kReweightings = 6;
constexpr double kScaleFreedom = 5.0;  // of the belief that the stated variances are right

// Chooses the peak of the evidence near the line's middle. Of two nearly equal peaks, takes the
// inner one: beside a tube lies its shadow, and the shadow's own far edge.
std::optional<ScanEdge> FindEdge(const ScanEdgeFinder& finder, const std::vector<float>& light,
                                 const std::vector<float>& evidence, const ContourPoint& p) {
  const int search = static_cast<int>(evidence.size()) / 2;
  int best = 0;
  double best_score = -1e9;
  for (int d = -search; d <= search; ++d) {
    const float here = evidence[d + search];
    if (d > -search && evidence[d + search - 1] > here) continue;
    if (d < search && evidence[d + search + 1] > here) continue;
    const double off = static_cast<double>(d) / std::max(1, search);
    const double score = std::min(here, kEnough) - 2 * off * off - kInward * d;
    if (score > best_score) best = d, best_score = score;
  }
  if (best_score < -1e8 || evidence[best + search] < kLeastEvidence) return {};
  auto edge = finder.Refine(light, p.rim, p.radius_px, best);
  if (!edge || edge->evidence < kLeastEvidence) return {};
  return edge;
}

VectorAll Row(const ContourPoint& p) {
  VectorAll row = VectorAll::Zero();
  row.head<6>() = p.J_pose.transpose();
  row.segment<2>(kPose) = p.J_bend.transpose();
  row[kPose + 2] = -1;
  const int own = kPose + 3;
  if (p.part == ContourPart::kEnd) {
    row.segment<3>(own + 4) << -1, -p.place, -p.place * p.place;
  } else {
    const int side = own + (p.part == ContourPart::kLeft ? 0 : 2);
    row[side] = -1;
    row[side + 1] = -p.place;
  }
  return row;
}

struct Equations {
  MatrixAll A = MatrixAll::Zero();
  VectorAll b = VectorAll::Zero();
  double squares = 0;
};

Equations PriorEquations(const ContourPrior& prior) {
  Equations e;
  e.A.block<2, 2>(kPose, kPose) = prior.bend_information;
  e.b.segment<2>(kPose) = prior.bend_information * prior.bend_off;
  e.squares = prior.bend_off.dot(prior.bend_information * prior.bend_off);
  const ContourErrors& s = prior.errors;
  const double sd[kOther - 2] = {s.inset_px, s.side_px, s.slope_px, s.side_px,
                                 s.slope_px, s.end_px,  s.end_px,   s.end_px};
  for (int i = 0; i < kOther - 2; ++i) e.A(kPose + 2 + i, kPose + 2 + i) = 1 / (sd[i] * sd[i]);
  return e;
}

Equations Sum(const std::vector<ContourLine>& lines, const std::vector<VectorAll>& rows,
              const ContourPrior& prior) {
  Equations e = PriorEquations(prior);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!(lines[i].weight > 0)) continue;
    const double w = lines[i].weight / lines[i].variance_px2, r = -lines[i].edge->offset_px;
    e.A.selfadjointView<Eigen::Lower>().rankUpdate(rows[i], w);
    e.b += w * r * rows[i];
    e.squares += w * r * r;
  }
  e.A.triangularView<Eigen::StrictlyUpper>() = e.A.transpose();
  return e;
}

// Returns the step of all unknowns that fits the lines best. Unknowns that the lines do not
// determine stay.
VectorAll OwnStep(Equations e) {
  for (int i = 0; i < kPose; ++i) e.A(i, i) += 1e-9 + 1e-7 * e.A(i, i);
  return -Ldlt(e.A).Solve(e.b);
}

void SetVariances(std::vector<ContourLine>& lines, const ContourErrors& errors) {
  std::vector<double> noise;
  for (const ContourLine& line : lines) {
    if (line.edge) noise.push_back(line.edge->noise);
  }
  const double typical = Median(noise);
  for (ContourLine& line : lines) {
    line.weight = line.edge ? 1.0 : 0.0;
    if (!line.edge) continue;
    line.variance_px2 = errors.line_px * errors.line_px +
                        line.edge->per_noise_px2 * 0.5 * (typical + line.edge->noise);
  }
}

std::vector<double> NormalisedResiduals(const std::vector<ContourLine>& lines,
                                        const std::vector<VectorAll>& rows, const VectorAll& step) {
  std::vector<double> r(lines.size(), 0.0);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!lines[i].edge) continue;
    r[i] = (rows[i].dot(step) - lines[i].edge->offset_px) / std::sqrt(lines[i].variance_px2);
  }
  return r;
}

double RobustScale(const std::vector<ContourLine>& lines, const std::vector<double>& r) {
  std::vector<double> size;
  for (std::size_t i = 0; i < r.size(); ++i) {
    if (lines[i].edge) size.push_back(std::abs(r[i]));
  }
  return std::max(1.0, 1.4826 * Median(size));
}

// Cauchy's weights first, which a wrong start survives, then Tukey's.
void Reweigh(std::vector<ContourLine>& lines, const std::vector<VectorAll>& rows,
             const ContourPrior& prior, ContourTerm& term) {
  std::vector<double> r;
  for (int round = 0; round < kReweightings; ++round) {
    r = NormalisedResiduals(lines, rows, OwnStep(Sum(lines, rows, prior)));
    const double scale = RobustScale(lines, r);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (!lines[i].edge) continue;
      const double z = r[i] / scale, t = std::max(0.0, 1 - z * z / (kTukey * kTukey));
      lines[i].weight = round < kReweightings / 2 ? 1 / (1 + z * z / 4) : t * t;
    }
  }
  double squares = 0, squares_px2 = 0, weights = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    squares += lines[i].weight * r[i] * r[i];
    squares_px2 += lines[i].weight * r[i] * r[i] * lines[i].variance_px2;
    weights += lines[i].weight;
  }
  if (!(weights > 0)) return;
  term.rms_px = std::sqrt(squares_px2 / weights);
  constexpr double kFitted = 7.0;  // what the lines determine: five of the pose and the bend
  term.scale =
      std::max(1.0, (kScaleFreedom + squares) / (kScaleFreedom + std::max(0.0, weights - kFitted)));
  for (ContourLine& line : lines) line.variance_px2 *= term.scale;
}

void Eliminate(const Equations& e, ContourTerm& term) {
  const auto H_po = e.A.topRightCorner<kPose, kOther>();
  const Ldlt H_oo(e.A.bottomRightCorner<kOther, kOther>());
  const Eigen::Matrix<double, kOther, kPose> by_pose = -H_oo.Solve(H_po.transpose());
  const Eigen::Matrix<double, kOther, 1> step = -H_oo.Solve(e.b.tail<kOther>());
  term.JtJ = e.A.topLeftCorner<kPose, kPose>() + H_po * by_pose;
  term.Jtr = e.b.head<kPose>() + H_po * step;
  term.chi2 = e.squares + e.b.tail<kOther>().dot(step);
  term.bend_step = step.head<2>();
  term.bend_by_pose = by_pose.topRows<2>();
  term.inset_px = step[2];
}

}  // namespace

std::vector<ContourLine> MeasureLines(const ScanEdgeFinder& finder, const Image& grey,
                                      const std::vector<ContourPoint>& points, int search_px) {
  std::vector<ContourLine> lines;
  lines.reserve(points.size());
  std::vector<float> light, evidence;
  for (const ContourPoint& p : points) {
    const int aside = p.part == ContourPart::kEnd ? kEndAverage : kSideAverage;
    const int half = search_px + ScanEdgeFinder::kMargin;
    if (!finder.Sample(grey, p.px, p.outward, half, aside, light)) continue;
    finder.Evidence(light, p.rim, p.radius_px, evidence);
    ContourLine line;
    line.point = p;
    line.edge = FindEdge(finder, light, evidence, p);
    lines.push_back(line);
  }
  return lines;
}

ContourTerm MakeTerm(std::vector<ContourLine>& lines, const ContourPrior& prior) {
  ContourTerm term;
  term.lines = static_cast<int>(lines.size());
  std::vector<VectorAll> rows;
  rows.reserve(lines.size());
  for (const ContourLine& line : lines) rows.push_back(Row(line.point));
  SetVariances(lines, prior.errors);
  Reweigh(lines, rows, prior, term);
  for (const ContourLine& line : lines) {
    const auto part = static_cast<std::size_t>(line.point.part);
    ++term.lines_of[part];
    if (line.weight < kCounts) continue;
    ++term.points;
    ++term.points_of[part];
  }
  Eliminate(Sum(lines, rows, prior), term);
  return term;
}

}  // namespace flextip
