#include "apps/batch/work.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <regex>
#include <string_view>

#include "apps/batch/folder.h"
#include "apps/common/run_facts.h"
#include "batch/ranks.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

double BytesAt(const fs::path& path) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) return static_cast<double>(fs::file_size(path, error));
  double bytes = 0.0;
  for (const auto& entry : fs::recursive_directory_iterator(path, error)) {
    if (entry.is_regular_file(error)) bytes += static_cast<double>(entry.file_size(error));
  }
  return bytes;
}

void SendMessagesTo(const fs::path& log) {
  const int file = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0666);
  const int none = open("/dev/null", O_RDONLY | O_CLOEXEC);
  dup2(none, STDIN_FILENO);
  if (file < 0) return;
  dup2(file, STDOUT_FILENO);
  dup2(file, STDERR_FILENO);
  close(file);
}

/// The program's last line; where it left none, anybody's, of an item that did not end well.
std::string LastLine(const fs::path& log, bool ok) {
  constexpr std::string_view kOurs = "flextip: ";
  std::ifstream in(log);
  std::string ours, any;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with(kOurs)) ours = line.substr(kOurs.size());
    if (line.find_first_not_of(" \t\r") != std::string::npos) any = line;
  }
  return ours.empty() && !ok ? any : ours;
}

/// Whether a message tells of a file that the disk did not take. Elsewhere than below OUT a file
/// may have another reason, which is the item's own.
bool SaysTheDiskIsFull(const std::string& message, bool below_out) {
  constexpr std::array<std::string_view, 3> kSays{"cannot be written", "could not be put there",
                                                  "cannot make a folder there"};
  const auto says = [&](std::string_view text) { return message.find(text) != std::string::npos; };
  return says("No space left on device") ||
         (below_out && std::any_of(kSays.begin(), kSays.end(), says));
}

/// The same wherever OUT is and whatever the process's number was.
std::string WithoutPlace(std::string text, const fs::path& out) {
  for (const std::string& place :
       {fs::absolute(out).lexically_normal().string() + "/", out.string() + "/"}) {
    for (auto at = text.find(place); at != std::string::npos; at = text.find(place, at)) {
      text.erase(at, place.size());
    }
  }
  static const std::regex kPartial(R"(\.partial-\d+)");
  return std::regex_replace(text, kPartial, "");
}

}  // namespace

batch::Item ItemOf(const ListedItem& listed, const fs::path& out) {
  batch::Item item{listed.name, {out.string(), listed.input}, BytesAt(listed.input)};
  item.arguments.insert(item.arguments.end(), listed.options.begin(), listed.options.end());
  return item;
}

int DoItem(const BatchWork& work, const batch::Item& item, std::string& payload) {
  batch::LeaveRanks();
  const fs::path out = item.arguments.at(0);
  SendMessagesTo(ItemLog(out, item.name));
  const tbb::global_control share(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(work.threads));
  cv::setNumThreads(work.threads);
  std::vector<std::string> words = work.command;
  words.insert(words.end(), item.arguments.begin() + 1, item.arguments.end());
  words.insert(words.end(), work.options.begin(), work.options.end());
  words.emplace_back("-o");
  const fs::path said = fs::path("items") / item.name;  // seen from OUT, wherever that is
  std::vector<std::string> typed = words;
  typed.push_back(said.string());
  words.push_back(ItemFolder(out, item.name).string());
  words.insert(words.begin(), "--quiet");
  if (!work.defaults.empty()) {
    words.insert(words.begin(), {"--defaults", work.defaults.string()});
  }
  Json times = Json::object();
  KeepTimesApart(ShellLine("flextip", typed), said, times);
  const int code = work.program(words);
  payload = Json{{"times", times}}.dump();
  return code;
}

void FinishItem(const fs::path& out, batch::Outcome& outcome) {
  const bool ended =
      outcome.status == batch::Status::kOk || outcome.status == batch::Status::kFailed;
  const fs::path log = ItemLog(out, outcome.name);
  Json payload = Json::parse(outcome.payload, nullptr, false);
  std::string line = LastLine(log, outcome.status == batch::Status::kOk);
  if (!payload.is_object()) {
    if (line.empty()) line = outcome.payload;  // of an exception outside the program
    payload = Json::object();
  }
  const std::string message = WithoutPlace(line, out);
  payload["message"] = message;
  if (outcome.status == batch::Status::kFailed && SaysTheDiskIsFull(line, message != line)) {
    payload["disk_refused"] = true;
  }
  outcome.payload = payload.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::error_code error;
  if (fs::exists(log, error) && fs::file_size(log, error) == 0) fs::remove(log, error);
  if (!ended) RemovePartialItems(out, outcome.name);
}

bool DiskRefused(const batch::Outcome& outcome) {
  const Json payload = Json::parse(outcome.payload, nullptr, false);
  return payload.is_object() && payload.value("disk_refused", false);
}

}  // namespace flextip
