#include "batch/records.h"

#include <gmock/gmock.h>

#include <fstream>

#include "core/error.h"
#include "tests/batch/work_of_tests.h"

namespace flextip::batch {
namespace {

using testing::HasSubstr;

std::vector<Ended> EndOf(const std::string& name, int exit_code) {
  Ended ended;
  ended.outcome.name = name;
  ended.outcome.exit_code = exit_code;
  ended.outcome.payload = "of " + name + "\n";
  return {ended};
}

TEST(BatchRecords, AreThereAfterAnInterruption) {
  const BatchTestFolder folder;
  Records(folder / "records").Add(EndOf("a", 3));
  const Records again(folder / "records");
  ASSERT_NE(again.Find("a"), nullptr);
  EXPECT_EQ(again.Find("a")->exit_code, 3);
  EXPECT_EQ(again.Find("a")->payload, "of a\n");
  EXPECT_EQ(again.Find("b"), nullptr);
}

TEST(BatchRecords, DoATornOneAgain) {
  const BatchTestFolder folder;
  Records first(folder / "records");
  first.Add(EndOf("a", 0));
  first.Add(EndOf("b", 0));
  const auto size = std::filesystem::file_size(folder / "records");
  const std::size_t one = size / 2;
  for (std::size_t cut = one; cut < size; ++cut) {  // wherever in b's line the writer was killed
    Records(folder / "records").Add({});
    std::filesystem::resize_file(folder / "records", cut);
    Records torn(folder / "records");
    EXPECT_NE(torn.Find("a"), nullptr);
    EXPECT_EQ(torn.Find("b"), nullptr);
    torn.Add(EndOf("b", 0));
    EXPECT_EQ(std::filesystem::file_size(folder / "records"), size);
  }
}

TEST(BatchRecords, CanBeForgotten) {
  const BatchTestFolder folder;
  Records records(folder / "records");
  for (const char* name : {"a", "b", "c"}) records.Add(EndOf(name, 0));
  records.Forget({"b"});
  EXPECT_EQ(records.Find("b"), nullptr);
  records.Add(EndOf("b", 1));
  const Records again(folder / "records");
  EXPECT_EQ(again.size(), 3U);
  EXPECT_EQ(again.Find("b")->exit_code, 1);
}

TEST(BatchRecords, RefuseADamagedFileWithItsLine) {
  const BatchTestFolder folder;
  Records(folder / "records").Add(EndOf("a", 0));
  std::ofstream(folder / "records", std::ios::app) << "no record\n";
  try {
    Records records(folder / "records");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("records:2: found 1 fields"));
  }
}

TEST(BatchRecords, RefuseASecondRecordOfAnItem) {
  const BatchTestFolder folder;
  Records records(folder / "records");
  records.Add(EndOf("a", 0));
  records.Add(EndOf("a", 0));
  try {
    Records again(folder / "records");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("records:2: found a second record of 'a'"));
  }
}

TEST(BatchFolderLock, LetsOneProgramIn) {
  const BatchTestFolder folder;
  {
    const FolderLock lock(folder / "lock", 0.0);
    EXPECT_THROW(FolderLock(folder / "lock", 0.05), InputError);
  }
  FolderLock(folder / "lock", 0.0);
}

}  // namespace
}  // namespace flextip::batch
