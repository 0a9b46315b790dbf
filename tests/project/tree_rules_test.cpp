// Rules for the tree as a whole: the size of folders, and which words stand where.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "tests/project/source_tree.h"
#include "tests/project/tokens.h"

namespace flextip {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kMostFiles = 30;

/// Returns the folders with more than 30 files of their own: "vision: 59 files".
std::vector<std::string> LargeFolders(const std::vector<std::string>& files) {
  std::map<std::string, int> count;
  for (const std::string& file : files) ++count[file.substr(0, file.rfind('/'))];
  std::vector<std::string> large;
  for (const auto& [folder, number] : count)
    if (number > kMostFiles) large.push_back(fmt::format("{}: {} files", folder, number));
  return large;
}

TEST(Folders, HaveAtMost30Files) {
  EXPECT_THAT(LargeFolders(ProjectFiles(FLEXTIP_SOURCE_DIR)), IsEmpty());
}

TEST(Folders, AreCountedWithoutTheirSubFolders) {
  std::vector<std::string> files(30, "a/b/file");
  files.resize(60, "a/file");
  EXPECT_THAT(LargeFolders(files), IsEmpty());
  files.emplace_back("a/b/another");
  EXPECT_THAT(LargeFolders(files), ElementsAre("a/b: 31 files"));
}

bool KnowsEffects(const std::string& path) {
  return path.starts_with("diagnosis/effects/") || path == "diagnosis/model/catalogue.cpp";
}

/// Returns the names of the effects, as their files give them.
std::set<std::string> EffectNames(const SourceTree& tree) {
  static const std::regex name(R"re((?:Name\(\) const override \{ return |\w+Effect\()"(\w+)")re");
  std::set<std::string> names;
  for (const auto& [path, text] : tree) {
    if (!path.starts_with("diagnosis/effects/")) continue;
    for (std::sregex_iterator match(text.begin(), text.end(), name), end; match != end; ++match)
      names.insert((*match)[1]);
  }
  return names;
}

std::vector<std::string> EffectsNamed(const SourceTree& tree) {
  const std::set<std::string> names = EffectNames(tree);
  std::vector<std::string> named;
  for (const auto& [path, text] : tree) {
    if (!path.starts_with("diagnosis/") || KnowsEffects(path)) continue;
    for (const Token& literal : StringLiterals(text))
      if (names.contains(literal.text))
        named.push_back(fmt::format("{}:{}: \"{}\"", path, literal.line, literal.text));
  }
  return named;
}

/// What the search needs to know of an effect is a property of the effect, so that a new one is one
/// file.
TEST(Diagnosis, KnowsNoEffectByName) {
  const SourceTree tree = ReadSourceTree(FLEXTIP_SOURCE_DIR);
  const std::set<std::string> names = EffectNames(tree);
  EXPECT_GE(names.size(), 22U);  // those of the first release, and the registration
  EXPECT_TRUE(names.contains("port_motion") && names.contains("stiffness"));
  EXPECT_THAT(EffectsNamed(tree), IsEmpty());
}

TEST(Diagnosis, IsSeenToNameAnEffect) {
  const SourceTree tree{
      {"diagnosis/effects/a.cpp", "std::string Name() const override { return \"sag\"; }"},
      {"diagnosis/search/b.cpp", "// \"sag\"\nint block = layout.Find(\"sag\");"},
      {"diagnosis/model/c.cpp", "const char* text = \"sagging\";"}};
  EXPECT_THAT(EffectsNamed(tree), ElementsAre("diagnosis/search/b.cpp:2: \"sag\""));
}

/// Returns the headers of cmake/PublicHeaders.cmake.
std::set<std::string> PublicHeaders() {
  std::ifstream file(std::filesystem::path(FLEXTIP_SOURCE_DIR) / "cmake/PublicHeaders.cmake");
  std::set<std::string> headers;
  static const std::regex header(R"(^  ([\w/]+\.h)\)?$)");
  for (std::string line; std::getline(file, line);) {
    std::smatch match;
    if (std::regex_match(line, match, header)) headers.insert(match[1]);
  }
  return headers;
}

TEST(PublicHeaders, IncludeOnlyOneAnother) {
  const SourceTree tree = ReadSourceTree(FLEXTIP_SOURCE_DIR);
  const std::set<std::string> headers = PublicHeaders();
  ASSERT_TRUE(headers.contains("core/pose.h"));
  static const std::regex include(R"re(#include "([^"]+)")re");
  for (const std::string& path : headers) {
    ASSERT_TRUE(tree.contains(path)) << path;
    const std::string& text = tree.at(path);
    for (std::sregex_iterator match(text.begin(), text.end(), include), end; match != end; ++match)
      EXPECT_TRUE(headers.contains((*match)[1])) << path << " includes " << (*match)[1];
  }
}

}  // namespace
}  // namespace flextip
