#include "report/compare/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "core/error.h"
#include "report/compare/curves.h"
#include "report/compare/summary_values.h"
#include "report/labels.h"
#include "report/result_files.h"
#include "report/summary_parts.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Better = ComparedNumber::Better;

/// What a command is judged by, the first that all runs have.
constexpr std::array kMainFigures = {"tip_rms_error_m",
                                     "max_deviation_m",
                                     "heldout_error_ratio",
                                     "rms_reprojection_error_px",
                                     "rms_error_mm",
                                     "chi2_per_measurement",
                                     "ok"};
constexpr std::array kSmaller = {"error", "deviation", "rms",  "lost",  "chi2",    "_sd_",
                                 "noise", "predicted", "norm", "angle", "seconds", "rejected"};
constexpr std::array kLarger = {"ok", "frames_per_second", "share_inside", "views_used"};
constexpr std::size_t kMostBars = 6;
constexpr std::size_t kMostSpoken = 4;  // answers in the sentence

Better BetterOf(const std::string& key) {
  const auto holds = [&](const char* part) { return key.find(part) != std::string::npos; };
  if (std::any_of(kLarger.begin(), kLarger.end(), holds)) return Better::kLarger;
  if (std::any_of(kSmaller.begin(), kSmaller.end(), holds)) return Better::kSmaller;
  return Better::kNeither;
}

/// Names that tell the folders apart: the last parts of their paths, as few as do.
std::vector<std::string> NamesOf(const std::vector<fs::path>& folders) {
  std::vector<fs::path> rest(folders.size());
  std::vector<std::string> names(folders.size());
  std::transform(folders.begin(), folders.end(), rest.begin(),
                 [](const fs::path& folder) { return fs::weakly_canonical(folder); });
  do {
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const std::string part = rest[i].filename().string();
      names[i] = names[i].empty() ? part : part + "/" + names[i];
      rest[i] = rest[i].parent_path();
    }
  } while (
      std::set<std::string>(names.begin(), names.end()).size() < names.size() &&
      std::any_of(rest.begin(), rest.end(), [](const fs::path& p) { return p.has_filename(); }));
  return names;
}

Json ReadSummary(const fs::path& folder) {
  const auto file = folder / "summary.json";
  if (!fs::exists(file)) {
    throw InputError::At(
        folder.string(), 0,
        "no summary.json, expected a folder that a command of flextip has written");
  }
  const Json summary = Json::parse(ReadBytes(file), nullptr, false);
  if (!summary.is_object()) throw InputError::At(file.string(), 0, "not an object");
  return summary;
}

class NumberTable {
 public:
  explicit NumberTable(std::size_t runs) : runs_(runs) {}

  /// Adds every number of a run's summary, and of the objects in it, the names of which are groups.
  void Add(std::size_t run, const fs::path& folder) {
    for (const SummaryValue& value : ValuesOf(folder)) {
      if (value.number) Place(value.key, value.group).values[run] = *value.number;
    }
  }
  std::vector<ComparedNumber> Take() { return std::move(numbers_); }

 private:
  ComparedNumber& Place(const std::string& key, const std::string& group) {
    for (ComparedNumber& number : numbers_) {
      if (number.key == key && number.group == group) return number;
    }
    return numbers_.emplace_back(
        ComparedNumber{key, group, std::vector<std::optional<double>>(runs_), BetterOf(key)});
  }

  std::size_t runs_;
  std::vector<ComparedNumber> numbers_;
};

bool InAll(const ComparedNumber& number) {
  return std::all_of(number.values.begin(), number.values.end(),
                     [](const auto& value) { return value.has_value(); });
}

/// The numbers that the command is judged by: one, or one a group.
std::vector<const ComparedNumber*> MainNumbers(const std::vector<ComparedNumber>& numbers) {
  std::vector<const ComparedNumber*> main;
  for (const char* key : kMainFigures) {
    for (const ComparedNumber& number : numbers) {
      if (number.key == key && InAll(number)) main.push_back(&number);
    }
    if (!main.empty()) break;
  }
  return main;
}

std::string SpokenName(const ComparedNumber& number, const std::string& command) {
  const std::string label = Label(number.key, command);
  return number.group.empty() ? label : number.group + ", " + label;
}

