#include "calibration/hand_eye/recorded_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "recording/frames/frame_source.h"
#include "vision/tags/collar_pose.h"
#include "vision/tags/detector.h"

namespace flextip {
namespace {

// The corners of the collar's tags, four a tag, of several sightings of one id the clearest.
BoardSighting SightingOfCollar(TagDetector& detector, const TagCollar& collar, const Image& image) {
  const auto tags = detector.Detect(image);
  BoardSighting seen;
  for (std::size_t i = 0; i < collar.tags.size(); ++i) {
    const TagDetection* best = nullptr;
    for (const TagDetection& tag : tags) {
      const bool of_collar = tag.id == collar.tags[i].id;
      if (of_collar && (!best || tag.decision_margin > best->decision_margin)) best = &tag;
    }
    if (!best) continue;
    const auto corners_E = CornersInE(collar.tags[i]);
    for (std::size_t k = 0; k < corners_E.size(); ++k) {
      seen.ids.push_back(static_cast<int>(4 * i + k));
      seen.x_B.push_back(corners_E[k]);
      seen.px.push_back(best->corners_px[k]);
    }
  }
  if (!seen.Found()) seen.reason = "no tag of the collar found";
  return seen;
}

// Pictures that did not tell a charuco board's layout, once another has.
void DetectAgain(const std::filesystem::path& folder, const CameraStream& camera, BoardSpec board,
                 const std::vector<std::size_t>& frames, std::vector<HandEyeView>& views) {
  const auto telling = std::find_if(views.begin(), views.end(), [](const HandEyeView& view) {
    return view.sighting.layout != CharucoLayout::kUnknown;
  });
  if (board.kind != BoardKind::kCharuco || telling == views.end()) return;
  board.layout = telling->sighting.layout;
  std::vector<std::size_t> places, again;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].sighting.layout == board.layout) continue;
    places.push_back(i);
    again.push_back(frames[i]);
  }
  std::size_t next = 0;
  ShowFrames(folder, camera, again, [&](std::size_t, const Image& image) {
    views[places[next++]].sighting = DetectBoard(image, board);
  });
}

}  // namespace

std::vector<HandEyeView> FindHandEyeViews(
    const std::filesystem::path& folder, const Recording& recording,
    const std::optional<BoardSpec>& board, int max_views, std::vector<std::size_t>& frames,
    const std::function<void(std::size_t, std::size_t)>& progress) {
  const CameraStream& camera = *recording.cam0;
  const auto source = OpenRecordedFrames(folder, "cam0", camera);
  const std::size_t every = std::max<std::size_t>(
      1, (source->Count() + max_views - 1) / static_cast<std::size_t>(max_views));
  std::unique_ptr<TagDetector> detector;
  if (!board) {
    detector = std::make_unique<TagDetector>(TagDetectorOptions{.family = recording.tags0->family});
  }
  std::vector<HandEyeView> views;
  for (std::size_t at = 0;; at += every) {
    const auto frame = source->Next();
    if (!frame) break;
    views.push_back(
        {camera.filenames.empty() ? fmt::format("frame {}", at) : camera.filenames[at].value,
         frame->t_ns,
         board ? DetectBoard(frame->image, *board)
               : SightingOfCollar(*detector, *recording.tags0, frame->image)});
    frames.push_back(at);
    progress(views.size(), (source->Count() + every - 1) / every);
    if (every > 1) source->Skip(every - 1);
  }
  if (board) DetectAgain(folder, camera, *board, frames, views);
  return views;
}

void ShowFrames(const std::filesystem::path& folder, const CameraStream& camera,
                const std::vector<std::size_t>& frames,
                const std::function<void(std::size_t, Image)>& show) {
  const auto source = OpenRecordedFrames(folder, "cam0", camera);
  std::size_t next = 0;
  for (const std::size_t frame : frames) {
    if (frame > next) source->Skip(frame - next);
    auto picture = source->Next();
    if (!picture) return;
    next = frame + 1;
    show(frame, std::move(picture->image));
  }
}

}  // namespace flextip
