// Random numbers drawn in an order that C++ leaves to the compiler.
#pragma once

#include <string>
#include <vector>

#include "tests/project/source_tree.h"

namespace flextip {

/// Returns a line for each call of which two arguments draw: "a.cpp:3: f(...) draws in 2
/// arguments". An argument draws where it calls something with a generator, or a lambda that does.
/// Generators are the variables of type std::mt19937, std::mt19937_64 or Rng of the same file, and
/// members (name_) of any file. Elements of a braced list are drawn from first to last and are no
/// concern; nor are the bodies of lambdas among the arguments.
std::vector<std::string> UnorderedDraws(const SourceTree& tree);

}  // namespace flextip