/// What was answered, where no figure says which run is best.
std::string AnswersOf(const Comparison& comparison) {
  const auto& answers = comparison.answers;
  if (std::all_of(answers.begin(), answers.end(), [](const auto& a) { return a.empty(); })) {
    return fmt::format("{} results of {}: no figure that all of them have says which is best.",
                       comparison.names.size(), comparison.command);
  }
  if (answers.size() > kMostSpoken) {
    return fmt::format("{} results of {}: the answers are in the table.", answers.size(),
                       comparison.command);
  }
  std::string text;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    text += fmt::format("{}{}: {}", i == 0 ? "" : " ", comparison.names[i],
                        answers[i].empty() ? "no answer." : answers[i]);
  }
  return text;
}

std::string SentenceOf(const Comparison& comparison) {
  const auto main = MainNumbers(comparison.numbers);
  if (comparison.command == "diagnose" || main.empty()) return AnswersOf(comparison);
  const ComparedNumber& number = *main.front();
  const auto best = number.Best();
  const std::string name = SpokenName(number, comparison.command);
  if (!best) {
    return fmt::format("All have the same {}: {}.", name,
                       SpokenValue(number.key, *number.values.front()));
  }
  std::string others;
  for (std::size_t i = 0; i < comparison.names.size(); ++i) {
    if (i == *best) continue;
    others += fmt::format("{}{} in {}", others.empty() ? "" : ", ",
                          SpokenValue(number.key, *number.values[i]), comparison.names[i]);
  }
  return fmt::format("{} is best by {}: {}, against {}.", comparison.names[*best], name,
                     SpokenValue(number.key, *number.values[*best]), others);
}

Figure BarsOf(const ComparedNumber& number, const Comparison& comparison) {
  Figure figure{.title = SpokenName(number, comparison.command), .lying_bars = true};
  FigureTrace bars{.kind = FigureTrace::Kind::kBars};
  for (std::size_t i = 0; i < comparison.names.size(); ++i) {
    bars.labels.push_back(comparison.names[i]);
    bars.y.push_back(*number.values[i]);
    bars.texts.push_back(SpokenValue(number.key, *number.values[i]));
  }
  figure.traces.push_back(std::move(bars));
  return figure;
}

}  // namespace

std::optional<std::size_t> ComparedNumber::Best() const {
  if (better == Better::kNeither) return {};
  std::optional<std::size_t> best;
  std::size_t count = 0;
  bool differ = false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!values[i]) continue;
    ++count;
    if (best) differ = differ || *values[i] != *values[*best];
    const bool ahead = best && (better == Better::kSmaller ? *values[i] < *values[*best]
                                                           : *values[i] > *values[*best]);
    if (!best || ahead) best = i;
  }
  return count > 1 && differ ? best : std::nullopt;
}

Comparison CompareResults(const std::vector<fs::path>& folders) {
  Comparison comparison{.names = NamesOf(folders), .folders = folders};
  NumberTable table(folders.size());
  for (std::size_t i = 0; i < folders.size(); ++i) {
    const Json summary = ReadSummary(folders[i]);
    const std::string command = CommandOf(folders[i]);
    if (comparison.command.empty()) comparison.command = command;
    if (command != comparison.command) {
      throw InputError::At(folders[i].string(), 0,
                           fmt::format("a result of {}, expected one of {} as {} is", command,
                                       comparison.command, folders[0].string()));
    }
    table.Add(i, folders[i]);
    const Json verdict = summary.value("verdict", Json::object());
    comparison.answers.push_back(verdict.is_object() ? verdict.value("says", "") : "");
  }
  comparison.numbers = table.Take();
  comparison.says = SentenceOf(comparison);
  for (const ComparedNumber* number : MainNumbers(comparison.numbers)) {
    if (comparison.figures.size() < kMostBars)
      comparison.figures.push_back(BarsOf(*number, comparison));
  }
  for (Figure& figure : CurvesOf(comparison.command, folders, comparison.names)) {
    comparison.figures.push_back(std::move(figure));
  }
  return comparison;
}

}  // namespace flextip::report
