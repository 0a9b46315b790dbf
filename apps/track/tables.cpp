#include "apps/track/tables.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "recording/streams/sensor_streams.h"
#include "recording/streams/series_file.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

constexpr long kSaveEvery = 10;

const std::vector<std::string> kTagColumns = {
    "id []",     "c0_x [px]", "c0_y [px]", "c1_x [px]",          "c1_y [px]", "c2_x [px]",
    "c2_y [px]", "c3_x [px]", "c3_y [px]", "decision_margin []", "hamming []"};

const std::vector<std::string> kFrameColumns = {"status []",   "source []",     "tags_used []",
                                                "rms_px [px]", "noise_grey []", "sd_position [m]",
                                                "error [m]",   "doubt []"};

void AddTags(CsvWriter& csv, TimeNs t_ns, const std::vector<TagDetection>& tags) {
  for (const TagDetection& tag : tags) {
    csv.Add(t_ns).Add(static_cast<TimeNs>(tag.id));
    for (const Eigen::Vector2d& c : tag.corners_px) csv.Add(c.x()).Add(c.y());
    csv.Add(tag.decision_margin).Add(static_cast<TimeNs>(tag.hamming));
    csv.EndRow();
  }
}

nlohmann::json ToJson(const TipScore& s) {
  return {s.frames, s.inside, s.squared_m2, s.squared_depth_m2, s.max_error_m, s.nees};
}

TipScore ScoreFromJson(const nlohmann::json& j) {
  return {j.at(0), j.at(1), j.at(2), j.at(3), j.at(4), j.at(5)};
}

nlohmann::json ToJson(const TrackSums& s) {
  return {{"frames", s.frames},
          {"ok", s.ok},
          {"predicted", s.predicted},
          {"lost", s.lost},
          {"tags", s.tags},
          {"by_pixels", s.by_pixels},
          {"by_corners", s.by_corners},
          {"squared_direction_noise", s.squared_direction_noise},
          {"squared_rms_px", s.squared_rms_px},
          {"squared_noise_grey", s.squared_noise_grey},
          {"seconds", s.seconds},
          {"not_by_wrist", s.not_by_wrist},
          {"not_by_collar", s.not_by_collar},
          {"stood_still", s.stood_still},
          {"from_wrist_m", s.from_wrist_m},
          {"miss_m", {s.miss_m.x(), s.miss_m.y(), s.miss_m.z()}},
          {"score", ToJson(s.score)},
          {"score_predicted", ToJson(s.score_predicted)}};
}

TrackSums SumsFromJson(const nlohmann::json& j) {
  return {
      .frames = j.at("frames"),
      .ok = j.at("ok"),
      .predicted = j.at("predicted"),
      .lost = j.at("lost"),
      .tags = j.at("tags"),
      .by_pixels = j.at("by_pixels"),
      .by_corners = j.at("by_corners"),
      .squared_direction_noise = j.at("squared_direction_noise"),
      .squared_rms_px = j.at("squared_rms_px"),
      .squared_noise_grey = j.at("squared_noise_grey"),
      .seconds = j.at("seconds"),
      .score = ScoreFromJson(j.at("score")),
      .score_predicted = ScoreFromJson(j.at("score_predicted")),
      .not_by_wrist = j.at("not_by_wrist"),
      .not_by_collar = j.at("not_by_collar"),
      .stood_still = j.at("stood_still"),
      .from_wrist_m = j.at("from_wrist_m"),
      .miss_m = Eigen::Vector3d(j.at("miss_m").at(0), j.at("miss_m").at(1), j.at("miss_m").at(2))};
}

