#include "live/dds/node.h"

#include <dds/dds.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "live/dds/domain.h"
#include "live/dds/endpoints.h"
#include "live/dds/messages.h"
#include "live/protocols/reports.h"
#include "live/protocols/stamp_filter.h"

namespace flextip::live {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLook{200};
constexpr std::chrono::seconds kFirstPatience{1};  // for somebody at the other end of a topic
constexpr std::chrono::milliseconds kLastPatience{1000};  // for readers of what was sent before

}  // namespace

bool HasRos2() { return true; }

class Ros2Node::Worker {
 public:
  Worker(Ros2Setup setup, std::function<void(WireMessage&&)> message,
         std::function<void(WireEvent&&)> event)
      : setup_(std::move(setup)),
        name_(fmt::format("ros2 domain {}", setup_.domain)),
        message_(std::move(message)),
        event_(std::move(event)),
        domain_(Ros2Domain::Open(setup_.domain, setup_.network, setup_.lockstep)),
        participant_(domain_->NewParticipant()),
        waitset_(dds_create_waitset(participant_.get())),
        wake_(dds_create_guardcondition(participant_.get())) {
    dds_waitset_attach(waitset_.get(), wake_.get(), 0);
    const EndpointPlace place = Place();
    for (const Ros2Topic& topic : setup_.out) {
      Out& out = outs_.emplace_back();
      out.name = topic.name;
      out.writer.emplace(place, topic.name, topic.types.front());
    }
    for (std::size_t i = 0; i < setup_.in.size(); ++i) {
      In& in = ins_.emplace_back();
      in.name = setup_.in[i].name;
      const bool later = setup_.opens_last_in_late && static_cast<int>(i) == setup_.last_in;
      if (!later) OpenReaders(in, setup_.in[i], place);
    }
    thread_ = std::thread([this] { Run(); });
  }

