#include "batch/line_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "core/error.h"

namespace flextip::batch {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Refuse(const fs::path& file, int error) {
  throw WorkError(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(error)));
}

std::string ReadAll(const fs::path& file) {
  if (!fs::exists(file)) return "";
  std::ifstream in(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in) throw InputError::At(file.string(), 0, "cannot be read");
  return text;
}

bool WriteAll(int descriptor, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(descriptor, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

std::vector<std::string> WholeLines(const fs::path& file) {
  const std::string text = ReadAll(file);
  std::vector<std::string> lines;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) return lines;
    lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
}

LineFile::LineFile(const fs::path& file) : file_(file) {
  descriptor_ = open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) Refuse(file, errno);
  const std::string text = ReadAll(file);
  const std::size_t whole = text.rfind('\n') + 1;  // npos + 1 is 0
  size_ = static_cast<long long>(whole);
  if (ftruncate(descriptor_, size_) != 0) {
    const int error = errno;
    close(descriptor_);
    Refuse(file, error);
  }
}

LineFile::~LineFile() { close(descriptor_); }

void LineFile::Append(const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  std::string bytes;
  for (const std::string& line : lines) bytes += line + "\n";
  if (!WriteAll(descriptor_, bytes) || fdatasync(descriptor_) != 0) {
    const int error = errno;
    if (ftruncate(descriptor_, size_) != 0) Refuse(file_, errno);
    Refuse(file_, error);
  }
  size_ += static_cast<long long>(bytes.size());
}

}  // namespace flextip::batch
