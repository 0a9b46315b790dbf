// Text of a file or of a file's name, made fit for a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace flextip {

/// Returns `text` with a '?' for each control character, of 7 bits (but '\n') and of UTF-8: what
/// stands in an input must not move the cursor, recolour the screen or ring the bell.
inline std::string Printable(std::string_view text) {
  std::string printable;
  printable.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = i + 1 < text.size() ? static_cast<unsigned char>(text[i + 1]) : 0U;
    if (byte == 0xc2 && next >= 0x80 && next < 0xa0) {  // U+0080 to U+009f
      printable += '?';
      ++i;
    } else if ((byte < 0x20 && byte != '\n') || byte == 0x7f) {
      printable += '?';
    } else {
      printable += text[i];
    }
  }
  return printable;
}

/// As Printable, on one line.
inline std::string PrintableLine(std::string_view text) {
  std::string line = Printable(text);
  for (char& c : line) c = c == '\n' ? '?' : c;
  return line;
}

}  // namespace flextip
