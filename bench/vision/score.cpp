#include "bench/vision/score.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/error.h"
#include "core/median.h"
#include "recording/text/text.h"

namespace flextip::bench {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FrameScore, status, in_event, in_view, error_mm, turn_deg, nees,
                                   ms)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SequenceScore, number, events, family, tag_px, speed_m_s, wrist,
                                   gamma_known, frames)

namespace {

using Json = nlohmann::json;

// Chi-square of 3 degrees of freedom, 2.5 and 97.5 percent.
constexpr double kLow95 = 0.2158, kHigh95 = 9.3484;

struct Sums {
  int frames = 0, in_view = 0, ok_in_view = 0;
  int ok = 0, predicted = 0, lost = 0, false_ok = 0, wrong_ok = 0, flips = 0;
  std::vector<double> ok_mm, ok_nees, predicted_mm, predicted_nees, ms;

  void Add(const FrameScore& f) {
    ++frames;
    in_view += f.in_view;
    ok_in_view += f.in_view && f.status == "ok";
    false_ok += f.IsFalseOk();
    wrong_ok += f.IsWrongOk();
    flips += f.IsFlip();
    ms.push_back(f.ms);
    if (f.status == "lost") {
      ++lost;
      return;
    }
    const bool is_ok = f.status == "ok";
    ++(is_ok ? ok : predicted);
    (is_ok ? ok_mm : predicted_mm).push_back(f.error_mm);
    (is_ok ? ok_nees : predicted_nees).push_back(f.nees);
  }
};

double Mean(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x;
  return v.empty() ? 0 : sum / static_cast<double>(v.size());
}
double Rms(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return v.empty() ? 0 : std::sqrt(sum / static_cast<double>(v.size()));
}
double Inside95(const std::vector<double>& nees) {
  const auto in = [](double x) { return x > kLow95 && x < kHigh95; };
  return nees.empty() ? 0
                      : double(std::count_if(nees.begin(), nees.end(), in)) / double(nees.size());
}

std::vector<std::pair<std::string, Sums>> AllSums(const std::vector<SequenceScore>& scores) {
  std::vector<std::pair<std::string, Sums>> rows;
  const auto row = [&](const std::string& name) -> Sums& {
    const auto at =
        std::find_if(rows.begin(), rows.end(), [&](auto& r) { return r.first == name; });
    return at != rows.end() ? at->second : rows.emplace_back(name, Sums{}).second;
  };
  Sums all;
  for (const SequenceScore& s : scores) {
    for (const FrameScore& f : s.frames) {
      all.Add(f);
      if (s.events[0] == "none") row("none").Add(f);
      if (s.events[0] != "none" && !f.in_event) row("outside events").Add(f);
      if (f.in_event) row(s.events.size() > 1 ? "two events" : s.events[0]).Add(f);
    }
  }
  std::sort(rows.begin(), rows.end(), [](auto& a, auto& b) { return a.first < b.first; });
  rows.emplace_back("all", all);
  return rows;
}

Json ToJson(const Sums& s) {
  const auto of = [](const std::vector<double>& mm, const std::vector<double>& nees) {
    return Json{{"rms_mm", Rms(mm)},
                {"median_mm", LowerQuantile(mm, 0.5)},
                {"largest_mm", LowerQuantile(mm, 1.0)},
                {"nees_mean", Mean(nees)},
                {"nees_median", LowerQuantile(nees, 0.5)},
                {"inside_95", Inside95(nees)}};
  };
  return {{"frames", s.frames},
          {"ok", s.ok},
          {"predicted", s.predicted},
          {"lost", s.lost},
          {"recall", s.in_view > 0 ? double(s.ok_in_view) / s.in_view : 0.0},
          {"false_ok", s.false_ok},
          {"wrong_ok", s.wrong_ok},
          {"flips", s.flips},
          {"ms_per_frame", Mean(s.ms)},
          {"ms_largest", LowerQuantile(s.ms, 1.0)},
          {"of_ok", of(s.ok_mm, s.ok_nees)},
          {"of_predicted", of(s.predicted_mm, s.predicted_nees)}};
}

}  // namespace

std::string JsonLine(const SequenceScore& score) { return Json(score).dump(); }

std::vector<SequenceScore> ReadScores(const std::filesystem::path& file) {
  std::vector<SequenceScore> scores;
  if (!std::filesystem::exists(file)) return scores;
  const std::string text = ReadTextFile(file);
  std::istringstream lines(text.substr(0, text.rfind('\n') + 1));
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    try {
      scores.push_back(Json::parse(line).get<SequenceScore>());
    } catch (const Json::exception& error) {
      throw InputError(fmt::format("{}:{}: {}", file.string(), number, error.what()));
    }
  }
  std::sort(scores.begin(), scores.end(),
            [](const auto& a, const auto& b) { return a.number < b.number; });
  return scores;
}

std::string ScoreTable(const std::vector<SequenceScore>& scores) {
  std::string table = fmt::format(
      "{:<15}{:>7}{:>7}{:>7}{:>7}{:>8}{:>9}{:>9}{:>9}{:>9}{:>7}{:>8}{:>8}{:>10}{:>8}{:>8}{:>8}\n",
      "", "frames", "ok", "pred.", "lost", "recall", "rms mm", "median", "false ok", "wrong ok",
      "flips", "NEES", "in 95%", "pred. rms", "NEES", "in 95%", "ms");
  for (const auto& [name, s] : AllSums(scores)) {
    table += fmt::format(
        "{:<15}{:>7}{:>7}{:>7}{:>7}{:>8.3f}{:>9.3f}{:>9.3f}{:>9}{:>9}{:>7}{:>8.1f}{:>8.2f}{:>10.2f}"
        "{:>8.1f}{:>8.2f}{:>8.2f}\n",
        name, s.frames, s.ok, s.predicted, s.lost,
        s.in_view > 0 ? double(s.ok_in_view) / s.in_view : 0.0, Rms(s.ok_mm),
        LowerQuantile(s.ok_mm, 0.5), s.false_ok, s.wrong_ok, s.flips, Mean(s.ok_nees),
        Inside95(s.ok_nees), Rms(s.predicted_mm), Mean(s.predicted_nees),
        Inside95(s.predicted_nees), Mean(s.ms));
  }
  return table;
}

std::string ScoreJson(const std::vector<SequenceScore>& scores) {
  Json summary = {{"sequences", scores.size()}};
  for (const auto& [name, sums] : AllSums(scores)) summary["by_event"][name] = ToJson(sums);
  return summary.dump(2) + "\n";
}

std::string WrongFrames(const std::vector<SequenceScore>& scores) {
  std::string text;
  for (const SequenceScore& s : scores) {
    for (std::size_t i = 0; i < s.frames.size(); ++i) {
      const FrameScore& f = s.frames[i];
      if (!f.IsFalseOk() && !f.IsWrongOk()) continue;
      text += fmt::format(
          "sequence {:>4} frame {:>3}  {:<24} {} {:.0f} px {}  {}  {:.2f} mm  {:.1f} deg  NEES "
          "{:.1f}\n",
          s.number, i, fmt::format("{}", fmt::join(s.events, "+")), s.family, s.tag_px,
          f.in_event ? "in " : "out", f.IsFalseOk() ? "FALSE" : "wrong", f.error_mm, f.turn_deg,
          f.nees);
    }
  }
  return text;
}

}  // namespace flextip::bench
