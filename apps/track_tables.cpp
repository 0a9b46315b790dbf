#include "apps/track_tables.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "recording/sensor_streams.h"
#include "recording/series_file.h"
#include "recording/text.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kSaveEvery = std::chrono::milliseconds(500);

const std::vector<std::string> kTagColumns = {
    "id []",     "c0_x [px]", "c0_y [px]", "c1_x [px]",          "c1_y [px]", "c2_x [px]",
    "c2_y [px]", "c3_x [px]", "c3_y [px]", "decision_margin []", "hamming []"};

void AddTags(CsvWriter& csv, TimeNs t_ns, const std::vector<TagDetection>& tags) {
  for (const TagDetection& tag : tags) {
    csv.Add(t_ns).Add(static_cast<TimeNs>(tag.id));
    for (const Eigen::Vector2d& c : tag.corners_px) csv.Add(c.x()).Add(c.y());
    csv.Add(tag.decision_margin).Add(static_cast<TimeNs>(tag.hamming));
    csv.EndRow();
  }
}

nlohmann::json ToJson(const TrackSums& s) {
  return {{"frames", s.frames},
          {"ok", s.ok},
          {"predicted", s.predicted},
          {"lost", s.lost},
          {"tags", s.tags},
          {"squared_direction_noise", s.squared_direction_noise},
          {"squared_rms_px", s.squared_rms_px},
          {"seconds", s.seconds},
          {"score",
           {s.score.frames, s.score.squared_m2, s.score.squared_depth_m2, s.score.max_error_m,
            s.score.nees}}};
}

TrackSums FromJson(const nlohmann::json& j) {
  TrackSums s;
  j.at("frames").get_to(s.frames);
  j.at("ok").get_to(s.ok);
  j.at("predicted").get_to(s.predicted);
  j.at("lost").get_to(s.lost);
  j.at("tags").get_to(s.tags);
  j.at("squared_direction_noise").get_to(s.squared_direction_noise);
  j.at("squared_rms_px").get_to(s.squared_rms_px);
  j.at("seconds").get_to(s.seconds);
  const auto& score = j.at("score");
  score.at(0).get_to(s.score.frames);
  score.at(1).get_to(s.score.squared_m2);
  score.at(2).get_to(s.score.squared_depth_m2);
  score.at(3).get_to(s.score.max_error_m);
  score.at(4).get_to(s.score.nees);
  return s;
}

void Open(std::ofstream& stream, const fs::path& file) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  stream.open(file, std::ios::binary | std::ios::app);
  if (!stream) throw WorkError(fmt::format("{}: cannot be written", file.string()));
}

}  // namespace

TrackTables::TrackTables(const fs::path& folder, const std::string& input, bool resume)
    : folder_(folder),
      mark_(folder / "unfinished.json"),
      input_(input),
      vision_rows_(TimedColumns(VisionColumns())),
      tag_rows_(TimedColumns(kTagColumns)) {
  if (resume && fs::exists(mark_)) Resume();
  if (sums.frames == 0) {
    std::error_code ignored;
    fs::remove(folder / "vision0/data.csv", ignored);
    fs::remove(folder / "tags0/data.csv", ignored);
  }
  Open(vision_, folder / "vision0/data.csv");
  Open(tags_, folder / "tags0/data.csv");
}

// What was written after the mark is cut off: the frames are tracked again.
void TrackTables::Resume() {
  nlohmann::json mark;
  try {
    mark = nlohmann::json::parse(ReadTextFile(mark_));
    if (mark.at("input") != input_) {
      throw InputError::At(mark_.string(), 0,
                           fmt::format("the interrupted run was of {}, not of {}",
                                       mark.at("input").get<std::string>(), input_));
    }
    sums = FromJson(mark.at("sums"));
    fs::resize_file(folder_ / "vision0/data.csv", mark.at("vision_bytes").get<std::uintmax_t>());
    fs::resize_file(folder_ / "tags0/data.csv", mark.at("tag_bytes").get<std::uintmax_t>());
  } catch (const nlohmann::json::exception& error) {
    throw InputError::At(mark_.string(), 0, fmt::format("damaged: {}", error.what()));
  } catch (const fs::filesystem_error& error) {
    throw InputError::At(error.path1().string(), 0, error.code().message());
  }
  (void)vision_rows_.TakeText();  // the headers are there
  (void)tag_rows_.TakeText();
}

void TrackTables::Add(TimeNs t_ns, const TipTrack& track) {
  AddVisionRow(vision_rows_, {t_ns, track.tip});
  AddTags(tag_rows_, t_ns, track.tags);
  ++sums.frames;
  sums.tags += static_cast<long>(track.tags.size());
  sums.ok += track.tip.status == TipStatus::kOk;
  sums.predicted += track.tip.status == TipStatus::kPredicted;
  sums.lost += track.tip.status == TipStatus::kLost;
  if (track.tip.status == TipStatus::kOk) {
    sums.squared_direction_noise += track.direction_noise_rad * track.direction_noise_rad;
    sums.squared_rms_px += track.rms_px * track.rms_px;
  }
}

void TrackTables::Save() {
  vision_ << vision_rows_.TakeText() << std::flush;
  tags_ << tag_rows_.TakeText() << std::flush;
  if (!vision_ || !tags_) {
    throw WorkError(fmt::format("{}: the tables cannot be written", folder_.string()));
  }
  const nlohmann::json mark = {{"input", input_},
                               {"vision_bytes", static_cast<long>(vision_.tellp())},
                               {"tag_bytes", static_cast<long>(tags_.tellp())},
                               {"sums", ToJson(sums)}};
  fs::path fresh = mark_;
  fresh += ".new";
  WriteTextFile(fresh, mark.dump());
  fs::rename(fresh, mark_);  // at once: the mark is whole at any time
  saved_ = Clock::now();
}

void TrackTables::SaveWhenDue() {
  if (Clock::now() - saved_ >= kSaveEvery) Save();
}

void TrackTables::Finish(const TagCollar& collar, double rate_hz) {
  Save();
  VisionStream stream;
  stream.rate_hz = rate_hz;
  stream.comment = "tip by tags";
  stream.direction_noise_rad =
      std::sqrt(sums.squared_direction_noise / static_cast<double>(std::max(1L, sums.ok)));
  WriteVisionSettings(folder_ / "vision0", stream);
  WriteTags(folder_ / "tags0", collar);
  std::error_code ignored;
  fs::remove(mark_, ignored);
}

}  // namespace flextip