  ~Worker() {
    stop_ = true;
    dds_set_guardcondition(wake_.get(), true);
    thread_.join();
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  bool Send(const WireMessage& message) {
    bool sent = false;
    if (Out* const out = OutOf(message.device)) {
      if (IsLast(*out)) (void)WaitForReaders(kLastPatience);
      const bool there = out->there;
      WithRos2(out->writer->type(), message, [&](const void* sample) {
        // In lockstep also for a reader that this thread does not know yet.
        sent = (there || setup_.lockstep) && out->writer->Write(sample) && there;
      });
    }
    if (!sent) counts_.Add(&WireCounts::unsent);
    return sent;
  }

  bool IsThere(const std::string& topic) const {
    for (const Out& out : outs_)
      if (out.name == topic) return out.there;
    for (const In& in : ins_)
      if (in.name == topic) return in.there;
    return false;
  }

  bool HasCommander() const { return commander_ != 0; }
  WireCounts Counts() const { return counts_.Get(); }

  bool WaitForReaders(std::chrono::milliseconds patience) const {
    const auto until = Clock::now() + patience;
    for (const Out& out : outs_) {
      const auto left = std::max<Clock::duration>(until - Clock::now(), Clock::duration::zero());
      if (!out.writer->WaitForReaders(left)) return false;
    }
    return true;
  }

 private:
  struct End {
    std::string name;
    std::atomic<bool> there = false;
    bool told = false;
  };
  struct In : End {
    std::deque<Ros2Reader> readers;  // one a type
  };
  struct Out : End {
    std::optional<Ros2Writer> writer;
  };

  EndpointPlace Place() const { return {participant_.get(), waitset_.get(), setup_.lockstep}; }

  static void OpenReaders(In& in, const Ros2Topic& topic, const EndpointPlace& place) {
    for (const Ros2Type type : topic.types) in.readers.emplace_back(place, topic.name, type);
  }

  Out* OutOf(const std::string& topic) {
    for (Out& out : outs_)
      if (out.name == topic) return &out;
    return nullptr;
  }

  void Run() {
    const auto begin = Clock::now();
    bool told = false;
    while (!stop_) {
      dds_waitset_wait(waitset_.get(), nullptr, 0, std::chrono::nanoseconds(kLook).count());
      if (stop_) return;
      LookAtStatus();
      TakeAll();
      if (!told && Clock::now() - begin > kFirstPatience) {
        told = true;
        TellMissing();
      }
    }
  }

  void LookAtStatus() {
    // All ends first: who is told of one then finds the others as they are.
    std::vector<WireEvent> news;
    for (In& in : ins_) {
      int writers = 0;
      for (Ros2Reader& reader : in.readers) {
        reader.LookAtStatus();
        writers += reader.Writers();
      }
      if (writers == 0) filter_.Forget(in.name);
      Note(in, writers > 0, "sent", news);
    }
    for (Out& out : outs_) {
      out.writer->LookAtStatus();
      Note(out, out.writer->Readers() > 0 && (out.there || IsWhole(out)), "read", news);
    }
    if (commander_ != 0 && !IsWritten(commander_)) commander_ = 0;
    OpenLast();
    for (WireEvent& event : news) event_(std::move(event));
  }

  void Note(End& end, bool there, const char* what, std::vector<WireEvent>& news) const {
    if (there == end.there) return;
    end.there = there;
    end.told = true;
    news.push_back({there ? WireEvent::Kind::kConnected : WireEvent::Kind::kLost,
                    fmt::format("{}: {} is {}", name_, end.name,
                                there ? what : fmt::format("not {} any more", what)),
                    end.name});
  }

  void TellMissing() {
    const auto tell = [&](const End& end, const char* what) {
      if (end.there || end.told) return;
      event_({WireEvent::Kind::kLost, fmt::format("{}: nobody {} {}", name_, what, end.name),
              end.name});
    };
    for (const In& in : ins_) tell(in, "sends");
    for (const Out& out : outs_) tell(out, "reads");
  }

  bool IsLast(const Out& out) const {
    return setup_.last_out >= 0 && &out == &outs_[static_cast<std::size_t>(setup_.last_out)];
  }

  /// Whether readers of the topic that comes last are known on all others that they read.
  bool IsWhole(const Out& out) const {
    return !IsLast(out) || std::all_of(outs_.begin(), outs_.end(), [&](const Out& other) {
      return other.writer->KnowsReadersOf(*out.writer);
    });
  }

  void OpenLast() {
    if (setup_.last_in < 0 || !setup_.opens_last_in_late) return;
    const auto last = static_cast<std::size_t>(setup_.last_in);
    if (!ins_[last].readers.empty()) return;
    for (std::size_t i = 0; i < ins_.size(); ++i)
      if (i != last && !ins_[i].there) return;
    for (const Out& out : outs_)
      if (!out.there) return;
    EndpointPlace place = Place();
    place.beside = BesideOf(setup_.in);
    OpenReaders(ins_[last], setup_.in[last], place);
  }

  bool IsWritten(DdsInstance participant) const {
    for (const In& in : ins_)
      for (const Ros2Reader& reader : in.readers)
        if (reader.IsWrittenBy(participant)) return true;
    return false;
  }

  void TakeAll() {
    // The last topic is looked at first: what was sent before its messages is then there.
    std::vector<WireMessage> held;
    if (setup_.last_in >= 0) {
      TakeFrom(ins_[static_cast<std::size_t>(setup_.last_in)],
               [&](WireMessage&& message) { held.push_back(std::move(message)); });
    }
    for (std::size_t i = 0; i < ins_.size(); ++i) {
      if (static_cast<int>(i) == setup_.last_in) continue;
      TakeFrom(ins_[i], [&](WireMessage&& message) { Pass(std::move(message)); });
    }
    for (WireMessage& message : held) Pass(std::move(message));
  }

  template <class Give>
  void TakeFrom(In& in, const Give& give) {
    for (Ros2Reader& reader : in.readers) {
      reader.TakeAll(
          [&](Ros2Type type, const void* sample, TimeNs source_ns, DdsInstance participant) {
            Ros2Decoded decoded = DecodeRos2(type, sample, in.name, source_ns);
            if (!decoded.message) {
              Refuse(decoded.why, in.name);
            } else if (IsHeard(participant, in.name)) {
              give(std::move(*decoded.message));
            }
          });
    }
  }

  bool IsHeard(DdsInstance participant, const std::string& topic) {
    if (!setup_.one_commander) return true;
    DdsInstance nobody = 0;
    commander_.compare_exchange_strong(nobody, participant);
    if (commander_ == participant) return true;
    Refuse(fmt::format("{}: another participant commands, this one is not heard", topic), topic);
    return false;
  }

  void Pass(WireMessage&& message) {
    const StampVerdict verdict = filter_.Judge(message);
    if (verdict == StampVerdict::kPass) {
      counts_.Add(&WireCounts::passed);
      if (message.t_ns == 0 && setup_.says_invalid) {
        reports_.Tell(event_,
                      fmt::format("{}: {}: found the stamp 0, which means invalid data", name_,
                                  message.device),
                      message.device);
      }
      message_(std::move(message));
      return;
    }
    const bool repeated = verdict == StampVerdict::kRepeated;
    counts_.Add(repeated ? &WireCounts::repeated : &WireCounts::out_of_order);
    reports_.Tell(event_,
                  fmt::format("{}: {}: found the time {} after {}, expected a later one", name_,
                              message.device, message.t_ns, filter_.Last(message.device)),
                  message.device);
  }

  void Refuse(const std::string& why, const std::string& topic) {
    counts_.Add(&WireCounts::refused);
    reports_.Tell(event_, fmt::format("{}: {}", name_, why), topic);
  }

  const Ros2Setup setup_;
  const std::string name_;
  std::function<void(WireMessage&&)> message_;
  std::function<void(WireEvent&&)> event_;
  SharedCounts counts_;
  StampFilter filter_;
  Reports reports_;
  std::shared_ptr<Ros2Domain> domain_;
  DdsEntity participant_, waitset_, wake_;
  std::deque<In> ins_;
  std::deque<Out> outs_;
  std::atomic<DdsInstance> commander_ = 0;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

Ros2Node::Ros2Node(Ros2Setup setup, std::function<void(WireMessage&&)> message,
                   std::function<void(WireEvent&&)> event)
    : worker_(std::make_unique<Worker>(std::move(setup), std::move(message), std::move(event))) {}

Ros2Node::~Ros2Node() = default;

bool Ros2Node::Send(const WireMessage& message) { return worker_->Send(message); }
bool Ros2Node::IsThere(const std::string& topic) const { return worker_->IsThere(topic); }
bool Ros2Node::HasCommander() const { return worker_->HasCommander(); }
bool Ros2Node::WaitForReaders(std::chrono::milliseconds patience) const {
  return worker_->WaitForReaders(patience);
}
WireCounts Ros2Node::Counts() const { return worker_->Counts(); }

}  // namespace flextip::live
