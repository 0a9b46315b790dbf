#include "batch/records.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <thread>

#include "core/error.h"

namespace flextip::batch {

namespace fs = std::filesystem;

Records::Records(const fs::path& file) : file_(file) {
  lines_ = std::make_unique<LineFile>(file);
  long number = 0;
  for (const std::string& line : WholeLines(file)) {
    ++number;
    Outcome outcome;
    try {
      outcome = UnpackOutcome(line);
    } catch (const InputError& error) {
      throw InputError::At(file.string(), number, error.what());
    }
    const std::string name = outcome.name;
    if (!outcomes_.emplace(name, std::move(outcome)).second) {
      throw InputError::At(file.string(), number,
                           fmt::format("found a second record of '{}', expected one", name));
    }
  }
}

const Outcome* Records::Find(const std::string& name) const {
  const auto found = outcomes_.find(name);
  return found == outcomes_.end() ? nullptr : &found->second;
}

void Records::Forget(const std::set<std::string>& names) {
  if (names.empty()) return;
  for (const std::string& name : names) outcomes_.erase(name);
  std::string text;
  for (const auto& [name, outcome] : outcomes_) text += Pack(outcome) + "\n";
  WriteWhole(file_, text);
  lines_ = std::make_unique<LineFile>(file_);
}

void Records::Add(const std::vector<Ended>& ended) {
  std::vector<std::string> lines;
  lines.reserve(ended.size());
  for (const Ended& one : ended) lines.push_back(Pack(one.outcome));
  lines_->Append(lines);
  for (const Ended& one : ended) outcomes_.insert_or_assign(one.outcome.name, one.outcome);
}

void WriteWhole(const fs::path& file, const std::string& text) {
  const fs::path part = file.string() + ".part";
  std::ofstream out(part, std::ios::binary);
  out << text;
  out.close();
  std::error_code error;
  if (out) fs::rename(part, file, error);
  if (out && !error) return;
  fs::remove(part, error);
  throw WorkError(fmt::format("{}: cannot be written", file.string()));
}

FolderLock::FolderLock(const fs::path& file, double seconds) {
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) {
    throw WorkError(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
  }
  const auto begin = std::chrono::steady_clock::now();
  while (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const bool held = errno == EWOULDBLOCK || errno == EINTR;
    if (!held) return;  // a file system without locks
    if (std::chrono::steady_clock::now() - begin > std::chrono::duration<double>(seconds)) {
      close(descriptor_);
      throw InputError::At(file.parent_path().string(), 0, "another program is at work on it");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

FolderLock::~FolderLock() { close(descriptor_); }

}  // namespace flextip::batch
