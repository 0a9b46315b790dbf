#include "apps/batch/transfer.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <vector>

#include "apps/batch/folder.h"
#include "core/error.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void Refuse(const fs::path& file) {
  throw WorkError(fmt::format("{}: cannot be written", file.string()));
}

/// "SIZE\tPATH\n" and the file's bytes.
void AddFile(const fs::path& file, const std::string& path, std::string& bytes) {
  std::ifstream in(file, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in.eof() && !in) throw WorkError(fmt::format("{}: cannot be read", file.string()));
  bytes += fmt::format("{}\t{}\n", content.size(), path) + content;
}

void WriteFile(const fs::path& file, std::string_view content) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  std::ofstream out(file, std::ios::binary);
  out.write(content.data(), static_cast<std::streamsize>(content.size()));
  out.close();
  if (!out) Refuse(file);
}

}  // namespace

std::string PackItem(const fs::path& out, const std::string& name) {
  std::string bytes;
  const fs::path folder = ItemFolder(out, name), log = ItemLog(out, name);
  std::error_code error;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    AddFile(file, "items/" + file.lexically_relative(folder).generic_string(), bytes);
  }
  if (fs::exists(log, error)) AddFile(log, "log", bytes);
  fs::remove_all(folder, error);
  fs::remove(log, error);
  return bytes;
}

void UnpackItem(const fs::path& out, const std::string& name, const std::string& bytes) {
  const fs::path folder = ItemFolder(out, name), part = folder.string() + ".partial-0";
  std::error_code error;
  fs::remove_all(part, error);
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t tab = bytes.find('\t', at), end = bytes.find('\n', tab);
    const std::size_t size = std::stoull(bytes.substr(at, tab - at));
    const std::string path = bytes.substr(tab + 1, end - tab - 1);
    const std::string_view content = std::string_view(bytes).substr(end + 1, size);
    if (path == "log") {
      WriteFile(ItemLog(out, name), content);
    } else {
      WriteFile(part / path.substr(path.find('/') + 1), content);
    }
    at = end + 1 + size;
  }
  if (!fs::exists(part, error)) return;
  fs::rename(part, folder, error);
  if (error) Refuse(folder);
}

}  // namespace flextip
