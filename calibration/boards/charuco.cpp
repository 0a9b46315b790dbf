#include "calibration/boards/charuco.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>

#include "calibration/boards/saddles.h"
#include "core/error.h"
#include "core/median.h"

namespace flextip {
namespace {

using DictionaryName = cv::aruco::PREDEFINED_DICTIONARY_NAME;

const std::map<std::string, DictionaryName>& Dictionaries() {
  static const std::map<std::string, DictionaryName> names = {
      {"DICT_4X4_50", cv::aruco::DICT_4X4_50},
      {"DICT_4X4_100", cv::aruco::DICT_4X4_100},
      {"DICT_4X4_250", cv::aruco::DICT_4X4_250},
      {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
      {"DICT_5X5_50", cv::aruco::DICT_5X5_50},
      {"DICT_5X5_100", cv::aruco::DICT_5X5_100},
      {"DICT_5X5_250", cv::aruco::DICT_5X5_250},
      {"DICT_5X5_1000", cv::aruco::DICT_5X5_1000},
      {"DICT_6X6_50", cv::aruco::DICT_6X6_50},
      {"DICT_6X6_100", cv::aruco::DICT_6X6_100},
      {"DICT_6X6_250", cv::aruco::DICT_6X6_250},
      {"DICT_6X6_1000", cv::aruco::DICT_6X6_1000},
      {"DICT_7X7_50", cv::aruco::DICT_7X7_50},
      {"DICT_7X7_100", cv::aruco::DICT_7X7_100},
      {"DICT_7X7_250", cv::aruco::DICT_7X7_250},
      {"DICT_7X7_1000", cv::aruco::DICT_7X7_1000},
      {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
      {"DICT_APRILTAG_16h5", cv::aruco::DICT_APRILTAG_16h5},
      {"DICT_APRILTAG_25h9", cv::aruco::DICT_APRILTAG_25h9},
      {"DICT_APRILTAG_36h10", cv::aruco::DICT_APRILTAG_36h10},
      {"DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11}};
  return names;
}

// So many markers more must fit one layout than the other to tell which it is.
constexpr int kTelling = 3;

using Board = cv::Ptr<cv::aruco::CharucoBoard>;

cv::Ptr<cv::aruco::Dictionary> DictionaryOf(const BoardSpec& board) {
  const auto name = Dictionaries().find(board.dictionary);
  if (name == Dictionaries().end()) {
    throw InputError(
        fmt::format("charuco: no dictionary '{}' (DICT_4X4_250 and its like)", board.dictionary));
  }
  const auto dictionary = cv::aruco::getPredefinedDictionary(name->second);
  const int markers = board.columns * board.rows / 2;
  if (markers > dictionary->bytesList.rows) {
    throw InputError(fmt::format("charuco: a board of {}x{} squares has {} markers, {} has {}",
                                 board.columns, board.rows, markers, board.dictionary,
                                 dictionary->bytesList.rows));
  }
  return dictionary;
}

Board MakeBoard(const BoardSpec& board, int extra_rows) {
  return cv::aruco::CharucoBoard::create(board.columns, board.rows + extra_rows,
                                         static_cast<float>(board.square_m),
                                         static_cast<float>(board.marker_m), DictionaryOf(board));
}

// The board as OpenCV before 4.6 printed it where the rows are even: a marker in the upper left
// square. It is the present layout with one more row above, whose markers do not exist.
Board MakeOldBoard(const BoardSpec& board) {
  const Board old = MakeBoard(board, 1);
  const int above = board.columns / 2;
  for (int i = 0; i < static_cast<int>(old->ids.size()); ++i) {
    old->ids[static_cast<std::size_t>(i)] = i < above ? -1 - i : i - above;
  }
  return old;
}

struct Markers {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
};

// How many of the markers lie where the board has them, under one homography.
int Consistent(const Markers& seen, const Board& board) {
  constexpr double kOff = 0.5;  // of a marker's side
  std::vector<cv::Point2f> on_board, in_picture;
  double side_px = 0.0;
  for (std::size_t i = 0; i < seen.ids.size(); ++i) {
    const auto at = std::find(board->ids.begin(), board->ids.end(), seen.ids[i]);
    if (at == board->ids.end()) continue;
    const auto& points = board->objPoints[static_cast<std::size_t>(at - board->ids.begin())];
    for (std::size_t k = 0; k < 4; ++k) {
      on_board.emplace_back(points[k].x, points[k].y);
      in_picture.push_back(seen.corners[i][k]);
    }
    side_px += cv::norm(seen.corners[i][1] - seen.corners[i][0]);
  }
  if (on_board.size() < 4) return 0;
  cv::Mat inliers;
  const double off_px = kOff * 4.0 * side_px / static_cast<double>(on_board.size());
  cv::findHomography(on_board, in_picture, inliers, cv::RANSAC, off_px);
  return inliers.empty() ? 0 : cv::countNonZero(inliers) / 4;
}

CharucoLayout LayoutOf(const Markers& seen, const BoardSpec& board) {
  if (board.rows % 2 != 0) return CharucoLayout::kPresent;  // both are the same
  if (board.layout != CharucoLayout::kUnknown) return board.layout;
  const int present = Consistent(seen, MakeBoard(board, 0)),
            old = Consistent(seen, MakeOldBoard(board));
  if (std::abs(present - old) < kTelling) return CharucoLayout::kUnknown;
  return present > old ? CharucoLayout::kPresent : CharucoLayout::kOld;
}

// The distance to the nearest other corner that is a neighbour on the board; 0 where none is seen.
double Spacing(const std::vector<int>& ids, const std::vector<Eigen::Vector2d>& px, std::size_t i,
               int columns) {
  double least = HUGE_VAL;
  for (std::size_t j = 0; j < ids.size(); ++j) {
    const int apart = std::abs(ids[i] - ids[j]);
    const bool beside = apart == 1 && ids[i] / columns == ids[j] / columns;
    if (beside || apart == columns) least = std::min(least, (px[i] - px[j]).norm());
  }
  return std::isfinite(least) ? least : 0.0;
}

// The corners found, with this program's ids: the old layout has one row of corners too many.
void AddCorners(const BoardSpec& board, const std::vector<cv::Point2f>& corners,
                const std::vector<int>& ids, bool old, BoardSighting& seen) {
  const auto points = CharucoPoints(board);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const int id = ids[i] - (old ? board.columns - 1 : 0);
    if (id < 0) continue;
    seen.ids.push_back(id);
    seen.x_B.push_back(points[static_cast<std::size_t>(id)]);
    seen.px.emplace_back(corners[i].x, corners[i].y);
  }
}

// The corners refined with a window of `reach` distances to the next corner; one that is nearer to
// the picture's end is left out.
BoardSighting Refined(const Image& grey, const BoardSighting& coarse, double reach, int columns) {
  BoardSighting seen;
  for (std::size_t i = 0; i < coarse.px.size(); ++i) {
    const double reach_px = reach * Spacing(coarse.ids, coarse.px, i, columns);
    const Eigen::Array2d from_end =
        Eigen::Array2d(grey.width_px - 1, grey.height_px - 1) - coarse.px[i].array();
    if (coarse.px[i].minCoeff() < reach_px + 1 || from_end.minCoeff() < reach_px + 1) continue;
    std::vector<Eigen::Vector2d> one = {coarse.px[i]};
    RefineSaddles(grey, reach_px, one);
    seen.ids.push_back(coarse.ids[i]);
    seen.x_B.push_back(coarse.x_B[i]);
    seen.px.push_back(one[0]);
  }
  seen.layout = coarse.layout;
  return seen;
}

// How unevenly three corners in a row follow one another, in the median: noise, and a pull that
// changes its sign from corner to corner as the markers do.
double Unevenness(const BoardSighting& seen, int columns) {
  std::map<int, Eigen::Vector2d> at;
  for (std::size_t i = 0; i < seen.ids.size(); ++i) at[seen.ids[i]] = seen.px[i];
  std::vector<double> bends;
  for (const auto& [id, px] : at) {
    for (const int step : {1, columns}) {
      if (step == 1 && (id % columns == 0 || id % columns == columns - 1)) continue;
      if (!at.contains(id - step) || !at.contains(id + step)) continue;
      bends.push_back((at[id - step] - 2 * px + at[id + step]).norm());
    }
  }
  return bends.empty() ? HUGE_VAL : Median(bends);
}

// In a sharp picture a window that ends before the markers begin is best. In a blurred one a larger
// one is: the two markers beside a corner look alike from it, a gap and a border's cell deep.
void RefineEach(const Image& grey, const BoardSpec& board, BoardSighting& seen) {
  const double gap = 0.5 * (board.square_m - board.marker_m);
  const double cell = board.marker_m / (DictionaryOf(board)->markerSize + 2);
  const int columns = board.columns - 1;
  const auto with = [&](double reach_m) {
    return Refined(grey, seen, std::min(kSaddleReach, reach_m / board.square_m), columns);
  };
  BoardSighting narrow = with(0.9 * gap), wide = with(gap + 0.8 * cell);
  seen =
      Unevenness(narrow, columns) < Unevenness(wide, columns) ? std::move(narrow) : std::move(wide);
}

}  // namespace

void CheckCharuco(const BoardSpec& board) { DictionaryOf(board); }

CharucoMarker ReadCharucoMarker(const BoardSpec& board, int id) {
  const auto dictionary = DictionaryOf(board);
  CharucoMarker marker{.cells = dictionary->markerSize + 2};
  cv::Mat_<std::uint8_t> drawn;  // a pixel a cell
  cv::aruco::drawMarker(dictionary, id, marker.cells, drawn, 1);
  for (const std::uint8_t value : drawn) marker.black.push_back(value < 128);
  return marker;
}

std::vector<Eigen::Vector3d> CharucoPoints(const BoardSpec& board) {
  std::vector<Eigen::Vector3d> points;
  for (int row = 1; row < board.rows; ++row) {
    for (int column = 1; column < board.columns; ++column) {
      points.emplace_back(column * board.square_m, row * board.square_m, 0.0);
    }
  }
  return points;
}

BoardSighting FindCharuco(const Image& grey, const BoardSpec& board) {
  const cv::Mat picture(grey.height_px, grey.width_px, CV_8UC1,
                        const_cast<std::uint8_t*>(grey.data.data()));  // only read
  Markers markers;
  cv::aruco::detectMarkers(picture, DictionaryOf(board), markers.corners, markers.ids);
  BoardSighting seen;
  const CharucoLayout layout = LayoutOf(markers, board);
  if (markers.ids.empty() || layout == CharucoLayout::kUnknown) {
    seen.reason = fmt::format("{} markers of {} read", markers.ids.size(), board.dictionary);
    if (!markers.ids.empty()) {
      seen.reason +=
          " which do not tell whether the upper left square has one: append :old to the "
          "board where it has, :present where it is black";
    }
    return seen;
  }
  seen.layout = layout;
  const bool old = layout == CharucoLayout::kOld;
  std::vector<cv::Point2f> corners;
  std::vector<int> ids;
  cv::aruco::interpolateCornersCharuco(markers.corners, markers.ids, picture,
                                       old ? MakeOldBoard(board) : MakeBoard(board, 0), corners,
                                       ids);
  AddCorners(board, corners, ids, old, seen);
  RefineEach(grey, board, seen);
  if (!seen.Found()) {
    seen.reason = fmt::format("{} markers of {} read, but no two beside one another",
                              markers.ids.size(), board.dictionary);
  }
  return seen;
}

}  // namespace flextip
