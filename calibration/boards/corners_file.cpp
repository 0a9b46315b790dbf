#include "calibration/boards/corners_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "recording/text/bounds.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

constexpr const char* kFormat = "#flextip-corners 1";
constexpr const char* kColumns = "#image,id [],x [px],y [px]";
constexpr std::size_t kMaxSide = 100000;

// Hands out lines and says where they were.
class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : name_(file.string()), in_(OpenFile(file)) {}
  bool Next() {
    if (!std::getline(in_, text_)) return false;
    ++line_;
    if (!text_.empty() && text_.back() == '\r') text_.pop_back();
    return true;
  }
  const std::string& text() const { return text_; }
  InputError Wrong(const std::string& what) const { return InputError::At(name_, line_, what); }
  // The rest of the next line, which begins with `key`.
  std::string After(const std::string& key) {
    if (!Next() || !text_.starts_with(key)) {
      throw Wrong(fmt::format("expected '{}', found '{}'", key, text_));
    }
    return text_.substr(key.size());
  }

 private:
  std::string name_, text_;
  std::ifstream in_;
  long line_ = 0;
};

template <class T>
T Number(const Lines& lines, const std::string& text, const char* what) {
  T value{};
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end || !std::isfinite(static_cast<double>(value))) {
    throw lines.Wrong(fmt::format("expected {}, found '{}'", what, text));
  }
  return value;
}

double Pixel(const Lines& lines, const std::string& text) {
  const auto value = Number<double>(lines, text, "a pixel");
  const std::string expected = ExpectedWithin(BoundsOf("_px"), value);
  if (expected.empty()) return value;
  throw lines.Wrong(fmt::format("found the pixel '{}', expected {}", text, expected));
}

// A line's last three cells, and all before them: an image's name may hold commas. A reason has
// none.
std::array<std::string, 4> Cells(const Lines& lines) {
  const std::string& text = lines.text();
  std::array<std::size_t, 3> commas{};
  std::size_t from = std::string::npos;
  for (int i = 2; i >= 0; --i) {
    const std::size_t comma = from == 0 ? std::string::npos : text.rfind(',', from);
    if (comma == std::string::npos) {
      throw lines.Wrong(fmt::format("expected four cells, found '{}'", text));
    }
    commas[static_cast<std::size_t>(i)] = comma;
    from = comma == 0 ? 0 : comma - 1;
  }
  return {text.substr(0, commas[0]), text.substr(commas[0] + 1, commas[1] - commas[0] - 1),
          text.substr(commas[1] + 1, commas[2] - commas[1] - 1), text.substr(commas[2] + 1)};
}

void AddCorner(const Lines& lines, const std::array<std::string, 4>& cells,
               const std::vector<Eigen::Vector3d>& board, BoardSighting& seen) {
  const int id = Number<int>(lines, cells[1], "a corner's id");
  if (id < 0 || id >= static_cast<int>(board.size())) {
    throw lines.Wrong(fmt::format("the board has corners 0 to {}, found {}", board.size() - 1, id));
  }
  if (!seen.ids.empty() && id <= seen.ids.back()) {
    throw lines.Wrong(fmt::format("expected a corner above {}, found {}", seen.ids.back(), id));
  }
  seen.ids.push_back(id);
  seen.x_B.push_back(board[static_cast<std::size_t>(id)]);
  seen.px.emplace_back(Pixel(lines, cells[2]), Pixel(lines, cells[3]));
}

void ReadResolution(Lines& lines, CornersFile& corners) {
  const std::string text = lines.After("#resolution ");
  const std::size_t space = text.find(' ');
  if (space == std::string::npos) throw lines.Wrong("expected '#resolution WIDTH HEIGHT'");
  corners.width_px = Number<int>(lines, text.substr(0, space), "a width in pixels");
  corners.height_px = Number<int>(lines, text.substr(space + 1), "a height in pixels");
  const int most = static_cast<int>(kMaxSide);
  if (corners.width_px <= 0 || corners.height_px <= 0 || corners.width_px > most ||
      corners.height_px > most) {
    throw lines.Wrong(fmt::format("expected 1 to {} pixels, found '{}'", most, text));
  }
  if (static_cast<double>(corners.width_px) * corners.height_px > kMostPixels) {
    throw lines.Wrong(fmt::format("found '{}', expected at most {:g} pixels", text, kMostPixels));
  }
}

void ReadRow(const Lines& lines, const std::vector<Eigen::Vector3d>& board, CornersFile& corners) {
  const auto cells = Cells(lines);
  if (cells[0].find('\r') != std::string::npos)
    throw lines.Wrong("found a carriage return in an image's name");
  const bool nothing = cells[1].empty() && cells[2].empty();
  const bool same = !corners.views.empty() && corners.views.back().name == cells[0];
  if (same && (nothing || !corners.views.back().sighting.Found())) {
    throw lines.Wrong(fmt::format("'{}' is listed twice", cells[0]));
  }
  const bool earlier = !same && std::any_of(corners.views.begin(), corners.views.end(),
                                            [&](const BoardView& v) { return v.name == cells[0]; });
  if (earlier) throw lines.Wrong(fmt::format("'{}' stands in two places", cells[0]));
  if (!same) corners.views.push_back({cells[0], {}});
  BoardSighting& seen = corners.views.back().sighting;
  if (nothing) {
    seen.reason = cells[3].empty() ? "no board found" : cells[3];
  } else {
    AddCorner(lines, cells, board, seen);
  }
}

}  // namespace

CornersFile ReadCorners(const std::filesystem::path& file) {
  Lines lines(file);
  CornersFile corners;
  if (!lines.After(kFormat).empty()) throw lines.Wrong(fmt::format("expected '{}'", kFormat));
  corners.board = lines.After("#board ");
  std::vector<Eigen::Vector3d> board;
  try {
    board = BoardCorners(ParseBoardSpec(corners.board));
  } catch (const InputError& e) {
    throw lines.Wrong(e.what());
  }
  ReadResolution(lines, corners);
  lines.After(kColumns);
  while (lines.Next()) {
    if (!lines.text().empty()) ReadRow(lines, board, corners);
  }
  if (corners.views.empty()) throw lines.Wrong("expected images, found none");
  return corners;
}

void WriteCorners(const std::filesystem::path& file, const CornersFile& corners) {
  std::string text = fmt::format("{}\n#board {}\n#resolution {} {}\n{}\n", kFormat, corners.board,
                                 corners.width_px, corners.height_px, kColumns);
  for (const BoardView& view : corners.views) {
    if (view.name.find_first_of("\r\n") != std::string::npos) {
      throw InputError("an image's name with a line break cannot be written to a corners file");
    }
    const BoardSighting& seen = view.sighting;
    for (std::size_t i = 0; i < seen.px.size(); ++i) {
      text += fmt::format("{},{},{},{}\n", view.name, seen.ids[i], seen.px[i].x(), seen.px[i].y());
    }
    if (seen.Found()) continue;
    std::string reason = seen.reason;
    for (char& c : reason) c = c == ',' || c == '\n' ? ';' : c;
    text += fmt::format("{},,,{}\n", view.name, reason);
  }
  WriteTextFile(file, text);
}

}  // namespace flextip
