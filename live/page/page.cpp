#include "live/page/page.h"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <random>
#include <thread>
#include <utility>

#include "core/error.h"
#include "diagnosis/running/running_diagnosis.h"
#include "live/page/findings.h"
#include "live/page/history.h"
#include "live/page/picture_json.h"
#include "live/page/server.h"
#include "live/page/state_json.h"
#include "live/page/watcher_texts.h"
#include "live/page/web_files.h"
#include "live/streams/newest.h"
#include "recording/frames/frames.h"

namespace flextip::live {
namespace {

constexpr double kRate_hz = 25.0;
constexpr int kTicksPerPicture = 3;
constexpr std::size_t kChanges = 512;  // that wait for the page's thread
constexpr std::size_t kMostWaitingEvents = 200, kEventsTold = 16;
constexpr int kPictureWidth_px = 800, kPictureQuality = 75;

/// 128 bits of the system's, as hexadecimal digits.
std::string RandomToken() {
  std::random_device bits;
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", bits());
  return token;
}

}  // namespace

class Page::Worker {
 public:
  Worker(const Session& session, PageOptions options, OperatorCommands& operators)
      : session_(session),
        options_(std::move(options)),
        operators_(operators),
        changes_(kChanges),
        finder_(session) {
    if (options_.token.empty()) options_.token = RandomToken();
    if (session.camera && session.base.cam0) camera_.emplace(session.base.cam0->calibration);
    ServerHandlers handlers;
    handlers.hello = [this] { return HelloText(session_, options_.can_command, history_); };
    handlers.answer = [this](std::string_view text) { return Answer(text); };
    handlers.tick = [this] { Tick(); };
    handlers.fault = [this](const char* what) {
      if (faults_++ > 0) return;
      TakeEvent(Now_ns(), fmt::format("a fault of the page: {}", what));
      if (options_.said) options_.said(Now_ns(), fmt::format("a fault of the page: {}", what));
    };
    server_ = std::make_unique<PageServer>(options_.port, WebFiles(), handlers, kRate_hz);
  }

  int port() const { return server_->port(); }
  const std::string& token() const { return options_.token; }

  // The cycle's thread.
  void Take(const PageSnapshot& snapshot) {
    const CycleRecord& record = snapshot.record;
    PageChange now{record.inputs.t_ns, record.outputs.hold, record.outputs.held_by, {}, {}, {}};
    if (record.inputs.streams.state) now.state = record.inputs.streams.state->value;
    if (IsOther(now, last_change_)) changes_.Push(now);
    last_change_ = now;
    if (IsNews(record.outputs.cause, last_cause_)) {
      last_cause_ = record.outputs.cause;
      PageChange found = now;
      found.cause = record.outputs.cause;
      changes_.Push(found);
    }
    if (record.outputs.state_command) {
      now.told = record.outputs.state_command;
      changes_.Push(now);
    }
    snapshots_.Put(snapshot);
  }

  // The camera's thread.
  void TakePicture(TimeNs t_ns, const Image& image, const TipTrack& track) {
    if (!wants_picture_.exchange(false)) return;
    const std::lock_guard lock(mutex_);
    picture_ = Picture{t_ns, image, track};
  }

  // Any other thread.
  void TakeEvent(TimeNs t_ns, const std::string& what) {
    const std::lock_guard lock(mutex_);
    if (events_.size() < kMostWaitingEvents) events_.emplace_back(t_ns, what);
  }

  void End(bool done) {
    end_ = done ? Ending::kDone : Ending::kEarlier;
    // A last look for those who watch.
    for (int i = 0; i < 20 && !end_told_; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(25));
  }

 private:
  enum class Ending : std::uint8_t { kNot, kDone, kEarlier };
  struct Picture {
    TimeNs t_ns = 0;
    Image image;
    TipTrack track;
  };

  static bool IsOther(const PageChange& a, const PageChange& b) {
    if (a.hold != b.hold || a.held_by != b.held_by || a.state.has_value() != b.state.has_value())
      return true;
    return a.state && (a.state->state != b.state->state || a.state->is_homed != b.state->is_homed ||
                       a.state->is_busy != b.state->is_busy);
  }

  // The server's thread from here on.

  std::optional<std::string> Answer(std::string_view text) {
    const std::optional<PageWish> wish = ReadWish(text);
    if (!wish) return {};
    const bool may = SameSecret(wish->token, options_.token);
    const bool can =
        wish->what == "stop" || (options_.can_command && session_.robot.command_state &&
                                 (wish->what == "pause" || session_.robot.state));
    if (may && can) Do(wish->what);
    return AnswerText(wish->what, !may ? "token" : !can ? "session" : "");
  }

