// The tip in pictures: of a recording, of files, or a picture at a time.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "core/error.h"
#include "pipeline/instrument_tracker.h"
#include "pipeline/judge_track.h"
#include "python/bindings/arrays.h"
#include "python/bindings/bindings.h"
#include "python/bindings/long_call.h"
#include "recording/frames/frames.h"
#include "recording/frames/track_input.h"

namespace flextip::python {
namespace {

/// What flextip track writes, as an object.
struct Track {
  Series<TipTrack> frames;
  VisionStream vision0;
  TrackTotals totals;
  Judgement judgement;
  std::vector<std::string> warnings;
};

/// The arguments of track() that say what is tracked, and how.
struct TrackRequest {
  std::filesystem::path source;
  std::optional<std::filesystem::path> camera, collar, truth;
  std::optional<double> rate_hz;
  Paths calibrations;
  std::optional<std::pair<double, double>> black_white;
  std::optional<std::string> outline;
  std::optional<double> diameter_m;
  TrackerOptions tracker;
  bool with_model = true;
  std::optional<long> max_frames;

  bool IsRecording() const { return !camera && !collar; }
};

TrackInput OpenSource(const TrackRequest& what) {
  TrackInputOptions how;
  how.calibrations = what.calibrations;
  if (what.black_white) {
    if (!(what.black_white->first < what.black_white->second)) {
      throw InputError(fmt::format("black_white: found {}, {}, expected the first below the second",
                                   what.black_white->first, what.black_white->second));
    }
    how.range = {what.black_white->first, what.black_white->second};
  }
  if (what.IsRecording()) {
    if (what.rate_hz) throw InputError("rate_hz: a recording has its own times, expected None");
    return OpenRecordingToTrack(what.source, how);
  }
  if (!what.camera || !what.collar) {
    throw InputError::At(what.source.string(), 0, "expected both camera and collar, or neither");
  }
  CameraFiles files{.camera = *what.camera, .collar = *what.collar};
  if (what.rate_hz) files.rate_hz = Positive("rate_hz", *what.rate_hz);
  return OpenPicturesToTrack(what.source, files, how);
}

std::optional<TubeShape> ShaftSeenIn(const TrackRequest& what, const TrackInput& input) {
  if (!what.outline) return {};
  if (*what.outline != "round" && *what.outline != "flat") {
    throw InputError("outline: found " + *what.outline + ", expected round or flat");
  }
  const double diameter_m = what.diameter_m.value_or(input.recording.instrument.outer_diameter_m);
  return TubeOf(*input.recording.tags0, Positive("diameter_m", diameter_m),
                *what.outline == "round");
}

VisionStream VisionOf(const Series<TipTrack>& frames, const TrackInput& input,
                      double direction_noise_rad) {
  VisionStream stream;
  stream.rate_hz = input.recording.cam0->calibration.rate_hz;
  stream.comment =
      input.recording.cam0->has_T_RC ? "tip by tags" : "tip by tags, in the camera's frame";
  stream.direction_noise_rad = direction_noise_rad;
  for (const auto& frame : frames) stream.tips.push_back({frame.t_ns, frame.value.tip});
  return stream;
}

/// The stages of the command track, in its order.
Track TrackWhole(const TrackRequest& what) {
  SilenceVideoCodecs();
  TrackInput input = OpenSource(what);
  TrackerOptions options = what.tracker;
  options.tube = ShaftSeenIn(what, input);
  std::optional<Series<Eigen::Vector3d>> truth;
  if (what.IsRecording() || what.truth) {
    truth = ReadTipTruth(what.source, what.truth.value_or(std::filesystem::path()));
  }
  const Pose& T_RC = input.recording.cam0->calibration.T_RC;
  InstrumentTracker tracker(TrackerSetupOf(input.recording, options, what.with_model));
  Interruption interruption;
  Track track;
  TrackSums sums;
  while (!what.max_frames || sums.frames < *what.max_frames) {
    interruption.Check();
    const std::optional<FrameSet> set = input.frames->Next();
    if (!set) break;
    const TipTrack frame =
        tracker.Follow(set->Pointers(), set->t_ns, ReadingsAt(input.recording, set->t_ns));
    sums.Add(frame);
    const auto p_RE = truth ? ValueAt(*truth, set->t_ns) : std::nullopt;
    if (p_RE) sums.Score(frame, *p_RE, T_RC);
    track.frames.push_back({set->t_ns, frame});
  }
  if (track.frames.empty()) {
    throw InputError::At(what.source.string(), 0, "no frame can be read");
  }
  track.totals = sums.Totals(input.recording.tags0->family, input.recording.cam0->has_T_RC,
                             input.recording.wrist0.has_value());
  track.judgement = JudgeTrack(track.totals);
  track.vision0 = VisionOf(track.frames, input, sums.DirectionNoise_rad());
  track.warnings = std::move(input.warnings);
  return track;
}

const char* SourceName(const TipTrack& track) {
  const bool ok = track.tip.status == TipStatus::kOk;
  if (ok && track.source == TrackSource::kPixels) return "pixels";
  if (ok && track.source == TrackSource::kCorners) return "corners";
  const bool predicted = track.tip.status == TipStatus::kPredicted;
  return predicted && track.outline_used ? "outline" : "none";
}

template <class Part>
auto IfTip(TipStatus least, Part part) {
  return [least, part](const TipTrack& t) {
    using Value = std::decay_t<decltype(part(t))>;
    const bool there =
        t.tip.status == TipStatus::kOk || (least == TipStatus::kPredicted && t.tip.status == least);
    return there ? std::optional<Value>(part(t)) : std::nullopt;
  };
}

void AddTipTrack(py::module_& module) {
  py::class_<TagDetection>(module, "Tag", "A tag in a picture.")
      .def_readonly("id", &TagDetection::id, "Number in its family.")
      .def_property_readonly(
          "corners_px",
          [](const TagDetection& tag) {
            return Table(tag.corners_px, {2},
                         [](const Eigen::Vector2d& c, double* row) { Put(c, row); });
          },
          "Bottom left, bottom right, top right, top left of the upright tag, (4, 2), px; (0, 0) "
          "is "
          "the centre of the top-left pixel.")
      .def_readonly("decision_margin", &TagDetection::decision_margin,
                    "Mean distance of a bit's grey value from the threshold.")
      .def_readonly("hamming", &TagDetection::hamming, "Corrected bits.");
  constexpr TipStatus kSeen = TipStatus::kOk, kKnown = TipStatus::kPredicted;
  py::class_<TipTrack>(module, "TipTrack", "The tip in a picture, in R.")
      .def_property_readonly(
          "status", [](const TipTrack& t) { return Name(t.tip.status); },
          "\"ok\" (measured), \"predicted\" or \"lost\".")
      .def_property_readonly("source", &SourceName,
                             "\"pixels\" (fitted to the picture), \"corners\" (of the tags), "
                             "\"outline\" (predicted by the outline) or \"none\".")
      .def_property_readonly("p_RE", IfTip(kKnown, [](const TipTrack& t) { return t.tip.p_RE; }),
                             "Tip, (3,), m; None where it is lost.")
      .def_property_readonly("covariance_m2",
                             IfTip(kKnown, [](const TipTrack& t) { return t.tip.covariance_m2; }),
                             "Covariance of p_RE, (3, 3), m2; None where it is lost.")
      .def_property_readonly(
          "d_RE", [](const TipTrack& t) { return std::optional(t.tip.d_RE); },
          "The shaft's direction, unit, (3,); None where it was not seen.")
      .def_property_readonly("T_RE",
                             IfTip(kSeen, [](const TipTrack& t) { return t.T_RE.Matrix(); }),
                             "Pose of the tip frame E, (4, 4), m; None where it is not ok.")
      .def_property_readonly("covariance",
                             IfTip(kSeen, [](const TipTrack& t) { return t.covariance; }),
                             "Covariance of T_RE as a small turn and shift (dw, dp) in R: the true "
                             "pose is (exp([dw]x) R, p + dp), (6, 6); None where it is not ok.")
      .def_property_readonly(
          "direction_noise_rad",
          IfTip(kSeen, [](const TipTrack& t) { return t.direction_noise_rad; }),
          "Standard deviation of d_RE per axis across it (rad); None where it is not ok.")
      .def_readonly("tags", &TipTrack::tags, "Tags in the first camera.")
      .def_readonly("tags_used", &TipTrack::tags_used, "Tags used, in all cameras.")
      .def_readonly("ambiguous", &TipTrack::ambiguous, "Another pose fits nearly as well.");
}

void AddOptions(py::module_& module) {
  const auto make = [](double quad_decimate, int threads, bool photometric_fit,
                       bool background_detection, int max_predicted_frames) {
    TrackerOptions options;
    options.detector.quad_decimate = quad_decimate;
    options.detector.threads = threads;
    options.photometric_fit = photometric_fit;
    options.background_detection = background_detection;
    options.max_predicted_frames = max_predicted_frames;
    return options;
  };
  const TrackerOptions usual;
  py::class_<TrackerOptions>(module, "TrackerOptions", "How tags and tip are looked for.")
      .def(py::init(make), py::kw_only(), py::arg("quad_decimate") = usual.detector.quad_decimate,
           py::arg("threads") = usual.detector.threads,
           py::arg("photometric_fit") = usual.photometric_fit,
           py::arg("background_detection") = usual.background_detection,
           py::arg("max_predicted_frames") = usual.max_predicted_frames)
      .def_property_readonly(
          "quad_decimate", [](const TrackerOptions& o) { return o.detector.quad_decimate; },
          "Tags are searched at 1/this of the resolution: faster, misses small ones.")
      .def_property_readonly(
          "threads", [](const TrackerOptions& o) { return o.detector.threads; },
          "Threads of the search.")
      .def_readonly("photometric_fit", &TrackerOptions::photometric_fit,
                    "False: the tags' corners alone.")
      .def_readonly("background_detection", &TrackerOptions::background_detection,
                    "A thread looks for a lost tip, for live pictures; its result comes some "
                    "frames later.")
      .def_readonly("max_predicted_frames", &TrackerOptions::max_predicted_frames,
                    "Then the tip is lost, unless the shaft's model carries it on.");
}

void AddTrackClass(py::module_& module) {
  const auto known = [](const TipTrack& t) { return t.tip.status != TipStatus::kLost; };
  py::class_<Track>(module, "Track",
                    "The tip in every frame, in R. Rows whose status is \"lost\" are zeros.")
      .def("__len__", [](const Track& t) { return t.frames.size(); })
      .def("__repr__",
           [](const Track& t) {
             return fmt::format("<Track of {} frames, {}: {}>", t.frames.size(),
                                Name(t.judgement.grade), t.judgement.says);
           })
      .def(
          "__getitem__",
          [](const Track& t, py::ssize_t i) {
            const auto n = static_cast<py::ssize_t>(t.frames.size());
            if (i < -n || i >= n) throw py::index_error("Track index out of range");
            return TipTrack(t.frames[static_cast<std::size_t>(i < 0 ? i + n : i)].value);
          },
          py::arg("index"), "Returns a frame.")
      .def_property_readonly(
          "t_ns", [](const Track& t) { return Times(t.frames); }, "Times, (N,) int64, ns.")
      .def_property_readonly(
          "status",
          [](const Track& t) {
            return TextColumn(t.frames, [](const auto& f) { return Name(f.value.tip.status); });
          },
          "\"ok\" (measured), \"predicted\" or \"lost\", (N,).")
      .def_property_readonly(
          "source",
          [](const Track& t) {
            return TextColumn(t.frames, [](const auto& f) { return SourceName(f.value); });
          },
          "\"pixels\", \"corners\", \"outline\" or \"none\", (N,).")
      .def_property_readonly(
          "p_RE",
          [known](const Track& t) {
            return Table(t.frames, {3}, [known](const auto& f, double* row) {
              if (known(f.value)) Put(f.value.tip.p_RE, row);
            });
          },
          "Tip, (N, 3), m.")
      .def_property_readonly(
          "covariance_m2",
          [known](const Track& t) {
            return Table(t.frames, {3, 3}, [known](const auto& f, double* row) {
              if (known(f.value)) Put(f.value.tip.covariance_m2, row);
            });
          },
          "Covariance of p_RE, (N, 3, 3), m2.")
      .def_property_readonly(
          "tags_used",
          [](const Track& t) {
            return Column<TimeNs>(t.frames, [](const auto& f) {
              const bool ok = f.value.tip.status == TipStatus::kOk;
              return TimeNs(ok ? f.value.tags_used : 0);
            });
          },
          "Tags used, in all cameras, (N,) int64; 0 where it is not ok.")
      .def_readonly("vision0", &Track::vision0, "The same tips as a stream for a Recording.")
      .def_readonly("totals", &Track::totals, "What the frames say together.")
      .def_readonly("judgement", &Track::judgement, "Whether the tip was tracked.")
      .def_readonly("warnings", &Track::warnings, "What had to be skipped, one line each.");
}

void AddTrackTotals(py::module_& module) {
  const auto scored = [](double (TipScore::*get)() const) {
    return [get](const TrackTotals& t) {
      return t.score.frames > 0 ? std::optional((t.score.*get)()) : std::nullopt;
    };
  };
  py::class_<TrackTotals>(module, "TrackTotals", "What the frames say together.")
      .def_readonly("frames", &TrackTotals::frames, "Frames.")
      .def_readonly("ok", &TrackTotals::ok, "Of those, with the tip measured.")
      .def_readonly("predicted", &TrackTotals::predicted, "With the tip predicted.")
      .def_readonly("lost", &TrackTotals::lost, "With the tip lost.")
      .def_readonly("tags", &TrackTotals::tags, "Tags seen in the first camera.")
      .def_readonly("rms_px", &TrackTotals::rms_px,
                    "RMS distance of the corners from the fit; 0 where pixels were fitted.")
      .def_property_readonly("tip_rms_error_m", scored(&TipScore::RmsError),
                             "RMS error of the ok tips (m); None without a truth.")
      .def_property_readonly(
          "tip_mean_nees", scored(&TipScore::MeanNees),
          "Their mean squared error over its covariance, 3 where that is honest; "
          "None without a truth.");
}

}  // namespace

void AddTrack(py::module_& module) {
  AddTipTrack(module);
  AddOptions(module);
  AddTrackTotals(module);
  AddTrackClass(module);
  using Path = std::filesystem::path;
  const auto track = [](const Path& source, const std::optional<Path>& camera,
                        const std::optional<Path>& collar, std::optional<double> rate_hz,
                        const Paths& calibrations,
                        std::optional<std::pair<double, double>> black_white,
                        const TrackerOptions& options, bool with_model,
                        const std::optional<std::string>& outline, std::optional<double> diameter_m,
                        std::optional<long> max_frames, const std::optional<Path>& truth) {
    const TrackRequest what{source,      camera,  collar,     truth,   rate_hz,    calibrations,
                            black_white, outline, diameter_m, options, with_model, max_frames};
    return WithoutGil([&] { return TrackWhole(what); });
  };
  module.def("track", track, py::arg("source"), py::kw_only(), py::arg("camera") = std::nullopt,
             py::arg("collar") = std::nullopt, py::arg("rate_hz") = std::nullopt,
             py::arg("calibrations") = Paths(), py::arg("black_white") = std::nullopt,
             py::arg_v("options", TrackerOptions(), "TrackerOptions()"),
             py::arg("with_model") = true, py::arg("outline") = std::nullopt,
             py::arg("diameter_m") = std::nullopt, py::arg("max_frames") = std::nullopt,
             py::arg("truth") = std::nullopt,
             R"doc(Finds the tip in the frames of a recording, of pictures or of a video.

source: a recording's folder; or, with camera and collar (files), a folder of pictures or a video.
rate_hz: of pictures or a video; None: names in nanoseconds, or the video's rate.
calibrations: calibration.yaml files. black_white: values of 16-bit pictures that become 0 and 255.
with_model: expect the tip by wrist and shaft. outline: "round" or "flat", the form of the shaft's
end, carries a tip on whose tags are covered; diameter_m: of the shaft as it is seen.
max_frames: end after so many. truth: CSV with timestamp [ns], x, y, z to score against.

A frame without the tip is a status. Raises InputError.)doc");
}

}  // namespace flextip::python