const char* Name(TrackSource source) {
  switch (source) {
    case TrackSource::kNone:
      return "none";
    case TrackSource::kCorners:
      return "corners";
    case TrackSource::kPixels:
      return "pixels";
  }
  return "";
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
      vision_{"vision0/data.csv", CsvWriter(TimedColumns(VisionColumns()))},
      tags_{"tags0/data.csv", CsvWriter(TimedColumns(kTagColumns))},
      frames_{"frames.csv", CsvWriter(TimedColumns(kFrameColumns))} {
  if (resume && fs::exists(mark_)) Resume();
  for (GrowingTable* table : {&vision_, &tags_, &frames_}) {
    std::error_code ignored;
    if (sums.frames == 0) fs::remove(folder / table->name, ignored);
    Open(table->stream, folder / table->name);
  }
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
    sums = SumsFromJson(mark.at("sums"));
    state_ = mark.at("state");
    for (GrowingTable* table : {&vision_, &tags_, &frames_}) {
      const auto bytes = mark.at("bytes").at(table->name).get<std::uintmax_t>();
      fs::resize_file(folder_ / table->name, bytes);
      (void)table->rows.TakeText();  // the header is there
    }
  } catch (const nlohmann::json::exception&) {
    throw InputError::At(mark_.string(), 0,
                         "is damaged, so that the run cannot go on: start it without --resume");
  } catch (const fs::filesystem_error& error) {
    throw InputError::At(error.path1().string(), 0, error.code().message());
  }
}

void TrackTables::Add(TimeNs t_ns, const TipTrack& track,
                      const std::optional<Eigen::Vector3d>& p_RE, const Pose& T_RC) {
  AddVisionRow(vision_.rows, {t_ns, track.tip});
  AddTags(tags_.rows, t_ns, track.tags);
  AddFrame(t_ns, track, p_RE);
  sums.Add(track);
  if (p_RE) sums.Score(track, *p_RE, T_RC);
}

void TrackTables::AddFrame(TimeNs t_ns, const TipTrack& track,
                           const std::optional<Eigen::Vector3d>& p_RE) {
  const bool ok = track.tip.status == TipStatus::kOk;
  const bool known = track.tip.status != TipStatus::kLost;
  const TrackSource source = ok ? track.source : TrackSource::kNone;
  CsvWriter& row = frames_.rows;
  const auto add = [&](bool there, double value) {
    if (there) {
      row.Add(value);
    } else {
      row.AddEmpty();
    }
  };
  const bool by_outline = track.tip.status == TipStatus::kPredicted && track.outline_used;
  row.Add(t_ns).Add(std::string(flextip::Name(track.tip.status)));
  row.Add(std::string(by_outline ? "outline" : Name(source)));
  row.Add(static_cast<TimeNs>(ok ? track.tags_used : 0));
  add(source == TrackSource::kCorners, track.rms_px);
  add(source == TrackSource::kPixels, track.noise_grey);
  add(known, std::sqrt(track.tip.covariance_m2.trace()));
  add(known && p_RE, p_RE ? (track.tip.p_RE - *p_RE).norm() : 0.0);
  row.Add(std::string(flextip::Name(track.doubt)));
  row.EndRow();
}

bool TrackTables::IsSaveDue() const { return sums.frames % kSaveEvery == 0; }

void TrackTables::Save(const std::string& state) {
  nlohmann::json bytes;
  for (GrowingTable* table : {&vision_, &tags_, &frames_}) {
    table->stream << table->rows.TakeText() << std::flush;
    if (!table->stream) {
      throw WorkError(fmt::format("{}: the tables cannot be written", folder_.string()));
    }
    bytes[table->name] = static_cast<long>(table->stream.tellp());
  }
  const nlohmann::json mark = {
      {"input", input_}, {"bytes", bytes}, {"sums", ToJson(sums)}, {"state", state}};
  fs::path fresh = mark_;
  fresh += ".new";
  WriteTextFile(fresh, mark.dump());
  fs::rename(fresh, mark_);  // at once: the mark is whole at any time
}

void TrackTables::Finish(const TagCollar& collar, double rate_hz, bool camera_has_pose) {
  Save("");
  VisionStream stream;
  stream.rate_hz = rate_hz;
  stream.comment = camera_has_pose ? "tip by tags" : "tip by tags, in the camera's frame";
  stream.direction_noise_rad = sums.DirectionNoise_rad();
  WriteVisionSettings(folder_ / "vision0", stream);
  WriteTags(folder_ / "tags0", collar);
  std::error_code ignored;
  fs::remove(mark_, ignored);
}

}  // namespace flextip
