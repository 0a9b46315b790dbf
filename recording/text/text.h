// Numbers and files as text: exact both ways, whatever the locale.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

namespace flextip {

/// The shortest decimal text that reads back as the same double, bit for bit.
std::string NumberText(double value);

/// The whole of `text` as a number; empty where it is anything else ("1.2x", "", "+1"). May be NaN
/// or infinite: see ParseFinite.
std::optional<double> ParseNumber(std::string_view text);

/// As ParseNumber, and empty for NaN and infinities too.
std::optional<double> ParseFinite(std::string_view text);

std::optional<std::int64_t> ParseInteger(std::string_view text);

/// Without spaces, tabs and carriage returns at both ends.
std::string_view Trim(std::string_view text);

/// `text` in quotes for a one-line message: long texts cut, control characters replaced.
std::string Quoted(std::string_view text);

/// Opens a file to be read, byte by byte. Throws InputError where it is missing, or no file but a
/// folder, a pipe or a device, which would wait or never end.
std::ifstream OpenFile(const std::filesystem::path& file);

/// The whole file. Throws InputError where it is missing or unreadable.
std::string ReadTextFile(const std::filesystem::path& file);

/// Writes the file and its folder: whole, or not at all where the program is killed or the disk
/// refuses, for which it throws WorkError. The text stands beside it as NAME.partial-PID first.
void WriteTextFile(const std::filesystem::path& file, const std::string& text);

}  // namespace flextip
