// Types and functions defined twice under one name: undefined behaviour in a program that links
// both.
#pragma once

#include <string>
#include <vector>

#include "tests/project/source_tree.h"

namespace flextip {

/// A definition at namespace scope outside anonymous namespaces. The name is fully qualified; that
/// of a function has its parameters' types.
struct Definition {
  std::string name;
  std::size_t line = 0;
};

/// Returns the definitions of one file. `main`, static functions and lines of the preprocessor are
/// left out.
std::vector<Definition> DefinitionsOf(const std::string& text);

/// Returns a line for each name that several files define: "flextip::X: a.cpp:3, b.h:7".
std::vector<std::string> DoubleDefinitions(const SourceTree& tree);

}  // namespace flextip
