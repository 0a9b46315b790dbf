#include "vision/outline/contour_coarse.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace flextip {
namespace {

constexpr float kMostEvidence = 2.0f;  // of one line: it shall not outvote the others
constexpr int kSamePlace_px = 6, kSameTurn_px = 12;
constexpr int kShadow_px = 6;  // a second edge so near outside may be the shadow's
constexpr double kGoodEnough = 0.9;
constexpr std::size_t kLeastLines = 6, kLeastEndLines = 3;

struct Voter {
  std::size_t point = 0;
  std::vector<float> votes;  // at each whole pixel from -search to search
};

// The evidence of the lines of the chosen part, widened by a pixel either way (the tube's width and
// bend may be off), each limited.
template <class Wanted>
std::vector<Voter> Voters(const ScanEdgeFinder& finder, const Image& grey,
                          const std::vector<ContourPoint>& points, int search_px, Wanted wanted) {
  std::vector<Voter> voters;
  std::vector<float> light, evidence;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ContourPoint& p = points[i];
    if (!wanted(p)) continue;
    const int half = search_px + ScanEdgeFinder::kMargin;
    if (!finder.Sample(grey, p.px, p.outward, half, 1, light)) continue;
    finder.Evidence(light, p.rim, p.radius_px, evidence);
    Voter voter{i, evidence};
    for (std::size_t k = 0; k < evidence.size(); ++k) {
      float& vote = voter.votes[k];
      if (k > 0) vote = std::max(vote, evidence[k - 1]);
      if (k + 1 < evidence.size()) vote = std::max(vote, evidence[k + 1]);
      vote = std::clamp(vote, 0.0f, kMostEvidence);
    }
    voters.push_back(std::move(voter));
  }
  return voters;
}

// Share of votes from which another place counts as nearly as good: textures give every place some
// votes.
double NearlyAsGood(const std::vector<double>& votes, double best) {
  const double mean =
      std::accumulate(votes.begin(), votes.end(), 0.0) / static_cast<double>(votes.size());
  return mean + 0.9 * (best - mean);
}

}  // namespace

std::optional<CoarseShift> ShiftAside(const ScanEdgeFinder& finder, const Image& grey,
                                      const std::vector<ContourPoint>& points, int search_px) {
  const auto voters = Voters(finder, grey, points, search_px,
                             [](const ContourPoint& p) { return p.part != ContourPart::kEnd; });
  if (voters.size() < kLeastLines) return {};
  const auto shift = [&](const ContourPoint& p, int a, int b) {
    return (p.part == ContourPart::kLeft ? 1 : -1) * (a + b * p.place);
  };
  const int n = 2 * search_px + 1;
  std::vector<double> votes(static_cast<std::size_t>(n) * n, 0.0);
  std::size_t best = 0;
  for (std::size_t cell = 0; cell < votes.size(); ++cell) {
    const int a = static_cast<int>(cell) / n - search_px,
              b = static_cast<int>(cell) % n - search_px;
    // Takes the nearer of equal places.
    votes[cell] = -0.5 * (a * a + b * b) / (search_px * search_px);
    for (const Voter& voter : voters) {
      const auto d = static_cast<int>(std::lround(shift(points[voter.point], a, b)));
      if (std::abs(d) <= search_px) votes[cell] += voter.votes[d + search_px];
    }
    if (votes[cell] > votes[best]) best = cell;
  }
  const int a = static_cast<int>(best) / n - search_px, b = static_cast<int>(best) % n - search_px;
  const double nearly = NearlyAsGood(votes, votes[best]);
  CoarseShift result;
  for (std::size_t cell = 0; cell < votes.size(); ++cell) {
    const int off_a = std::abs(static_cast<int>(cell) / n - search_px - a);
    const int off_b = std::abs(static_cast<int>(cell) % n - search_px - b);
    const bool apart = off_a > kSamePlace_px || off_b > kSameTurn_px;
    if (apart && votes[cell] > nearly) result.ambiguous = true;
  }
  for (const ContourPoint& p : points) {
    result.outward_px.push_back(p.part == ContourPart::kEnd ? 0.0 : shift(p, a, b));
  }
  return result;
}

std::optional<CoarseShift> ShiftAlong(const ScanEdgeFinder& finder, const Image& grey,
                                      const std::vector<ContourPoint>& points, int search_px) {
  const auto voters = Voters(finder, grey, points, search_px,
                             [](const ContourPoint& p) { return p.part == ContourPart::kEnd; });
  if (voters.size() < kLeastEndLines) return {};
  Eigen::Vector2d ahead = Eigen::Vector2d::Zero();
  for (const ContourPoint& p : points) {
    if (p.part == ContourPart::kEnd) ahead += p.outward;
  }
  ahead.normalize();
  CoarseShift result;
  double most = -1;
  int best = 0;
  std::vector<double> votes;
  for (int e = -search_px; e <= search_px; ++e) {
    double sum = -0.5 * e * e / (search_px * search_px);
    for (const Voter& voter : voters) {
      const auto d = static_cast<int>(std::lround(e * points[voter.point].outward.dot(ahead)));
      sum += voter.votes[d + search_px];
    }
    votes.push_back(sum);
    if (sum > most) most = sum, best = e;
  }
  const double nearly = NearlyAsGood(votes, most);
  for (int e = std::max(-search_px, best - kShadow_px); e < best; ++e) {
    const auto at = [&](int place) { return votes[place + search_px]; };
    const bool peak = e > -search_px && at(e) >= at(e - 1) && at(e) > at(e + 1);
    if (peak && at(e) > kGoodEnough * most) {
      best = e;
      break;
    }
  }
  for (int e = -search_px; e <= search_px; ++e) {
    if (std::abs(e - best) > kSamePlace_px && votes[e + search_px] > nearly)
      result.ambiguous = true;
  }
  for (const ContourPoint& p : points) {
    result.outward_px.push_back(p.part == ContourPart::kEnd ? best * p.outward.dot(ahead) : 0.0);
  }
  return result;
}

}  // namespace flextip
