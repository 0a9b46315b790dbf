// What the main functions of the tools share.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "core/error.h"

namespace flextip::bench {

/// Parses into Arguments and works on them. The exit code: 0 done, 2 wrong usage or InputError,
/// 1 any other failure, with a line on stderr.
template <class Arguments>
int RunTool(int argc, char** argv, const char* description,
            void (*add_options)(CLI::App&, Arguments&), void (*run)(Arguments&)) {
  const auto complain = [](const char* what, int code) {
    std::fputs(what, stderr);
    std::fputc('\n', stderr);
    return code;
  };
  try {
    CLI::App app(description);
    Arguments arguments;
    add_options(app, arguments);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : 2;
    }
    run(arguments);
    return 0;
  } catch (const InputError& error) {
    return complain(error.what(), 2);
  } catch (const std::exception& error) {
    return complain(error.what(), 1);
  } catch (...) {
    return complain("stopped by an error of unknown kind", 1);
  }
}

}  // namespace flextip::bench
