#include "apps/common/manual.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/version.h"

namespace flextip {
namespace {

/// "flextip calibrate tip", with `space` between the words.
std::string PathOf(const CLI::App& command, const std::string& space) {
  const CLI::App* parent = command.get_parent();
  if (parent == nullptr) return command.get_name();
  return PathOf(*parent, space) + space + command.get_name();
}

std::vector<const CLI::App*> CommandsOf(const CLI::App& app) { return app.get_subcommands({}); }

/// Text as roff reads it: no command at a line's beginning, hyphens that can be copied.
std::string Roff(const std::string& text) {
  std::string roff;
  bool at_start = true;
  for (const char c : text) {
    if (at_start && (c == '.' || c == '\'')) roff += "\\&";
    if (c == '\\') {
      roff += "\\\\";
    } else if (c == '-') {
      roff += "\\-";
    } else {
      roff += c;
    }
    at_start = c == '\n';
  }
  return roff;
}

std::string TypeOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type.empty() ? "" : " " + type;
}

std::string OptionsSection(const CLI::App& app) {
  std::string positionals, options;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;  // hidden
    const bool positional = option->get_positional();
    const std::string name = positional ? option->get_type_name() : option->get_name();
    (positional ? positionals : options) +=
        fmt::format(".TP\n.B {}\n{}\n", Roff(name + (positional ? "" : TypeOf(*option))),
                    Roff(option->get_description()));
  }
  std::string section;
  if (!positionals.empty()) section += ".SH ARGUMENTS\n" + positionals;
  if (!options.empty()) section += ".SH OPTIONS\n" + options;
  return section;
}

std::string CommandsSection(const CLI::App& app) {
  const auto commands = CommandsOf(app);
  if (commands.empty()) return "";
  std::string section = ".SH COMMANDS\n";
  for (const CLI::App* command : commands) {
    section += fmt::format(".TP\n.B {}\n{}\n", Roff(command->get_name()),
                           Roff(command->get_description()));
  }
  return section;
}

std::string PageOf(const CLI::App& app, const std::string& date) {
  const std::string name = PathOf(app, "-"), words = PathOf(app, " ");
  std::string page =
      fmt::format(".TH {} 1 \"{}\" \"flextip {}\" \"flextip\"\n", Roff(name), date, kVersion);
  page += fmt::format(".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n{}\n", Roff(name),
                      Roff(app.get_description()), Roff(words),
                      CommandsOf(app).empty() ? "[OPTIONS]" : "COMMAND [OPTIONS]");
  page += CommandsSection(app) + OptionsSection(app);
  if (!app.get_footer().empty())
    page += fmt::format(".SH NOTES\n.nf\n{}\n.fi\n", Roff(app.get_footer()));
  page +=
      ".SH EXIT STATUS\n0: done. 1: the work failed, or no answer holds. 2: wrong usage or "
      "unreadable input.\n";
  return page;
}

void AddPages(const CLI::App& app, const std::string& date,
              std::map<std::string, std::string>& pages) {
  pages[PathOf(app, "-") + ".1"] = PageOf(app, date);
  for (const CLI::App* command : CommandsOf(app)) AddPages(*command, date, pages);
}

/// A line of the script's first case for each command, and of the second for its words.
void AddCases(const CLI::App& app, std::string& commands, std::string& words) {
  const std::string path = PathOf(app, " ");
  std::string list;
  for (const CLI::App* command : CommandsOf(app)) {
    list += command->get_name() + " ";
    commands +=
        fmt::format("      \"{} {}\") path=\"$path $word\" ;;\n", path, command->get_name());
  }
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    for (const auto& name : option->get_lnames()) list += "--" + name + " ";
  }
  words += fmt::format("    \"{}\") words=\"{}\" ;;\n", path, list);
  for (const CLI::App* command : CommandsOf(app)) AddCases(*command, commands, words);
}

}  // namespace

std::map<std::string, std::string> ManPages(const CLI::App& app, const std::string& date) {
  std::map<std::string, std::string> pages;
  AddPages(app, date, pages);
  return pages;
}

std::string CompletionScript(const CLI::App& app) {
  std::string commands, words;
  AddCases(app, commands, words);
  const std::string& name = app.get_name();
  return fmt::format(R"(# Completion of {0}'s commands and options. bash: source it, or put it into
# bash-completion's folder. zsh: autoload -U bashcompinit; bashcompinit; then source it.
_{0}() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} path={0} words="" word
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case "$path $word" in
{1}    esac
  done
  case "$path" in
{2}  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o default -F _{0} {0}
)",
                     name, commands, words);
}

}  // namespace flextip
