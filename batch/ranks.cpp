// All calls of MPI are here.
#include "batch/ranks.h"

#include <fmt/format.h>
#include <mpi.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <exception>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <thread>
#include <utility>

#include "batch/zygote.h"
#include "core/error.h"

namespace flextip::batch {
namespace {

enum Tag : int { kReady = 1, kItem, kEnded, kStop, kBye, kQuestion, kReply };

constexpr std::size_t kPiece = std::size_t{1} << 26;  // MPI counts bytes in an int

struct Message {
  int rank = 0, tag = 0;
  std::string text;
};

/// In pieces: the first tells the length of all.
void Send(int rank, int tag, const std::string& text) {
  const std::uint64_t length = text.size();
  MPI_Send(&length, 1, MPI_UINT64_T, rank, tag, MPI_COMM_WORLD);
  for (std::size_t at = 0; at < text.size(); at += kPiece) {
    const auto count = static_cast<int>(std::min(kPiece, text.size() - at));
    MPI_Send(text.data() + at, count, MPI_BYTE, rank, tag, MPI_COMM_WORLD);
  }
}

std::optional<Message> ReceiveIfAny() {
  int there = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
  if (!there) return {};
  Message message{status.MPI_SOURCE, status.MPI_TAG, {}};
  std::uint64_t length = 0;
  MPI_Recv(&length, 1, MPI_UINT64_T, message.rank, message.tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  message.text.resize(length);
  for (std::size_t at = 0; at < length; at += kPiece) {
    const auto count = static_cast<int>(std::min<std::size_t>(kPiece, length - at));
    MPI_Recv(message.text.data() + at, count, MPI_BYTE, message.rank, message.tag, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
  }
  return message;
}

/// Waits for the pool or for a message, neither long nor with a whole core.
class Idle {
 public:
  /// Returns how long the pool may be waited for.
  double Next(bool something_happened) {
    const auto now = std::chrono::steady_clock::now();
    if (something_happened) last_ = now;
    if (now - last_ > std::chrono::milliseconds(1)) return 1e-3;
    sched_yield();
    return 0.0;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void Sleep(double seconds) {
  if (seconds > 0.0) std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

/// An item's end with its results: "INDEX\tLENGTH\tOUTCOME" and behind its length the bytes.
std::string EndedText(const Ended& ended, const std::string& bytes) {
  const std::string outcome = Pack(ended.outcome);
  return WithIndex(ended.index, WithIndex(outcome.size(), outcome + bytes));
}

Ended EndedOf(const std::string& text, std::string& bytes) {
  const auto [index, rest] = IndexAndText(text);
  const auto [length, both] = IndexAndText(rest);
  bytes = both.substr(length);
  return {index, UnpackOutcome(std::string_view(both).substr(0, length))};
}

/// What rank 0 does.
class HandOut {
 public:
  HandOut(int ranks, Pool& pool, const std::vector<Item>& items, const Done& done,
          const Transfer& transfer)
      : ranks_(ranks), pool_(pool), items_(items), done_(done), transfer_(transfer) {
    order_ = LargestFirst(items);
  }

  void Run() {
    try {
      Idle idle;
      while (ended_ < items_.size()) {
        std::vector<Ended> ended = TakeMessages();
        const bool any_message = took_;
        GiveOwn();
        for (Ended& one : pool_.Wait(idle.Next(any_message || own_ended_))) {
          ended.push_back(std::move(one));
        }
        own_ended_ = !ended.empty();
        GiveOwn();
        ended_ += ended.size();
        if (!ended.empty()) done_(ended);
        if (StopSignals::Caught() != 0) return;  // the whole job ends
      }
    } catch (...) {
      StopOthers();
      throw;
    }
    StopOthers();
  }

 private:
  bool IsOpen() const { return next_ < order_.size(); }

  void GiveOwn() {
    for (; IsOpen() && pool_.HasRoom(); ++next_) pool_.Start(order_[next_], items_[order_[next_]]);
  }

  void Give(int rank) {
    if (!IsOpen()) return;
    Send(rank, kItem, WithIndex(order_[next_], Pack(items_[order_[next_]])));
    ++next_;
  }

  std::vector<Ended> TakeMessages() {
    std::vector<Ended> ended;
    took_ = false;
    while (const auto message = ReceiveIfAny()) {
      took_ = true;
      if (message->tag == kEnded) {
        Give(message->rank);  // before the disk is waited for
        std::string bytes;
        ended.push_back(EndedOf(message->text, bytes));
        if (!bytes.empty() && transfer_.unpack) transfer_.unpack(ended.back().outcome, bytes);
      } else if (message->tag == kReady) {
        Give(message->rank);
      } else if (message->tag == kBye) {
        ++gone_;
      }
    }
    return ended;
  }

  /// They may be about to send: everything is taken until each has said goodbye.
  void StopOthers() {
    for (int rank = 1; rank < ranks_; ++rank) Send(rank, kStop, "");
    while (gone_ < ranks_ - 1) {
      const auto message = ReceiveIfAny();
      if (message && message->tag == kBye) ++gone_;
      if (!message) sched_yield();
      if (StopSignals::Caught() != 0) return;
    }
  }

  int ranks_, gone_ = 0;
  Pool& pool_;
  const std::vector<Item>& items_;
  const Done& done_;
  const Transfer& transfer_;
  std::vector<std::size_t> order_;
  std::size_t next_ = 0, ended_ = 0;
  bool took_ = false, own_ended_ = false;
};

}  // namespace

bool HasMpi() { return true; }

Ranks::Ranks() {
  MPI_Init(nullptr, nullptr);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

Ranks::~Ranks() { MPI_Finalize(); }

bool Ranks::SeesFolder(const std::string& folder) const {
  const auto file = std::filesystem::path(folder) / "shared";
  std::uint64_t token = rank_ == 0 ? std::random_device()() : 0;
  if (rank_ == 0) std::ofstream(file) << token << std::flush;
  MPI_Bcast(&token, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
  std::uint64_t seen = 0;
  std::ifstream in(file);
  const bool sees = in >> seen && seen == token;
  MPI_Barrier(MPI_COMM_WORLD);
  std::error_code ignored;
  if (rank_ == 0) std::filesystem::remove(file, ignored);
  return sees;
}

void Ranks::RunItems(Pool& pool, const std::vector<Item>& items, const Done& done,
                     const Transfer& transfer) const {
  HandOut(size_, pool, items, done, transfer).Run();
}

void Ranks::Serve(Pool& pool, const std::function<void(Item&)>& begin,
                  const Transfer& transfer) const {
  for (int i = 0; i < pool.jobs(); ++i) Send(0, kReady, "");
  Idle idle;
  bool something = true;
  while (true) {
    const auto message = ReceiveIfAny();
    if (message && message->tag == kStop) break;
    if (message && message->tag == kItem) {
      const auto [index, text] = IndexAndText(message->text);
      Item item = UnpackItem(text);
      if (begin) begin(item);
      pool.Start(index, item);
    }
    const std::vector<Ended> ended = pool.Wait(idle.Next(something || message.has_value()));
    for (const Ended& one : ended) {
      Send(0, kEnded, EndedText(one, transfer.pack ? transfer.pack(one.outcome) : ""));
    }
    something = !ended.empty();
  }
  Send(0, kBye, "");
}

std::vector<std::string> Ranks::Ask(const std::vector<std::string>& texts,
                                    const std::function<void()>& meanwhile) const {
  for (std::size_t i = 0; i < texts.size(); ++i) Send(int(i) + 1, kQuestion, texts[i]);
  std::exception_ptr failed;  // told when nobody is about to send any more
  try {
    meanwhile();
  } catch (...) {
    failed = std::current_exception();
  }
  std::vector<std::string> replies(texts.size());
  Idle idle;
  for (std::size_t left = texts.size(); left > 0;) {
    auto message = ReceiveIfAny();
    Sleep(idle.Next(message.has_value()));
    if (!message) continue;
    replies[std::size_t(message->rank) - 1] = std::move(message->text);
    --left;
  }
  if (failed) std::rethrow_exception(failed);
  return replies;
}

void Ranks::StopAsking() const {
  for (int rank = 1; rank < size_; ++rank) Send(rank, kStop, "");
}

void Ranks::Answer(const std::function<std::string(const std::string&)>& reply) const {
  Idle idle;
  while (true) {
    const auto message = ReceiveIfAny();
    Sleep(idle.Next(message.has_value()));
    if (!message) continue;
    if (message->tag == kStop) return;
    Send(0, kReply, reply(message->text));
  }
}

void Ranks::Abort() const {
  MPI_Abort(MPI_COMM_WORLD, 1);
  std::abort();
}

}  // namespace flextip::batch
