#include "apps/common/run_facts.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <array>
#include <chrono>

#include "core/shell_text.h"

namespace flextip {
namespace {

// What measures time: keys of a summary.
constexpr std::array kTimes{"seconds", "frames_per_second"};

struct Facts {
  std::string typed;
  nlohmann::ordered_json* times = nullptr;  // where they are kept apart
  std::filesystem::path result = {};
};

Facts& FactsOfThisProcess() {
  static Facts facts;
  return facts;
}

}  // namespace

std::string ShellLine(const std::string& program, const std::vector<std::string>& arguments) {
  std::string line = program;
  for (const std::string& argument : arguments) {
    line += ' ';
    line += ShellQuoted(argument);
  }
  return line;
}

void NoteTyped(const std::string& program, const std::vector<std::string>& arguments) {
  Facts& facts = FactsOfThisProcess();
  if (facts.times == nullptr) facts.typed = ShellLine(program, arguments);
}

const std::string& Typed() { return FactsOfThisProcess().typed; }

std::string DateNow() {
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(now)));
}

void KeepTimesApart(const std::string& typed, const std::filesystem::path& result,
                    nlohmann::ordered_json& times) {
  FactsOfThisProcess() = {typed, &times, result};
}

std::filesystem::path ResultAsSaid(const std::filesystem::path& given) {
  const Facts& facts = FactsOfThisProcess();
  return facts.times == nullptr ? given : facts.result;
}

void AddRunFacts(double seconds, nlohmann::ordered_json& summary) {
  const Facts& facts = FactsOfThisProcess();
  if (facts.times == nullptr) {
    summary["seconds"] = seconds;
    summary["date"] = DateNow();
  } else {
    for (const char* key : kTimes) {
      if (!summary.contains(key)) continue;
      (*facts.times)[key] = summary[key];
      summary.erase(key);
    }
  }
  if (!facts.typed.empty()) summary["typed"] = facts.typed;
}

}  // namespace flextip
