#include "tests/project/doc_rules.h"

#include <gmock/gmock.h>

#include "tests/project/include_rules.h"

namespace flextip {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::UnorderedElementsAre;

const ProjectTexts& Project() {
  static const ProjectTexts texts = ReadProjectTexts(FLEXTIP_SOURCE_DIR);
  return texts;
}

TEST(DocRules, EveryLinkLeadsSomewhere) {
  ASSERT_TRUE(Project().contains("docs/architecture.md"));
  EXPECT_THAT(BrokenLinks(Project()), IsEmpty());
}

TEST(DocRules, LinesAreShort) { EXPECT_THAT(LongLines(Project()), IsEmpty()); }

TEST(DocRules, TroubleshootingQuotesMessagesThatAreThere) {
  const std::string page = "docs/troubleshooting.md";
  ASSERT_THAT(Project().at(page), HasSubstr("| `"));
  EXPECT_THAT(UnknownMessages(Project(), page), IsEmpty());
}

TEST(DocRules, ArchitectureHasTheArrowsThatAreChecked) {
  auto checked = IncludeArrows();
  checked.erase("cmake");  // one empty source
  const std::size_t libraries = checked.at("apps").size();
  for (auto& [folder, used] : checked) {
    if (used.size() >= libraries) used = {"everything"};
  }
  EXPECT_EQ(ArrowTable(Project(), "docs/architecture.md"), checked);
}

TEST(DocRules, TheReadmesExampleIsOneThatRuns) {
  EXPECT_THAT(UnknownExamples(Project(), "README.md"), IsEmpty());
}

TEST(DocRules, SeeALinkToNothing) {
  EXPECT_THAT(BrokenLinks({{"docs/a.md", "[b](b.md)\n[c](../core/c.h)\n"}, {"core/c.h", ""}}),
              ElementsAre("docs/a.md:1: there is no docs/b.md"));
}

TEST(DocRules, SeeALinkToNoHeading) {
  const ProjectTexts texts{{"a.md", "[x](docs/b.md#the-x) [y](docs/b.md#y) [z](#z)\n## Z\n"},
                           {"docs/b.md", "# B\n\n## The `x`\n```\n# y\n```\n"}};
  EXPECT_THAT(BrokenLinks(texts), ElementsAre("a.md:1: docs/b.md has no #y"));
}

TEST(DocRules, SeeAMentionOfNothing) {
  EXPECT_THAT(BrokenLinks({{"core/a.h", "\n// docs/b.md, and docs/c.md\n"}, {"docs/c.md", ""}}),
              ElementsAre("core/a.h:2: there is no docs/b.md"));
}

TEST(DocRules, CountCharactersOutsideTablesAndCode) {
  const std::string hundred(100, 'x'), more(101, 'x');
  std::string wide;
  for (int i = 0; i < 100; ++i) wide += "µ";
  const ProjectTexts texts{
      {"a.md", hundred + "\n" + wide + "\n| " + more + "\n```\n" + more + "\n```\n" + more + "\n"},
      {"b.md", "  [x](" + more + "),\n[x](" + more + ") y\n"},
      {"core/a.h", "// " + more + "\n"}};
  EXPECT_THAT(LongLines(texts), ElementsAre("a.md:7: 101 characters", "b.md:2: 108 characters",
                                            "core/a.h:1: 104 characters"));
}

TEST(DocRules, SeeAMessageThatNobodySays) {
  const ProjectTexts texts{
      {"docs/t.md", "| `found … apples, \"two\"` | why |\n| `no pears` | `not a message` |\n"},
      {"apps/a.cpp", "Fail(\"found {} \"\n     \"apples, \\\"two\\\" expected\");\n"},
      {"tests/a.cpp", "\"no pears\""}};
  EXPECT_THAT(UnknownMessages(texts, "docs/t.md"), ElementsAre("\"no pears\" of \"no pears\""));
}

TEST(DocRules, ReadTheTableOfArrows) {
  const ProjectTexts texts{{"a.md",
                            "| folder | job | may use | libraries |\n|---|---|---|---|\n"
                            "| `core/` | poses, all | – | Eigen |\n"
                            "| `pipeline/` | it | core, vision (its `data` types) | |\n"
                            "| `a/b_c/` | it | everything | |\n| `a/` | two columns |\n"}};
  EXPECT_THAT(
      ArrowTable(texts, "a.md"),
      UnorderedElementsAre(Pair("core", IsEmpty()), Pair("a/b_c", ElementsAre("everything")),
                           Pair("pipeline", UnorderedElementsAre("core", "vision"))));
}

TEST(DocRules, SeeAnExampleThatNobodyRuns) {
  const ProjectTexts texts{
      {"README.md", "```cpp\nint a;\nint b;\n```\n```cpp\nint c;\n```\n```\nx\n```\n"},
      {"examples/c.cpp", "int c;\n"}};
  EXPECT_THAT(UnknownExamples(texts, "README.md"), ElementsAre("int a;"));
}

}  // namespace
}  // namespace flextip
