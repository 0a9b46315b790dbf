#include "bench/calibration/corners.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "calibration/boards/chessboard.h"
#include "core/error.h"

namespace flextip::bench {
namespace {

namespace fs = std::filesystem;

Image ReadGrey(const fs::path& file) {
  const cv::Mat_<std::uint8_t> picture = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (picture.empty()) throw InputError::At(file.string(), 0, "is no picture");
  Image image(picture.cols, picture.rows, 1);
  std::copy(picture.begin(), picture.end(), image.data.begin());
  return image;
}

BoardSighting Sighting(const BoardSpec& board, const std::vector<Eigen::Vector2d>& px) {
  BoardSighting seen;
  if (px.empty()) return seen;
  seen.px = px;
  seen.x_B = ChessboardPoints(board.columns, board.rows, board.square_m);
  for (std::size_t i = 0; i < px.size(); ++i) seen.ids.push_back(static_cast<int>(i));
  return seen;
}

}  // namespace

CornerSet DetectCorners(const std::vector<fs::path>& images, const BoardSpec& board) {
  CornerSet set;
  set.board = board;
  for (const fs::path& file : images) {
    const Image image = ReadGrey(file);
    if (set.names.empty()) {
      set.width_px = image.width_px;
      set.height_px = image.height_px;
    }
    if (image.width_px != set.width_px || image.height_px != set.height_px) {
      throw InputError::At(file.string(), 0, "is of another size than the first");
    }
    set.names.push_back(file.filename().string());
    set.seen.push_back(DetectBoard(image, board));
  }
  set.focal_px = 0.8 * set.width_px;
  return set;
}

void WriteCorners(const fs::path& folder, const CornerSet& set) {
  fs::create_directories(folder);
  const nlohmann::json head = {{"width_px", set.width_px},
                               {"height_px", set.height_px},
                               {"focal_px", set.focal_px},
                               {"working_distance_m", set.working_distance_m},
                               {"board",
                                {{"columns", set.board.columns},
                                 {"rows", set.board.rows},
                                 {"square_m", set.board.square_m}}}};
  std::ofstream(folder / "set.json") << head.dump(1) << '\n';
  std::ofstream corners(folder / "corners.vnl");
  corners << "# filename x y level\n";
  for (std::size_t i = 0; i < set.names.size(); ++i) {
    if (!set.seen[i].Found()) corners << set.names[i] << " - - -\n";
    for (const Eigen::Vector2d& c : set.seen[i].px) {
      corners << fmt::format("{} {} {} 0\n", set.names[i], c.x(), c.y());
    }
  }
}

CornerSet ReadCorners(const fs::path& folder) {
  std::ifstream head_file(folder / "set.json"), corners(folder / "corners.vnl");
  if (!head_file || !corners) {
    throw InputError::At(folder.string(), 0, "has no set.json and corners.vnl");
  }
  const auto head = nlohmann::json::parse(head_file);
  CornerSet set;
  set.width_px = head.at("width_px");
  set.height_px = head.at("height_px");
  set.focal_px = head.at("focal_px");
  set.working_distance_m = head.at("working_distance_m");
  set.board.columns = head.at("board").at("columns");
  set.board.rows = head.at("board").at("rows");
  set.board.square_m = head.at("board").at("square_m");
  std::vector<std::vector<Eigen::Vector2d>> px;
  std::string line, name, x, y;
  std::getline(corners, line);
  while (std::getline(corners, line)) {
    std::istringstream(line) >> name >> x >> y;
    if (set.names.empty() || set.names.back() != name) {
      set.names.push_back(name);
      px.emplace_back();
    }
    if (x != "-") px.back().emplace_back(std::stod(x), std::stod(y));
  }
  for (const auto& p : px) set.seen.push_back(Sighting(set.board, p));
  return set;
}

CornerSet HalfOf(const CornerSet& set, int half) {
  CornerSet part = set;
  part.names.clear();
  part.seen.clear();
  int found = 0;
  for (std::size_t i = 0; i < set.names.size(); ++i) {
    if (!set.seen[i].Found() || found++ % 2 != half) continue;
    part.names.push_back(set.names[i]);
    part.seen.push_back(set.seen[i]);
  }
  return part;
}

}  // namespace flextip::bench
