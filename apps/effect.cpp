// flextip effect: effects of the user's own.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <string>

#include "apps/common/commands.h"
#include "core/error.h"
#include "diagnosis/effects/discovered/term_source.h"
#include "diagnosis/model/catalogue.h"
#include "diagnosis/model/extended_model.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

struct EffectOptions {
  fs::path diagnosis, out;
  std::string name;
  int term = 1;
  bool force = false;
};

bool IsName(const std::string& name) {
  return !name.empty() && std::islower(static_cast<unsigned char>(name[0])) != 0 &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::islower(c) != 0 || std::isdigit(c) != 0 || c == '_';
         });
}

void RunEffectNew(const EffectOptions& options, bool quiet) {
  const fs::path file =
      fs::is_directory(options.diagnosis) ? options.diagnosis / "model.yaml" : options.diagnosis;
  const diagnosis::ExtendedModel model = diagnosis::ReadModel(file);
  const auto count = static_cast<int>(model.discovered.size());
  if (options.term > count) {
    throw InputError::At(
        file.string(), 0,
        fmt::format("found {} discovered terms, expected at least {}", count, options.term));
  }
  const diagnosis::Term& term = model.discovered[static_cast<std::size_t>(options.term - 1)];
  const std::string name = options.name.empty() ? diagnosis::EffectNameOf(term) : options.name;
  if (!IsName(name)) {
    throw InputError(fmt::format(
        "name '{}': expected lower case letters, digits and underlines, a letter first", name));
  }
  if (diagnosis::MakeEffect(name))
    throw InputError(fmt::format("name '{}': the catalogue has an effect of that name", name));
  if (fs::exists(options.out) && !options.force)
    throw InputError::At(options.out.string(), 0, "exists; --force replaces it");
  WriteTextFile(options.out, diagnosis::EffectSource(term, name));
  if (!quiet) fmt::print("{}: the effect {}\n", options.out.string(), name);
}

void AddEffectNew(CLI::App& effect, AppContext& context) {
  auto* command = effect.add_subcommand(
      "new", "Write what a diagnosis found without a name as the source of an own effect");
  auto options = std::make_shared<EffectOptions>();
  command
      ->add_option("diagnosis", options->diagnosis, "Result of flextip diagnose, or its model.yaml")
      ->required()
      ->type_name("DIAGNOSIS");
  command->add_option("-o,--output", options->out, "C++ file to write")
      ->required()
      ->type_name("FILE");
  command->add_option("--term", options->term, "Which of the discovered terms")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  command->add_option("--name", options->name, "Of the effect; without it by channel and form")
      ->type_name("NAME");
  command->add_flag("--force", options->force, "Replace FILE");
  command->footer("Example:\n  flextip effect new diagnosis -o em_hum.cpp --name em_hum\n");
  OnRun(*command, context, [options, &context] { RunEffectNew(*options, context.quiet); });
}

}  // namespace

void AddEffect(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("effect", "Effects of your own");
  command->require_subcommand(1);
  command->footer("Example:\n  flextip effect new --help\n");
  AddEffectNew(*command, context);
}

}  // namespace flextip
