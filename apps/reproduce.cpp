// flextip reproduce: starts flextip-reproduce, the program of reproduction/, with the same
// arguments.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "apps/common/commands.h"
#include "core/error.h"

namespace flextip {
namespace {

constexpr const char* kProgram = "flextip-reproduce";

/// Returns the program beside the running one; empty where there is none.
std::filesystem::path Beside() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto program = self.parent_path() / kProgram;
  return !error && std::filesystem::exists(program, error) ? program : std::filesystem::path();
}

/// Becomes flextip-reproduce: the one beside this program, else the one on PATH. Throws WorkError
/// where there is neither.
void RunReproduce(std::vector<std::string> arguments, bool quiet) {
  const std::filesystem::path beside = Beside();
  arguments.insert(arguments.begin(), beside.empty() ? kProgram : beside.string());
  if (quiet) arguments.emplace_back("--quiet");
  std::vector<char*> argv;
  argv.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execvp(argv[0], argv.data());  // returns only where it fails
  if (errno != ENOENT) {
    throw WorkError(fmt::format("{}: cannot be started: {}", arguments[0],
                                std::generic_category().message(errno)));
  }
  throw WorkError(
      fmt::format("{0} is neither beside this program nor on PATH; "
                  "cmake --build build/release --target {0} builds it",
                  kProgram));
}

}  // namespace

void AddReproduce(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("reproduce", "The thesis's figures and numbers beside ours");
  command->set_help_flag();                       // the program itself explains its options
  command->prefix_command()->fallthrough(false);  // hands all that follows on
  OnRun(*command, context,
        [command, &context] { RunReproduce(command->remaining(), context.quiet); });
}

}  // namespace flextip
