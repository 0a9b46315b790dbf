#include "apps/diagnose/rank_helpers.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <exception>
#include <memory>
#include <string>

#include "apps/common/exit_code.h"
#include "batch/cores.h"
#include "core/error.h"

namespace flextip {
namespace {

std::string Host() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

/// Reads when there is something to do: an arm or a single recording is the first rank's alone.
class Server {
 public:
  using Read = std::function<std::vector<diagnosis::NamedRecording>()>;
  Server(const diagnosis::DiagnoseOptions& options, const Read& read)
      : options_(options), read_(read) {}

  std::string Reply(const std::string& request) {
    try {
      if (!server_) server_ = std::make_unique<diagnosis::MemberServer>(read_(), options_);
    } catch (const InputError& error) {
      return diagnosis::MemberServer::Refusal(
          fmt::format("rank {} on {}: {}", batch::RankNumber(), Host(), error.what()));
    }
    return server_->Reply(request);
  }

 private:
  const diagnosis::DiagnoseOptions& options_;
  const Read& read_;
  std::unique_ptr<diagnosis::MemberServer> server_;
};

}  // namespace

bool RanksShareTheWork() {
  if (!batch::IsRank() || batch::RankCount() < 2) return false;
  if (!batch::HasMpi()) {
    throw InputError(
        "this flextip was built without MPI: it cannot share the work among the ranks of mpirun");
  }
  return true;
}

RankHelpers::RankHelpers()
    : cores_(tbb::global_control::max_allowed_parallelism,
             static_cast<std::size_t>(batch::ThreadsOfAnItem(1))) {}

RankHelpers::~RankHelpers() {
  if (IsFirst()) ranks_.StopAsking();
}

bool RankHelpers::IsFirst() const { return batch::RankNumber() == 0; }

diagnosis::Helpers RankHelpers::Ask() const {
  return {ranks_.size() - 1,
          [this](const std::vector<std::string>& requests, const std::function<void()>& meanwhile) {
            return ranks_.Ask(requests, meanwhile);
          }};
}

void RankHelpers::Serve(const diagnosis::DiagnoseOptions& options,
                        const std::function<std::vector<diagnosis::NamedRecording>()>& read) const {
  Server server(options, read);
  try {
    ranks_.Answer([&](const std::string& request) { return server.Reply(request); });
  } catch (const std::exception& error) {
    Complain(error.what(), kWorkFailed);
    ranks_.Abort();
  }
}

}  // namespace flextip
