#include "apps/common/output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <system_error>

#include "apps/common/run_facts.h"
#include "core/check.h"
#include "core/error.h"
#include "core/version.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

// Absolute, links followed, without a slash at the end.
fs::path Normal(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::weakly_canonical(fs::absolute(path), error);
  const fs::path normal = (error ? fs::absolute(path) : absolute).lexically_normal();
  return normal.filename().empty() ? normal.parent_path() : normal;
}

bool IsInside(const fs::path& path, const fs::path& folder) {
  const fs::path p = Normal(path);
  return std::mismatch(folder.begin(), folder.end(), p.begin(), p.end()).first == folder.end();
}

bool HoldsSomething(const fs::path& folder) {
  std::error_code error;
  if (!fs::exists(folder, error)) return false;
  return !fs::is_empty(folder, error) || error;
}

// Puts each in the other's place at once, so that NAME is never missing. Returns false where the
// file system cannot.
bool Exchange(const fs::path& a, const fs::path& b) {
  return syscall(SYS_renameat2, AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0;
}

bool HasNoNumber(const nlohmann::ordered_json& json) {
  if (json.is_number_float()) return !std::isfinite(json.get<double>());
  if (!json.is_structured()) return false;
  return std::any_of(json.begin(), json.end(), HasNoNumber);
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& name, const std::string& command,
                           const OutputOptions& options)
    : command_(command), paths_(options.paths), force_(options.force) {
  // An input that a command may have and does not is an empty name.
  std::copy_if(options.inputs.begin(), options.inputs.end(), std::back_inserter(inputs_),
               [](const fs::path& input) { return !input.empty(); });
  paths_.result = ResultAsSaid(name.filename().empty() ? name.parent_path() : name);
  if (name.empty()) throw InputError("the output folder has no name");
  name_ = Normal(name);
  std::error_code error;
  if (fs::exists(name_, error) && !fs::is_directory(name_, error)) {
    throw InputError::At(name.string(), 0, "is a file, expected a folder for the output");
  }
  if (HoldsSomething(name_)) {
    if (!force_) {
      throw InputError::At(name.string(), 0, "exists and is not empty; --force replaces it");
    }
    RefuseToReplace(inputs_);
  }
  folder_ = name_;
  in_place_ = options.in_place;
  keep_ = in_place_;
  if (!in_place_) folder_ += fmt::format(".partial-{}", getpid());
  resumed_ = options.resume && TakeOver();
  interruption_.emplace(folder_);
  if (resumed_) {
    interruption_->Keep();
    return;
  }
  fs::remove_all(folder_, error);
  fs::create_directories(folder_, error);
  if (error) {
    throw InputError::At(name.string(), 0,
                         fmt::format("cannot make a folder there: {}", error.message()));
  }
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!committed_ && !keep_) fs::remove_all(folder_, ignored);
}

// The newest NAME.partial-PID whose program runs no more becomes folder_.
bool OutputFolder::TakeOver() const {
  const std::string start = name_.filename().string() + ".partial-";
  fs::path newest;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(name_.parent_path(), error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(start) || !entry.is_directory(error)) continue;
    const pid_t pid = std::atoi(name.c_str() + start.size());
    if (pid <= 0 || (pid != getpid() && kill(pid, 0) == 0)) continue;
    if (newest.empty() || entry.last_write_time(error) > fs::last_write_time(newest, error)) {
      newest = entry.path();
    }
  }
  if (newest.empty()) return false;
  if (newest != folder_) fs::rename(newest, folder_, error);
  return !error;
}

void OutputFolder::RefuseToReplace(const std::vector<fs::path>& inputs) const {
  const auto refuse = [&](const std::string& why) {
    throw InputError::At(name_.string(), 0, fmt::format("not replaced: {}", why));
  };
  for (const auto& input : inputs) {
    if (IsInside(input, name_)) refuse(fmt::format("it holds the input {}", input.string()));
  }
  if (IsInside(fs::current_path(), name_)) refuse("it holds the working folder");
  const char* home = std::getenv("HOME");
  if (home && *home && IsInside(home, name_)) refuse("it holds the home folder");
  if (fs::exists(name_ / "recording.yaml") && !fs::exists(name_ / "summary.json")) {
    refuse("it holds a recording that was not made by this program");
  }
}

void OutputFolder::WriteSummary(nlohmann::ordered_json results) const {
  if (results.is_null()) results = nlohmann::ordered_json::object();
  FLEXTIP_CHECK(results.is_object(), "results by name");
  if (HasNoNumber(results)) throw WorkError("summary.json would hold a NaN or infinite value");
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start_;
  results["command"] = command_;
  results["version"] = kVersion;
  AddRunFacts(seconds.count(), results);
  results["inputs"] = nlohmann::ordered_json::array();
  for (const fs::path& input : inputs_) results["inputs"].push_back(input.string());
  auto& warnings = results["warnings"];
  if (!warnings.is_array()) warnings = nlohmann::ordered_json::array();
  for (const auto& warning : warnings_) warnings.push_back(warning);
  if (!findings_.empty()) results["findings"] = findings_;
  results["output"] = paths_.result.string();
  if (results.contains("verdict") && results["verdict"].contains("command")) {
    auto& next = results["verdict"]["command"];
    next = paths_.Fill(next.get<std::string>());
  }
  // File names may hold bytes that are not UTF-8: they are replaced, not a reason to fail.
  WriteTextFile(folder_ / "summary.json",
                results.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

void OutputFolder::Commit() {
  FLEXTIP_CHECK(!committed_, "committed once");
  if (in_place_) {
    committed_ = true;
    interruption_.reset();
    return;
  }
  const auto move = [&](const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::rename(from, to, error);
    if (!error) return;
    throw WorkError(
        fmt::format("{}: the output could not be put there: {}", name_.string(), error.message()));
  };
  if (!HoldsSomething(name_) || !force_) {
    move(folder_, name_);  // replaces an empty folder, and fails where something is in it by now
  } else if (Exchange(folder_, name_)) {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);  // the earlier run's by now
  } else {
    fs::path old = name_;
    old += fmt::format(".old-{}", getpid());
    move(name_, old);
    try {
      move(folder_, name_);
    } catch (const WorkError&) {
      std::error_code ignored;
      fs::rename(old, name_, ignored);
      throw;
    }
    std::error_code ignored;
    fs::remove_all(old, ignored);
  }
  folder_ = name_;
  committed_ = true;
  interruption_.reset();
}

}  // namespace flextip
