#include "apps/batch/folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/common/run_facts.h"
#include "core/error.h"
#include "core/version.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kWaitForTheKilled_s = 5.0;

/// Whether the folder was left before it said what it is.
bool IsHardlyBegun(const fs::path& out) {
  return std::all_of(fs::directory_iterator(out), fs::directory_iterator(), [](const auto& entry) {
    const std::string name = entry.path().filename().string();
    return name == "lock" || name == "batch.json.part";
  });
}

Json ItemJson(const ListedItem& item) {
  return {{"name", item.name}, {"input", item.input}, {"options", item.options}};
}

std::string Text(const Json& list) {
  return fmt::format("{}", fmt::join(list.get<std::vector<std::string>>(), " "));
}

}  // namespace

fs::path ItemFolder(const fs::path& out, const std::string& name) { return out / "items" / name; }

fs::path ItemLog(const fs::path& out, const std::string& name) {
  return out / "logs" / (name + ".log");
}

void RemovePartialItems(const fs::path& out, const std::string& name) {
  std::vector<fs::path> left;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(out / "items", ignored)) {
    const std::string file = entry.path().filename().string();
    const std::size_t end = file.rfind(".partial-");
    if (end == std::string::npos || (!name.empty() && file.substr(0, end) != name)) continue;
    left.push_back(entry.path());
  }
  for (const fs::path& path : left) fs::remove_all(path, ignored);
}

BatchFolder::BatchFolder(const fs::path& out, const BatchPlan& plan, bool resume)
    : out_(out), plan_(plan), date_(DateNow()) {
  std::error_code error;
  if (fs::exists(out, error) && !fs::is_directory(out, error)) {
    throw InputError::At(out.string(), 0, "is a file, expected a folder for the output");
  }
  fs::create_directories(out, error);
  if (error) {
    throw InputError::At(out.string(), 0,
                         fmt::format("cannot make a folder there: {}", error.message()));
  }
  const bool empty = fs::is_empty(out, error);
  if (!empty && !resume) {
    throw InputError::At(out.string(), 0, "exists and is not empty; --resume goes on with a batch");
  }
  if (!empty && !fs::exists(out / "batch.json") && !IsHardlyBegun(out)) {
    throw InputError::At(out.string(), 0, "no batch.json, expected the folder of a batch");
  }
  lock_ = std::make_unique<batch::FolderLock>(out / "lock", kWaitForTheKilled_s);
  if (fs::exists(out / "batch.json")) {
    GoOn();
  } else {
    Keep();
  }
  fs::create_directories(out / "items", error);
  fs::create_directories(out / "logs", error);
  records_ = std::make_unique<batch::Records>(out / "records.tsv");
}

/// Another command, other options or another program would make one table of two batches.
void BatchFolder::GoOn() {
  const fs::path file = out_ / "batch.json";
  const Json old = Json::parse(ReadTextFile(file), nullptr, false);
  const auto refuse = [&](const std::string& what) {
    throw InputError::At(file.string(), 0, what);
  };
  try {
    if (Text(old.at("command")) != Text(plan_.command)) {
      refuse(
          fmt::format("is a batch of {}, expected {}", Text(old["command"]), Text(plan_.command)));
    }
    if (old.at("options") != Json(plan_.options)) {
      refuse(fmt::format("has the options '{}', expected '{}'", Text(old["options"]),
                         Text(plan_.options)));
    }
    if (old.at("version") != kVersion) {
      refuse(fmt::format("was begun by flextip {}, this is {}", old["version"].get<std::string>(),
                         kVersion));
    }
    std::map<std::string, const ListedItem*> items;
    for (const ListedItem& item : plan_.items) items.emplace(item.name, &item);
    for (const Json& item : old.at("items")) {
      const std::string name = item.at("name");
      const auto found = items.find(name);
      if (found == items.end()) refuse(fmt::format("has an item {} that the list has not", name));
      if (item != ItemJson(*found->second)) {
        refuse(fmt::format("has an item {} with another path or other options", name));
      }
    }
    date_ = old.at("date");
    if (old["items"].size() != plan_.items.size()) Keep();  // the list has become longer
  } catch (const Json::exception&) {
    refuse("cannot be understood, expected what a batch has written");
  }
}

void BatchFolder::Keep() const {
  Json items = Json::array();
  for (const ListedItem& item : plan_.items) items.push_back(ItemJson(item));
  const Json json = {{"command", plan_.command},
                     {"options", plan_.options},
                     {"version", kVersion},
                     {"date", date_},
                     {"items", std::move(items)}};
  batch::WriteWhole(out_ / "batch.json",
                    json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::vector<std::size_t> BatchFolder::TakeNotDone() {
  std::vector<std::size_t> open;
  std::set<std::string> torn;
  std::error_code ignored;
  for (std::size_t i = 0; i < plan_.items.size(); ++i) {
    const std::string& name = plan_.items[i].name;
    const fs::path folder = ItemFolder(out_, name);
    const batch::Outcome* end = records_->Find(name);
    if (end && (end->status != batch::Status::kOk || fs::exists(folder / "summary.json"))) continue;
    if (end) torn.insert(name);
    open.push_back(i);
    fs::remove_all(folder, ignored);
    fs::remove(ItemLog(out_, name), ignored);
  }
  RemovePartialItems(out_);
  records_->Forget(torn);
  return open;
}

}  // namespace flextip