  void Do(const std::string& wish) {
    if (wish == "enable") operators_.Enable();
    if (wish == "pause") operators_.Pause();
    if (wish == "stop") operators_.Stop();
    const TimeNs now_ns = Now_ns();
    history_.AddEvent({now_ns, PageEvent::Kind::kWish, wish, {}});
    if (options_.said) options_.said(now_ns, fmt::format("a person at the page: {}", wish));
  }

  void Tick() {
    ++ticks_;
    TakeNews();
    const PageSnapshot* const snapshot = snapshots_.Look();
    if (snapshot == nullptr) return;
    if (finder_.Note(*snapshot)) history_.Add(*snapshot);
    const Ending end = end_;
    if (server_->Watchers() > 0) {
      const char* const told = end == Ending::kNot ? "" : end == Ending::kDone ? "done" : "earlier";
      ++sent_;
      server_->SendText(sent_, StateText(sent_, session_, *snapshot, finder_.Find(*snapshot),
                                         history_.Events(kEventsTold), told));
      if (camera_ && ticks_ % kTicksPerPicture == 0) SendPicture();
    }
    if (end != Ending::kNot) end_told_ = true;
  }

  /// Events and changes since the last tick.
  void TakeNews() {
    std::vector<std::pair<TimeNs, std::string>> events;
    {
      const std::lock_guard lock(mutex_);
      events.swap(events_);
    }
    for (auto& [t_ns, what] : events) history_.AddEvent({t_ns, PageEvent::Kind::kText, what, {}});
    changes_.Drain([&](const PageChange& change) {
      if (change.cause.IsThere()) {
        history_.AddEvent({change.t_ns,
                           PageEvent::Kind::kText,
                           fmt::format("warning: {}", diagnosis::Text(change.cause)),
                           {}});
        return;
      }
      history_.AddEvent({change.t_ns, PageEvent::Kind::kChange, "", change});
    });
  }

  /// Four bytes with the length of the JSON (least first), the JSON, the JPEG.
  void SendPicture() {
    std::optional<Picture> picture;
    {
      const std::lock_guard lock(mutex_);
      picture.swap(picture_);
    }
    wants_picture_ = true;
    if (!picture) return;
    ++sent_;
    const std::string head =
        OverlayText(sent_, picture->t_ns, *camera_, picture->track, finder_.At(picture->t_ns));
    std::string bytes(4, '\0');
    for (int i = 0; i < 4; ++i) bytes[i] = static_cast<char>(head.size() >> (8 * i) & 0xffU);
    bytes += head;
    bytes += EncodeJpeg(picture->image, kPictureQuality, kPictureWidth_px);
    server_->SendBytes(sent_, bytes);
  }

  const Session& session_;
  PageOptions options_;
  OperatorCommands& operators_;
  std::atomic<Ending> end_{Ending::kNot};
  std::atomic<bool> end_told_{false}, wants_picture_{false};

  Newest<PageSnapshot> snapshots_;
  Ring<PageChange> changes_;
  PageChange last_change_;  // of the cycle's thread
  FoundCause last_cause_;   // of it, too

  std::mutex mutex_;  // not for the cycle's thread
  std::vector<std::pair<TimeNs, std::string>> events_;
  std::optional<Picture> picture_;

  // Of the server's thread.
  std::optional<CameraModel> camera_;
  PageHistory history_;
  PageFinder finder_;
  long ticks_ = 0, sent_ = 0, faults_ = 0;

  std::unique_ptr<PageServer> server_;  // last: its thread uses all the others
};

Page::Page(const Session& session, PageOptions options)
    : worker_(std::make_unique<Worker>(session, std::move(options), operators_)) {}
Page::~Page() = default;

int Page::port() const { return worker_->port(); }
std::string Page::Address() const {
  return fmt::format("http://127.0.0.1:{}/?token={}", worker_->port(), worker_->token());
}
void Page::Take(const PageSnapshot& snapshot) { worker_->Take(snapshot); }
void Page::TakePicture(TimeNs t_ns, const Image& picture, const TipTrack& track) {
  worker_->TakePicture(t_ns, picture, track);
}
void Page::TakeEvent(TimeNs t_ns, const std::string& what) { worker_->TakeEvent(t_ns, what); }
void Page::End(bool done) { worker_->End(done); }

}  // namespace flextip::live
