// Which rows and columns the matrix's confusions have, and where a case belongs.
#include <algorithm>
#include <array>

#include "bench/diagnosis_matrix/output/summary.h"

namespace flextip::bench {
namespace {

constexpr std::array<const char*, 8> kOtherAnswers{
    "none",      "unknown",          "one of the two",  "both of the two",
    "all three", "two of the three", "truth + another", "two others"};
constexpr const char* kRefused = "refused";

bool Holds(const EffectNames& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string RowOf(const MatrixRecord& r) {
  if (!r.made.without.empty()) return r.made.without;
  if (r.made.part == "pairs") return "two effects";
  if (r.made.part == "triples") return "three effects";
  return r.form.empty() ? r.label.at(0) : r.form;
}

std::string ColumnOf(const MatrixRecord& r) {
  if (!r.error.empty()) return kRefused;
  int found = 0;
  for (const std::string& name : r.label) found += Holds(r.verdict, name) ? 1 : 0;
  if (r.made.part == "pairs") {
    if (r.IsRight()) return "both of the two";
    if (r.verdict.size() == 1 && found == 1) return "one of the two";
  }
  if (r.made.part == "triples") {
    if (r.IsRight()) return "all three";
    if (r.verdict.size() == 2 && found == 2) return "two of the three";
  }
  if (r.verdict.size() > 1) return found > 0 ? "truth + another" : "two others";
  return r.verdict.at(0);
}

std::string RightColumn(const std::string& row, bool deleted) {
  if (deleted) return "unknown";
  if (row == "two effects") return "both of the two";
  if (row == "three effects") return "all three";
  return Holds(hidden::OtherForms(), row) ? "unknown" : row;
}

Confusion MakeConfusion(const std::string& title, const std::vector<const MatrixRecord*>& cases) {
  Confusion confusion{title, {}, simulation::CatalogueEffects(), {}, {}};
  confusion.columns.insert(confusion.columns.end(), kOtherAnswers.begin(), kOtherAnswers.end());
  EffectNames rows = simulation::CatalogueEffects();
  rows.insert(rows.end(), {"none", "two effects", "three effects"});
  rows.insert(rows.end(), hidden::OtherForms().begin(), hidden::OtherForms().end());
  bool deleted = false;
  for (const MatrixRecord* r : cases) {
    deleted |= !r->made.without.empty();
    const std::string column = ColumnOf(*r);
    if (!Holds(confusion.columns, column)) confusion.columns.push_back(column);
  }
  const auto column_of = [&](const std::string& name) {
    return std::find(confusion.columns.begin(), confusion.columns.end(), name) -
           confusion.columns.begin();
  };
  for (const std::string& row : rows) {
    std::vector<int> counts(confusion.columns.size(), 0);
    int total = 0;
    for (const MatrixRecord* r : cases) {
      if (RowOf(*r) != row) continue;
      ++counts[column_of(ColumnOf(*r))];
      ++total;
    }
    if (total == 0) continue;
    confusion.rows.push_back(row);
    confusion.counts.push_back(counts);
    confusion.right.push_back(static_cast<int>(column_of(RightColumn(row, deleted))));
  }
  return confusion;
}

template <typename Test>
void AddConfusion(const std::vector<MatrixRecord>& records, const std::string& title,
                  const Test& test, std::vector<Confusion>& confusions) {
  std::vector<const MatrixRecord*> cases;
  for (const MatrixRecord& r : records) {
    const bool labelled = !r.label.empty();  // a recording that could not be made has none
    if (labelled && test(r)) cases.push_back(&r);
  }
  if (!cases.empty()) confusions.push_back(MakeConfusion(title, cases));
}

}  // namespace

std::vector<Confusion> Confusions(const std::vector<MatrixRecord>& records) {
  std::vector<Confusion> confusions;
  const auto is_main = [](const MatrixRecord& r) { return !r.made.part.starts_with("leave_"); };
  for (const std::string size : {"subtle", "plain", "strong"}) {
    AddConfusion(
        records, "Effects of " + size + " size",
        [&](const MatrixRecord& r) { return is_main(r) && r.made.size == size; }, confusions);
  }
  AddConfusion(
      records, "Nothing, and what the catalogue does not hold",
      [&](const MatrixRecord& r) { return is_main(r) && r.made.size == "any"; }, confusions);
  return confusions;
}

std::vector<Confusion> LeaveOutConfusions(const std::vector<MatrixRecord>& records) {
  std::vector<Confusion> confusions;
  for (const std::string sensor : {"em0", "strain0", "vision0", "wrist0_orientation"}) {
    AddConfusion(
        records, "Without " + sensor,
        [&](const MatrixRecord& r) {
          return r.made.part == "leave_sensor" && r.made.left_out == sensor;
        },
        confusions);
  }
  AddConfusion(
      records, "The true effect deleted from the catalogue",
      [](const MatrixRecord& r) { return r.made.part == "leave_effect"; }, confusions);
  return confusions;
}

}  // namespace flextip::bench
