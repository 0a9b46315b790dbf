#include "bench/diagnosis_matrix/output/figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "core/median.h"

namespace flextip::bench {
namespace {

using Group = std::vector<const MatrixRecord*>;
using Test = std::function<bool(const MatrixRecord&)>;

bool Holds(const EffectNames& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

Group Where(const std::vector<MatrixRecord>& records, const Test& test) {
  Group group;
  for (const MatrixRecord& r : records)
    if (test(r)) group.push_back(&r);
  return group;
}

Test IsPart(const std::string& part) {
  return [part](const MatrixRecord& r) { return r.made.part == part; };
}

int Found(const MatrixRecord& r) {
  return static_cast<int>(std::count_if(r.label.begin(), r.label.end(),
                                        [&](const auto& name) { return Holds(r.verdict, name); }));
}

/// A single answer that nothing else was declared indistinguishable from.
bool StandsAlone(const MatrixRecord& r) {
  return std::all_of(r.indistinguishable.begin(), r.indistinguishable.end(),
                     [](const EffectNames& group) { return group.size() < 2; });
}

/// With the true effect deleted: an answer that the full catalogue declared indistinguishable from
/// the truth, or what it answered itself without naming the truth.
bool IsDeclaredAlias(const MatrixRecord& r) {
  if (r.verdict == r.full_verdict) return true;
  return std::all_of(r.verdict.begin(), r.verdict.end(), [&](const std::string& name) {
    return Holds(r.full_verdict, name) ||
           std::any_of(r.full_indistinguishable.begin(), r.full_indistinguishable.end(),
                       [&](const EffectNames& group) { return Holds(group, name); });
  });
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

std::vector<double> Each(const Group& group,
                         const std::function<double(const MatrixRecord&)>& value) {
  std::vector<double> values;
  for (const MatrixRecord* r : group) values.push_back(value(*r));
  return values;
}

/// Expected calibration error: over ten bins of the answer's probability, the mean distance of
/// their mean probability from their share of right answers.
double CalibrationError(const Group& group) {
  std::array<double, 10> sure{}, right{};
  for (const MatrixRecord* r : group) {
    const int bin = std::clamp(static_cast<int>(10.0 * r->p_verdict), 0, 9);
    sure[bin] += r->p_verdict;
    right[bin] += r->IsRight() ? 1.0 : 0.0;
  }
  double error = 0.0;
  for (int bin = 0; bin < 10; ++bin) error += std::abs(sure[bin] - right[bin]);
  return group.empty() ? 0.0 : error / static_cast<double>(group.size());
}

class FigureMaker {
 public:
  explicit FigureMaker(const std::vector<MatrixRecord>& records) : records_(records) {}

  std::vector<MatrixFigure> Make() {
    const std::vector<std::string> sizes{"subtle", "plain", "strong"};
    for (const std::string& size : sizes) {
      for (const char* load : {"", " load known", " load unknown"}) Singles(size, load);
    }
    const Group healthy = Where(records_, IsPart("healthy"));
    Add("false alarms", "healthy", Share(healthy, [](const auto& r) { return !r.IsRight(); }),
        healthy, "<= 0.01");
    Unknowns();
    for (const std::string& size : sizes) Pairs(size);
    for (const std::string& size : sizes) Triples(size);
    LeaveOuts();
    Overall();
    for (const std::string& size : sizes) {
      Parameters(size);
      Deviations(size);
    }
    return figures_;
  }

 private:
  void Add(const std::string& figure, const std::string& group, double value, int of,
           const std::string& target = "") {
    if (of > 0) figures_.push_back({figure, group, value, of, target});
  }
  void Add(const std::string& figure, const std::string& group, double value, const Group& of,
           const std::string& target = "") {
    Add(figure, group, value, static_cast<int>(of.size()), target);
  }
  static double Share(const Group& group, const Test& test) {
    return Mean(Each(group, [&](const MatrixRecord& r) { return test(r) ? 1.0 : 0.0; }));
  }

  static Group Separable(Group group) {
    std::erase_if(group, [](const MatrixRecord* r) { return !r->IsSeparable(); });
    return group;
  }

  void Singles(const std::string& size, const std::string& load) {
    const Group group = Where(records_, [&](const MatrixRecord& r) {
      return r.made.part == "singles" && r.made.size == size &&
             (load.empty() || r.made.load == (load == " load known"));
    });
    const std::string name = "singles " + size + load;
    const Group separable = Separable(group);
    Add("right cause first", name, Share(group, &MatrixRecord::IsRight), group);
    Add("right cause first, separable only", name, Share(separable, &MatrixRecord::IsRight),
        separable, ">= 0.95");
    Add("right or declared indistinguishable", name, Share(group, &MatrixRecord::IsRightOrDeclared),
        group);
    if (!load.empty()) return;
    const auto beside = [](const MatrixRecord& r) { return r.verdict.size() > 1 && Found(r) > 0; };
    Add("right with a spurious second", name, Share(group, beside), group, "<= 0.02");
    Group alone = group;
    std::erase_if(alone, [](const MatrixRecord* r) { return !StandsAlone(*r); });
    Add("right cause first, none declared", name, Share(alone, &MatrixRecord::IsRight), alone);
    const auto p_truth = [](auto& r) { return r.p_truth; };
    Add("mean probability of the truth", name, Mean(Each(group, p_truth)), group);
    Add("mean probability, separable only", name, Mean(Each(separable, p_truth)), separable,
        ">= 0.90");
    const auto in_set = [](auto& r) { return r.truth_in_credible_set; };
    Add("truth in the 90 % set", name, Share(group, in_set), group, ">= 0.90");
    Add("truth in the 90 % set, separable only", name, Share(separable, in_set), separable,
        ">= 0.90");
    Add("median size of the 90 % set", name,
        Quantile(Each(group, [](auto& r) { return double(r.credible_set_size); }), 0.5), group);
  }

  void Unknowns() {
    const Group all = Where(records_, IsPart("unknown"));
    const Group separable = Separable(all);
    Add("answered unknown", "all forms", Share(all, &MatrixRecord::IsRight), all, ">= 0.90");
    Add("answered unknown, apart from all known", "all forms",
        Share(separable, &MatrixRecord::IsRight), separable, ">= 0.90");
    for (const std::string& form : hidden::OtherForms()) {
      Group group = all;
      std::erase_if(group, [&](const MatrixRecord* r) { return r->form != form; });
      Add("answered unknown", form, Share(group, &MatrixRecord::IsRight), group);
    }
  }

  void Pairs(const std::string& size) {
    const Group group = Where(records_, [&](const MatrixRecord& r) {
      return r.made.part == "pairs" && r.made.size == size;
    });
    const std::string name = "pairs " + size;
    const Group separable = Separable(group);
    const auto both = [](auto& r) { return Found(r) == 2; };
    const auto one = [](auto& r) { return Found(r) >= 1; };
    Add("both right", name, Share(group, both), group, ">= 0.90");
    Add("both right, separable only", name, Share(separable, both), separable, ">= 0.90");
    Add("both right or declared", name, Share(group, &MatrixRecord::IsRightOrDeclared), group);
    Add("at least one right", name, Share(group, one), group, ">= 0.99");
    Add("at least one right, separable only", name, Share(separable, one), separable, ">= 0.99");
    Add("truth in the 90 % set", name,
        Share(group, [](auto& r) { return r.truth_in_credible_set; }), group, ">= 0.90");
  }

  void Triples(const std::string& size) {
    const Group group = Where(records_, [&](const MatrixRecord& r) {
      return r.made.part == "triples" && r.made.size == size;
    });
    const std::string name = "triples " + size;
    const Group separable = Separable(group);
    const auto two = [](auto& r) { return Found(r) >= 2; };
    Add("all three right", name, Share(group, &MatrixRecord::IsRight), group);
    Add("all three right, separable only", name, Share(separable, &MatrixRecord::IsRight),
        separable, ">= 0.85");
    Add("at least two right", name, Share(group, two), group);
    Add("at least two right, separable only", name, Share(separable, two), separable, ">= 0.98");
  }

  void LeaveOuts() {
    for (const char* sensor : {"em0", "strain0", "vision0", "wrist0_orientation"}) {
      const Group group = Where(records_, [&](const MatrixRecord& r) {
        return r.made.part == "leave_sensor" && r.made.left_out == sensor;
      });
      const std::string name = std::string("without ") + sensor;
      Add("right cause first", name, Share(group, &MatrixRecord::IsRight), group);
      Add("right or declared indistinguishable", name,
          Share(group, &MatrixRecord::IsRightOrDeclared), group);
      Add("truth in the 90 % set", name,
          Share(group, [](auto& r) { return r.truth_in_credible_set; }), group, ">= 0.90");
    }
    const Group group = Where(records_, IsPart("leave_effect"));
    const std::string name = "true effect deleted";
    const auto right_or_alias = [](auto& r) { return r.IsRight() || IsDeclaredAlias(r); };
    Add("answered unknown", name, Share(group, &MatrixRecord::IsRight), group);
    Add("unknown or a declared alias", name, Share(group, right_or_alias), group, ">= 0.90");
    const Group apart = Separable(group);
    Add("unknown or a declared alias, apart from three of the others", name,
        Share(apart, right_or_alias), apart, ">= 0.90");
    const auto seen = [&](auto& r) { return right_or_alias(r) || r.terms > 0; };
    Add("unknown, a term or a declared alias", name, Share(group, seen), group, ">= 0.90");
    Add("unknown, a term or a declared alias, apart from three of the others", name,
        Share(apart, seen), apart, ">= 0.90");
  }

  void Overall() {
    const Group main = Where(records_, [](const MatrixRecord& r) {
      return !r.made.part.starts_with("leave_") && r.error.empty();
    });
    Add("expected calibration error", "all but leave-outs", CalibrationError(main), main,
        "<= 0.05");
    Add("mean probability of the verdict", "all but leave-outs",
        Mean(Each(main, [](auto& r) { return r.p_verdict; })), main);
    Add("truth in the 90 % set", "all but leave-outs",
        Share(main, [](auto& r) { return r.truth_in_credible_set; }), main, ">= 0.90");
    const Group refused = Where(records_, [](const MatrixRecord& r) { return !r.error.empty(); });
    Add("refused", "all", static_cast<double>(refused.size()), static_cast<int>(records_.size()));
    Group gained = main;
    std::erase_if(gained, [](auto* r) { return !r->gain_measured || r->label[0] == "none"; });
    const auto ratios = Each(gained, [](auto& r) { return r.heldout_error_ratio; });
    Add("held-out error, extended over base", "median", Quantile(ratios, 0.5), gained);
    Add("held-out error of extended, noise sd", "median",
        Quantile(Each(gained, [](auto& r) { return r.extended_weighted_rms; }), 0.5), gained);
    Group beside_truth = main;
    std::erase_if(beside_truth, [](auto* r) { return r->heldout_over_true <= 0.0; });
    const auto over_true = Each(beside_truth, [](auto& r) { return r.heldout_over_true; });
    for (const auto& [part, name] : {std::pair(0.5, "median"), std::pair(0.9, "90 %")})
      Add("held-out error, extended over true", name, Quantile(over_true, part), beside_truth,
          "<= 1.05");
    const auto seconds = Each(main, [](auto& r) { return r.seconds; });
    Add("seconds", "median", Quantile(seconds, 0.5), main, "<= 5");
    Add("seconds", "95 %", Quantile(seconds, 0.95), main, "<= 5");
  }

  void Parameters(const std::string& size) {
    std::vector<double> errors;
    for (const MatrixRecord& r : records_) {
      if (r.made.part != "singles" || r.made.size != size || !r.IsRight()) continue;
      for (const JudgedParameter& p : r.parameters)
        errors.push_back(std::abs(p.value - p.truth) / std::max(p.sd, 1e-300));
    }
    const int count = static_cast<int>(errors.size());
    std::vector<double> within, squares;
    for (const double e : errors) {
      within.push_back(e <= 3.0 ? 1.0 : 0.0);
      squares.push_back(e * e);
    }
    const std::string name = "parameters " + size;
    Add("within 3 sd", name, Mean(within), count, ">= 0.95");
    Add("median |error| / sd", name, Quantile(errors, 0.5), count, "0.67");
    Add("mean (error / sd)^2", name, Mean(squares), count, "1");
  }

  /// Stated standard deviations against the least there can be.
  void Deviations(const std::string& size) {
    std::vector<double> ratios, within;
    for (const MatrixRecord& r : records_) {
      if (r.made.size != size) continue;
      for (const JudgedParameter& p : r.parameters)
        if (p.bound > 0.0) ratios.push_back(p.sd / p.bound);
    }
    for (const double ratio : ratios) within.push_back(ratio >= 0.5 && ratio <= 2.0 ? 1.0 : 0.0);
    const int count = static_cast<int>(ratios.size());
    const std::string name = "singles and pairs " + size;
    Add("sd over Cramer-Rao bound, median", name, Quantile(ratios, 0.5), count, "0.5 to 2");
    Add("sd 0.5 to 2 times the bound", name, Mean(within), count);
  }

  const std::vector<MatrixRecord>& records_;
  std::vector<MatrixFigure> figures_;
};

}  // namespace

std::vector<MatrixFigure> Figures(const std::vector<MatrixRecord>& records) {
  return FigureMaker(records).Make();
}

}  // namespace flextip::bench
