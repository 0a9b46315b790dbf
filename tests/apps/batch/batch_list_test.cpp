// The list of flextip batch: what it may say, and how it is refused.
#include "tests/apps/batch/batch_fixture.h"

namespace flextip::batch_test {
namespace {

namespace fs = std::filesystem;

class BatchList : public BatchCommand {
 protected:
  ProgramResult Run(const std::string& text) const {
    return RunProgram(
        {"batch", "check", folder_.Write("list.txt", text), "-o", Out(), "--jobs", "2"});
  }
};

TEST_F(BatchList, IsRefusedWithItsLine) {
  const std::vector<std::pair<std::string, std::vector<std::string>>> wrong{
      {"a\n\"b\n", {"list.txt:2: found no second \""}},
      {"a\n# only this\nb name=x/y\n", {"list.txt:3: found the name \"x/y\"", "letters"}},
      {"a name=.hidden\n", {"list.txt:1: found the name"}},
      {"a name=same\nb name=same\n", {"list.txt:2: found the name same of line 1 again"}},
      {"d/a\nd/a --json\n", {"list.txt:2: found the name", "of line 1 again"}},
      {"a --option name=..\n", {"list.txt:1: found the name"}},
      {"name=x a\n", {"list.txt:1: found \"name=x\", expected a path first"}},
      {"a -o b\n", {"list.txt:1: found -o for the items"}},
      {"a --output=b\n", {"list.txt:1: found --output=b for the items"}},
      {"a --force\n", {"list.txt:1: found --force for the items"}},
      {"# nothing\n\n", {"list.txt: holds no path"}}};
  for (const auto& [text, parts] : wrong) {
    EXPECT_TRUE(IsRefused(Run(text), parts)) << text;
    EXPECT_FALSE(fs::exists(folder_ / "out")) << text;
  }
}

TEST_F(BatchList, IsRefusedWhereItIsNone) {
  const auto run = [&](const std::string& list) {
    return RunProgram({"batch", "check", list, "-o", Out()});
  };
  EXPECT_TRUE(IsRefused(run(folder_ / "absent.txt"), {"absent.txt"}));
  EXPECT_TRUE(IsRefused(run(Sample(0)), {"is a folder, expected a file of paths"}));
  EXPECT_TRUE(IsRefused(run(folder_ / "none*"), {"no path is like that"}));
}

TEST_F(BatchList, GoesWithACommandThatHasInputAndOutput) {
  const std::string list = CheckList();
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "batch");
    words.insert(words.end(), {"-o", Out()});
    return RunProgram(words);
  };
  EXPECT_TRUE(IsRefused(run({"compare", list}), {"found the command 'compare', expected one of"}));
  EXPECT_TRUE(IsRefused(run({"calibrate"}), {"calibrate: no command of it was given"}));
  EXPECT_TRUE(IsRefused(run({"check"}), {"no list was given"}));
  EXPECT_TRUE(IsRefused(run({"check", list, "another"}), {"found another behind the list"}));
  EXPECT_TRUE(IsRefused(RunProgram({"batch", "check", list, "-o", Out(), "--", "--resume"}),
                        {"found --resume for the items"}));
}

TEST_F(BatchList, NamesItemsByAsMuchOfThePathAsTellsThemApart) {
  Run("\"monday/take 1.csv\"\nmonday/'take 2'\ntuesday/take\\ 2\nx name=y\n");
  for (const char* name : {"take_1", "monday-take_2", "tuesday-take_2", "y"}) {
    EXPECT_EQ(RowOf(folder_ / "out", name)["status"], "failed") << name;
  }
  EXPECT_EQ(RowOf(folder_ / "out", "take_1").at("input"), (folder_ / "monday/take 1.csv").string());
}

TEST_F(BatchList, GivesAnItemItsOwnOptions) {
  Run(Sample(0) + " name=plain --no-pictures\n" + Sample(0) + " name=wrong --nonsense\n");
  EXPECT_EQ(RowOf(folder_ / "out", "plain").at("status"), "ok");
  EXPECT_THAT(RowOf(folder_ / "out", "wrong").at("message"), testing::HasSubstr("--nonsense"));
}

/// A value that names a file beside the list is that file.
TEST_F(BatchList, FindsFilesOfOptionsBesideIt) {
  folder_.Write("lists/own.yaml", "no: calibration\n");
  const std::string list = folder_.Write("lists/list.txt", Sample(0) + " --calibration own.yaml\n");
  RunProgram({"batch", "check", list, "-o", Out()});
  EXPECT_THAT(RowOf(folder_ / "out", "sample_0").at("message"),
              testing::HasSubstr((folder_ / "lists/own.yaml").string()));
}

}  // namespace
}  // namespace flextip::batch_test
