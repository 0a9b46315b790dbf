#include "diagnosis/effects/discovered/term_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <vector>

#include "diagnosis/effects/discovered/column_source.h"
#include "diagnosis/effects/discovered/term_text.h"

namespace flextip::diagnosis {
namespace {

struct TargetSource {
  const char *target, *input, *applies;
};
constexpr TargetSource kSources[kTermTargets] = {
    {"kEmPosition", "kEmOffset", "samples.has_em"},
    {"kEmOrientation", "kEmReadTurn", "samples.has_em"},
    {"kStrain", "kStrainOffset", "samples.has_strain"},
    {"kVisionPosition", "kVisionShift", "samples.has_tip"},
    {"kVisionDirection", "kTipReadTurn", "samples.has_tip_direction"},
    {"kWristOrientation", "kWristReadTurn", "samples.has_wrist_direction"},
    {"kWristPosition", "kWrist", "samples.Duration() > 0.0"},
    {"kLoad", "kForce", "samples.has_load"},
    {"kPort", "kPort", "samples.Duration() > 0.0"},
    {"kStiffness", "kStiffness", "samples.Duration() > 0.0"},
    {"kFriction", "kPortFriction", "samples.Duration() > 0.0"},
    {"kShaftLoad", "kInside", "samples.Duration() > 0.0"},
    {"kCurvature", "kCurvature", "samples.Duration() > 0.0"},
    {"kEmTime", "kEmDelay", "samples.has_em"},
    {"kVisionTime", "kCameraDelay", "samples.has_tip"},
};

const TargetSource& SourceOf(const Term& term) { return kSources[static_cast<int>(term.target)]; }

/// "EmHum" of "em_hum".
std::string ClassName(const std::string& name) {
  std::string text;
  bool up = true;
  for (const char c : name) {
    if (c == '_') {
      up = true;
      continue;
    }
    text += up ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    up = false;
  }
  return text;
}

constexpr const char* kSpline = R"(
/// Cubic B-splines on equal steps from 0 to 1, clamped outside.
double Spline(int i, double x) {
  const double r = std::abs(std::clamp(x, 0.0, 1.0) * 4.0 - (i - 1));
  if (r >= 2.0) return 0.0;
  return r < 1.0 ? 2.0 / 3.0 - r * r + 0.5 * r * r * r : std::pow(2.0 - r, 3) / 6.0;
}
)";

std::string Head(const Term& term, const std::string& name) {
  return fmt::format(
      "// {}: {}.\n"
      "// A start, from what a diagnosis found (flextip effect new): say what it is, what is "
      "within\n"
      "// specification, and by which physics. How to go on: docs/usage/add_an_effect.md.\n",
      name, TextOf(term));
}

std::string Maker(const std::string& name) {
  const std::string type = ClassName(name);
  return fmt::format(
      "std::unique_ptr<flextip::diagnosis::Effect> Make{0}();\n"
      "std::unique_ptr<flextip::diagnosis::Effect> Make{0}() {{ return std::make_unique<{0}>(); "
      "}}\n",
      type);
}

/// Three inputs that swing in time: their base class scans the frequency.
std::string PeriodicSource(const Term& term, const std::string& name) {
  const TargetSource& source = SourceOf(term);
  const double size = term.amplitude.norm();
  return Head(term, name) +
         fmt::format(R"(#include "diagnosis/effects/periodic.h"

#include <memory>

namespace {{

using namespace flextip::diagnosis;

class {0} : public PeriodicEffect {{
 public:
  {0}()
      : PeriodicEffect("{1}", "{2}",
                       {{.first_input = sample_input::{3},
                        .tolerance = {4:.3g},
                        .typical = {5:.3g},
                        .lowest_hz = {6:.3g},
                        .highest_hz = {7:.3g},
                        .start_hz = {8:.6g}}}) {{}}
  bool Applies(const SampleSet& samples) const override {{
    return {9} && samples.resolved_in_time;
  }}
}};

}}  // namespace

)",
                     ClassName(name), name, TextOf(term), source.input, 0.05 * size, size,
                     0.5 * term.at[0], 2.0 * term.at[0], term.at[0], source.applies) +
         Maker(name);
}

}  // namespace

std::string EffectNameOf(const Term& term) {
  const std::string channel = InfoOf(term.target).channel;
  return channel.substr(0, channel.find('_')) + "_" + Name(FormOf(term));
}

