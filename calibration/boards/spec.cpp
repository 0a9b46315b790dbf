#include <charconv>
#include <cmath>

#include "calibration/boards/board.h"
#include "core/error.h"

namespace flextip {
namespace {

constexpr const char* kForms =
    "chessboard:COLSxROWS:SQUARE_M, charuco:COLSxROWS:SQUARE_M:MARKER_M:DICT[:old|:present] or "
    "aprilgrid:COLSxROWS:TAG_M:GAP_M";

std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

InputError Wrong(const std::string& spec, const std::string& what) {
  return InputError(fmt::format("board '{}': {}", spec, what));
}

template <class T>
bool ParseWhole(const std::string& text, T& value) {
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  return result.ec == std::errc() && result.ptr == end;
}

double Length(const std::string& spec, const std::string& text, const char* name) {
  double value = 0.0;
  if (!ParseWhole(text, value) || !std::isfinite(value) || value <= 0 || value > 10) {
    throw Wrong(
        spec, fmt::format("expected {} in metres, above 0 and at most 10, found '{}'", name, text));
  }
  return value;
}

void ParseSize(const std::string& spec, const std::string& text, int smallest, BoardSpec& board) {
  const auto sides = Split(text, 'x');
  const bool good = sides.size() == 2 && ParseWhole(sides[0], board.columns) &&
                    ParseWhole(sides[1], board.rows) && board.columns >= smallest &&
                    board.rows >= smallest && board.columns <= 200 && board.rows <= 200;
  if (!good) {
    throw Wrong(spec,
                fmt::format("expected COLSxROWS, each {} to 200, found '{}'", smallest, text));
  }
}

}  // namespace

BoardSpec ParseBoardSpec(const std::string& spec) {
  const auto parts = Split(spec, ':');
  BoardSpec board;
  const auto expect_parts = [&](std::size_t count) {
    if (parts.size() != count) throw Wrong(spec, fmt::format("expected {}", kForms));
  };
  if (parts[0] == "chessboard") {
    expect_parts(3);
    ParseSize(spec, parts[1], 3, board);
    board.square_m = Length(spec, parts[2], "the square's side");
  } else if (parts[0] == "charuco") {
    if (parts.size() == 6 && (parts[5] == "old" || parts[5] == "present")) {
      board.layout = parts[5] == "old" ? CharucoLayout::kOld : CharucoLayout::kPresent;
    } else {
      expect_parts(5);
    }
    board.kind = BoardKind::kCharuco;
    ParseSize(spec, parts[1], 2, board);
    board.square_m = Length(spec, parts[2], "the square's side");
    board.marker_m = Length(spec, parts[3], "the marker's side");
    board.dictionary = parts[4];
    if (board.dictionary.empty()) throw Wrong(spec, "the dictionary's name is empty");
    if (board.marker_m >= board.square_m) throw Wrong(spec, "the marker must fit in its square");
  } else if (parts[0] == "aprilgrid") {
    expect_parts(4);
    board.kind = BoardKind::kAprilGrid;
    ParseSize(spec, parts[1], 1, board);
    board.square_m = Length(spec, parts[2], "the tag's side");
    board.marker_m = Length(spec, parts[3], "the gap");
  } else {
    throw Wrong(spec, fmt::format("expected {}", kForms));
  }
  return board;
}

}  // namespace flextip
