// Trajectories and tables as other programs read them.
#include "exports/text_files.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "core/error.h"
#include "recording/recording_reader.h"

namespace flextip::exports {
namespace {

namespace fs = std::filesystem;

class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / fmt::format("flextip-texts-{}", ::getpid())) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& Path() const { return path_; }

 private:
  fs::path path_;
};

const fs::path kSample = fs::path(FLEXTIP_SOURCE_DIR) / "testdata/recordings/sample_0";

TEST(Tum, HasEveryPoseOfTheRecording) {
  const Folder folder;
  const auto files = WriteTum(ReadTimedTables(kSample), folder.Path());
  const Recording recording = ReadRecording(kSample, {.check_frames = false}).recording;
  std::vector<std::string> names;
  for (const auto& file : files) names.push_back(file.file.filename());
  EXPECT_THAT(names, testing::IsSupersetOf({"em0.tum", "vision0.tum", "wrist0.tum"}));
  std::ifstream in(folder.Path() / "em0.tum");
  std::size_t i = 0;
  for (std::string line; std::getline(in, line); ++i) {
    std::istringstream words(line);
    std::string time;
    Eigen::Vector3d p;
    double x, y, z, w;
    words >> time >> p.x() >> p.y() >> p.z() >> x >> y >> z >> w;
    ASSERT_FALSE(words.fail()) << line;
    const auto& sample = recording.em0->samples.at(i);
    time.erase(time.find('.'), 1);
    EXPECT_EQ(std::stoll(time), sample.t_ns);
    EXPECT_EQ(p, sample.value.p_RS);
    EXPECT_NEAR(std::abs(Eigen::Quaterniond(w, x, y, z).dot(sample.value.q_RS)), 1.0, 1e-12);
  }
  EXPECT_EQ(i, recording.em0->samples.size());
}

TEST(PlainCsv, TurnsIntoTheAskedUnits) {
  const Folder folder;
  WritePlainCsv(ReadTimedTables(kSample), folder.Path(), {.millimetres = true});
  const Recording recording = ReadRecording(kSample, {.check_frames = false}).recording;
  std::ifstream in(folder.Path() / "wrist0.csv");
  std::string header, line;
  std::getline(in, header);
  EXPECT_THAT(header, testing::StartsWith("time_s,timestamp_ns,p_RW_x_mm,p_RW_y_mm,p_RW_z_mm"));
  EXPECT_THAT(header, testing::HasSubstr("q_RW_w"));
  std::getline(in, line);
  std::istringstream cells(line);
  std::string cell;
  for (int i = 0; i < 3; ++i) std::getline(cells, cell, ',');
  EXPECT_NEAR(std::stod(cell), 1e3 * recording.wrist0->samples.front().value.p_RW.x(), 1e-9);
}

// The tip's direction is the x axis of the orientation.
TEST(Tum, MakesOrientationsOfDirections) {
  for (const TimedTable& table : ReadTimedTables(kSample)) {
    if (table.name != "vision0") continue;
    const auto paths = TrajectoriesIn(table);
    ASSERT_EQ(paths.size(), 1u);
    EXPECT_TRUE(paths[0].has_turn);
    const Recording recording = ReadRecording(kSample, {.check_frames = false}).recording;
    std::size_t k = 0;
    for (const auto& tip : recording.vision0->tips) {
      if (tip.value.status == TipStatus::kLost) continue;
      const auto& pose = paths[0].poses.at(k++);
      EXPECT_EQ(pose.t_ns, tip.t_ns);
      if (tip.value.d_RE) {
        EXPECT_LT((pose.q * Eigen::Vector3d::UnitX() - *tip.value.d_RE).norm(), 1e-6);
      }
    }
    return;
  }
  FAIL() << "no vision0";
}

TEST(PlainCsv, HasHeadersThatAreWords) {
  EXPECT_EQ(PlainColumn("p_RW_x [m]"), "p_RW_x_m");
  EXPECT_EQ(PlainColumn("status []"), "status");
  EXPECT_EQ(PlainColumn("base.em0_position_m.0"), "base_em0_position_m_0");
  const Folder folder;
  WritePlainCsv(ReadTimedTables(kSample), folder.Path());
  std::ifstream in(folder.Path() / "wrist0.csv");
  std::string header, first;
  std::getline(in, header);
  std::getline(in, first);
  EXPECT_THAT(header, testing::StartsWith("time_s,timestamp_ns,p_RW_x_m,p_RW_y_m,p_RW_z_m,q_RW_w"));
  EXPECT_EQ(std::count(header.begin(), header.end(), ','),
            std::count(first.begin(), first.end(), ','));
}

// Their numbers pass as numbers; a length of 1e300 leaves nothing when it is divided by itself.
TEST(TimedTables, RowsWithoutARotationAreLeftOut) {
  const Folder folder;
  std::ofstream(folder.Path() / "a.csv")
      << "#timestamp [ns],p_RW_x [m],p_RW_y [m],p_RW_z [m],q_RW_w [],q_RW_x [],q_RW_y [],q_RW_z "
         "[]\n"
         "1,0,0,0,0,0,0,0\n2,0,0,0,1e300,1e300,1e300,1e300\n3,0,0,0,0.6,0.8,0,0\n";
  std::ofstream(folder.Path() / "b.csv")
      << "#timestamp [ns],p_RE_x [m],p_RE_y [m],p_RE_z [m],d_RE_x [],d_RE_y [],d_RE_z []\n"
         "1,0,0,0,0,1e300,0\n";
  const auto tables = ReadTimedTables(folder.Path());
  ASSERT_EQ(tables.size(), 2U);
  const auto turned = TrajectoriesIn(tables[0]).at(0).poses;
  ASSERT_EQ(turned.size(), 1U);
  EXPECT_EQ(turned[0].t_ns, 3);
  EXPECT_NEAR(turned[0].q.norm(), 1.0, 1e-12);
  const auto directed = TrajectoriesIn(tables[1]).at(0).poses;
  ASSERT_EQ(directed.size(), 1U);
  EXPECT_NEAR((directed[0].q * Eigen::Vector3d::UnitX()).y(), 1.0, 1e-9);
}

TEST(TimedTables, AreRefusedWhereThereAreNone) {
  const Folder folder;
  EXPECT_THROW(ReadTimedTables(folder.Path()), InputError);
  EXPECT_THROW(ReadTimedTables(folder.Path() / "none"), InputError);
  fs::create_directories(folder.Path() / "load0");
  std::ofstream(folder.Path() / "load0/data.csv") << "#timestamp [ns],f_x [N]\n1,2\n";
  EXPECT_EQ(ReadTimedTables(folder.Path()).size(), 1u);
  EXPECT_THROW(WriteTum(ReadTimedTables(folder.Path()), folder.Path()), InputError);
  std::ofstream(folder.Path() / "load0/data.csv") << "#timestamp [ns],f_x [N]\n1.5,2\n";
  EXPECT_THROW(ReadTimedTables(folder.Path()), InputError);
}

}  // namespace
}  // namespace flextip::exports
