#include "recording/text/text.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <system_error>

#include "core/check.h"
#include "core/error.h"

namespace flextip {
namespace {

template <class T>
std::optional<T> ParseWhole(std::string_view text) {
  T value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return {};
  return value;
}

}  // namespace

std::string NumberText(double value) {
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  FLEXTIP_CHECK(error == std::errc(), "a number fits the buffer");
  return std::string(buffer.data(), end);
}

std::optional<double> ParseNumber(std::string_view text) { return ParseWhole<double>(text); }

std::optional<double> ParseFinite(std::string_view text) {
  const auto value = ParseNumber(text);
  if (!value || !std::isfinite(*value)) return {};
  return value;
}

std::optional<std::int64_t> ParseInteger(std::string_view text) {
  return ParseWhole<std::int64_t>(text);
}

std::string_view Trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string Quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  return "\"" + PrintableLine(text.substr(0, kLongest)) + (text.size() > kLongest ? "...\"" : "\"");
}

std::ifstream OpenFile(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    throw InputError::At(file.string(), 0, "no such file");
  }
  // Before it is opened: opening a pipe that nobody writes to never returns.
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError::At(file.string(), 0,
                         std::filesystem::is_directory(status)
                             ? "cannot be read as a file: it is a folder"
                             : "cannot be read as a file: it is a pipe or a device");
  }
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError::At(file.string(), 0, "cannot be read as a file");
  return in;
}

std::string ReadTextFile(const std::filesystem::path& file) {
  std::ifstream in = OpenFile(file);
  std::ostringstream text;
  if (in.peek() != std::ifstream::traits_type::eof()) text << in.rdbuf();
  if (in.bad() || text.fail()) throw InputError::At(file.string(), 0, "cannot be read to its end");
  return std::move(text).str();
}

namespace {

// Throws WorkError with the system's reason.
void WriteTo(const std::filesystem::path& file, const std::filesystem::path& name,
             const std::string& text) {
  errno = 0;
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(text.data(), static_cast<std::streamsize>(text.size()));
  out.close();
  if (out) return;
  const std::string why = errno != 0 ? std::generic_category().message(errno) : "";
  throw WorkError(
      fmt::format("{}: cannot be written{}{}", name.string(), why.empty() ? "" : ": ", why));
}

}  // namespace

void WriteTextFile(const std::filesystem::path& file, const std::string& text) {
  namespace fs = std::filesystem;
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  // A link stays one, and a device is written to.
  const fs::path real = fs::is_symlink(file, error) ? fs::weakly_canonical(file, error) : file;
  const auto status = fs::status(real, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) return WriteTo(real, file, text);
  if (fs::exists(status) && access(real.c_str(), W_OK) != 0) {
    throw WorkError(fmt::format("{}: cannot be written: it is write-protected", file.string()));
  }
  fs::path partial = real;
  partial += fmt::format(".partial-{}", getpid());
  try {
    WriteTo(partial, file, text);
  } catch (const WorkError&) {
    fs::remove(partial, error);
    throw;
  }
  fs::rename(partial, real, error);
  if (!error) return;
  std::error_code ignored;
  fs::remove(partial, ignored);
  throw WorkError(fmt::format("{}: cannot be written: {}", file.string(), error.message()));
}

}  // namespace flextip