std::string EffectSource(const Term& term, const std::string& name) {
  const TargetSource& source = SourceOf(term);
  const TermTargetInfo& info = InfoOf(term.target);
  if (term.shape == TermShape::kPeriodic && term.variable == TermVariable::kTime &&
      info.inputs == 3)
    return PeriodicSource(term, name);
  const int n = info.inputs, amplitudes = n * term.Columns();
  const bool offset = term.offset.size() > 0;
  std::string at;
  for (const double value : term.at) at += (at.empty() ? "" : ", ") + fmt::format("{:.12g}", value);
  std::string text = Head(term, name) +
                     "#include <algorithm>\n#include <cmath>\n#include <memory>\n#include "
                     "<numbers>\n#include <string>\n#include <vector>\n\n"
                     "#include \"diagnosis/effects/discovered/term_columns.h\"\n"
                     "#include \"diagnosis/model/effect.h\"\n\nnamespace {\n\n"
                     "using namespace flextip::diagnosis;\n";
  if (term.shape == TermShape::kSmooth) text += kSpline;
  text += fmt::format(R"(
class {0} : public DirectEffect {{
 public:
  std::string Name() const override {{ return "{1}"; }}
  std::string Summary() const override {{ return "{2}"; }}
  bool Applies(const SampleSet& samples) const override {{ return {3}; }}
  std::vector<FitParameter> Parameters(const SampleSet& samples) const override {{
)",
                      ClassName(name), name, TextOf(term), source.applies);
  text += "    std::vector<FitParameter> all;\n";
  const auto parameters = [&](const char* what, int count, double size) {
    if (count == 0) return;
    text += fmt::format(
        "    for (const double tolerance : ToleranceOf(samples, Name(), \"{}\", {:.3g}, {}))\n"
        "      all.push_back({{tolerance, {:.3g}, false}});\n",
        what, 0.05 * size, count, size);
  };
  const auto typical = [](const auto& values) {
    return std::max(1e-9, values.norm() / std::sqrt(std::max<double>(1.0, double(values.size()))));
  };
  parameters("amplitude", amplitudes, typical(term.amplitude));
  parameters("offset", offset ? n : 0, typical(term.offset));
  text += fmt::format(
      "    return all;\n  }}\n"
      "  void Apply(const double*, const Instant& now, EffectMemory& memory,\n"
      "             InputChange& change) const override {{\n"
      "    const TermState state = StateAt(TermTarget::{}, now, memory);\n"
      "    for (int i = 0; i < {}; ++i) {{\n{}",
      source.target, n, BeforeColumns(term));
  const auto columns = ColumnSources(term);
  const std::string sign = info.sign < 0.0 ? "-" : "";
  for (std::size_t j = 0; j < columns.size(); ++j)
    text +=
        fmt::format("      change.Linear({}i, sample_input::{} + i, {}({}));\n",
                    j == 0 ? "" : fmt::format("{} + ", int(j) * n), source.input, sign, columns[j]);
  if (offset)
    text +=
        fmt::format("      change.Linear({}i, sample_input::{} + i, {}1.0);\n",
                    amplitudes == 0 ? "" : fmt::format("{} + ", amplitudes), source.input, sign);
  text +=
      "    }\n    memory[0] = 1.0;  // begun; what StateAt and the shape go on from\n"
      "    memory[5] = state.t_s;\n  }\n"
      "  bool NeedsPortPlace() const override { return true; }\n";
  if (IsStamp(term.target) && amplitudes == 0)  // what estimate takes off the stamps
    text += fmt::format("  int DelayInput() const override {{ return sample_input::{}; }}\n",
                        source.input);
  text +=
      "\n protected:\n"
      "  std::vector<Named> Names() const override {\n    return {";
  if (amplitudes > 0) text += fmt::format("{{\"amplitude\", {}}}", amplitudes);
  if (offset) text += fmt::format("{}{{\"offset\", {}}}", amplitudes > 0 ? ", " : "", n);
  text += "};\n  }\n";
  if (!term.at.empty())
    text += fmt::format(
        "\n private:\n  static constexpr double kAt[] = {{{}}};  // of the shape, as found\n", at);
  return text + "};\n\n}  // namespace\n\n" + Maker(name);
}

}  // namespace flextip::diagnosis
