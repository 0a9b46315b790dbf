// Pictures with tags of another size or family than stated, and pictures that stand still.
#include <gmock/gmock.h>

#include <filesystem>

#include "plausibility/check_recording.h"
#include "plausibility/pictures/check_pictures.h"
#include "recording/frames/frame_source.h"
#include "recording/recording_reader.h"

namespace flextip {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::filesystem::path Folder() {
  return std::filesystem::path(FLEXTIP_SOURCE_DIR) / "testdata/recordings/rendered";
}

Recording Rendered() { return ReadRecording(Folder()).recording; }

std::vector<std::string> Found(const Recording& recording, FrameSource& frames) {
  plausibility::CheckResult result;
  plausibility::CheckPictures(recording, frames, {}, {.pictures = 4}, result);
  std::vector<std::string> ids;
  for (const auto& f : result.findings) ids.push_back(f.id);
  return ids;
}

std::vector<std::string> Found(const Recording& recording) {
  const auto frames = OpenRecordedFrames(Folder(), "cam0", *recording.cam0);
  return Found(recording, *frames);
}

/// The first picture again and again, at the times of all.
class StandingFrames : public FrameSource {
 public:
  explicit StandingFrames(const Recording& recording)
      : source_(OpenRecordedFrames(Folder(), "cam0", *recording.cam0)) {
    first_ = *source_->Next();
    times_ = recording.cam0->filenames;
  }
  std::size_t Count() const override { return times_.size(); }
  std::optional<Frame> Next() override {
    if (next_ >= times_.size()) return {};
    return Frame{times_[next_++].t_ns, first_.image};
  }
  void Skip(std::size_t frames) override { next_ += frames; }

 private:
  std::unique_ptr<FrameSource> source_;
  Frame first_;
  Series<std::string> times_;
  std::size_t next_ = 0;
};

TEST(Pictures, OfAHealthyRecordingAreFine) { EXPECT_THAT(Found(Rendered()), IsEmpty()); }

TEST(Pictures, ShowTheTagsSize) {
  for (const double factor : {1.2, 0.8}) {
    Recording recording = Rendered();
    for (CollarTag& tag : recording.tags0->tags) tag.size_m *= factor;
    EXPECT_THAT(Found(recording), ElementsAre("tags0.size")) << factor;
  }
}

TEST(Pictures, ShowThatTheWholeCollarIsLarger) {
  for (const double factor : {2.2, 0.4}) {
    Recording recording = Rendered();
    for (CollarTag& tag : recording.tags0->tags) tag.size_m *= factor, tag.T_EG.p *= factor;
    EXPECT_THAT(Found(recording), ElementsAre("tags0.scale")) << factor;
  }
}

TEST(Pictures, ShowTheTagsFamily) {
  for (const char* family : {"tag25h9", "tagStandard41h12"}) {
    Recording recording = Rendered();
    recording.tags0->family = family;
    EXPECT_THAT(Found(recording), ElementsAre("tags0.family")) << family;
  }
}

TEST(Pictures, ShowOtherIds) {
  Recording recording = Rendered();
  for (CollarTag& tag : recording.tags0->tags) tag.id += 100;
  EXPECT_THAT(Found(recording), ElementsAre("tags0.ids"));
}

TEST(Pictures, ThatStandStillAreFound) {
  const Recording recording = Rendered();
  StandingFrames frames(recording);
  EXPECT_THAT(Found(recording, frames), ElementsAre("cam0.frozen"));
}

TEST(Pictures, HaveTheWristsClock) {
  Recording recording = Rendered();
  for (auto& frame : recording.cam0->filenames) frame.t_ns -= recording.wrist0->samples[0].t_ns;
  const auto result = plausibility::CheckRecording(recording);
  ASSERT_EQ(result.findings.size(), 1U);
  EXPECT_EQ(result.findings[0].id, "cam0.clock");
}

}  // namespace
}  // namespace flextip
