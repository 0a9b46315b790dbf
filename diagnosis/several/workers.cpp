#include "diagnosis/several/workers.h"

#include <tbb/parallel_for.h>

#include "core/error.h"
#include "diagnosis/search/parameter_scan.h"
#include "diagnosis/several/diagnose_several.h"
#include "diagnosis/several/packed.h"

namespace flextip::diagnosis {
namespace {

std::vector<MemberAnswer> DoHere(Fleet& fleet, const std::vector<MemberTask>& tasks,
                                 const DiagnoseOptions& options,
                                 const SelectionOptions& selection_options) {
  std::vector<MemberAnswer> answers(tasks.size());
  tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t i) {
    answers[i] = DoTask(fleet, tasks[i], options, selection_options);
  });
  return answers;
}

}  // namespace

MemberWorkers::MemberWorkers(Fleet& fleet, const DiagnoseOptions& options,
                             const SelectionOptions& selection_options, const Helpers& helpers)
    : fleet_(fleet), options_(options), selection_options_(selection_options), helpers_(helpers) {}

std::vector<MemberAnswer> MemberWorkers::Do(const std::vector<MemberTask>& tasks) const {
  if (helpers_.count == 0) return DoHere(fleet_, tasks, options_, selection_options_);
  // A member's process is always the same one: it keeps what it took of the recording.
  const std::size_t processes = std::size_t(helpers_.count) + 1;
  std::vector<std::vector<MemberTask>> shares(processes);
  for (const MemberTask& task : tasks) shares[task.member % processes].push_back(task);
  std::vector<std::string> requests;
  for (std::size_t p = 1; p < processes; ++p) requests.push_back(Pack(shares[p]));
  std::vector<std::vector<MemberAnswer>> answered(processes);
  const std::vector<std::string> replies = helpers_.ask(
      requests, [&] { answered[0] = DoHere(fleet_, shares[0], options_, selection_options_); });
  for (std::size_t p = 1; p < processes; ++p) answered[p] = UnpackReply(replies[p - 1]);
  std::vector<std::size_t> next(processes, 0);
  std::vector<MemberAnswer> answers;
  answers.reserve(tasks.size());
  for (const MemberTask& task : tasks) {
    const std::size_t p = task.member % processes;
    answers.push_back(std::move(answered[p][next[p]++]));
  }
  return answers;
}

void MemberWorkers::Take(std::size_t r, MemberState state) const {
  Member& member = fleet_.At(r);
  SetScanCentres(member.layout, state.place.scan_centres);
  member.place = std::move(state.place);
  member.theta = member.place.theta;
  member.sums = std::move(state.sums);
  member.far_samples = state.far_samples;
}

bool MemberWorkers::Move(const std::vector<MemberTask>& tasks) const {
  std::vector<MemberAnswer> answers = Do(tasks);
  bool all = true;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    auto* state = std::get_if<MemberState>(&answers[i]);
    all = all && state != nullptr;
    if (state != nullptr) Take(tasks[i].member, std::move(*state));
  }
  return all;
}

std::vector<MemberAnswer> MemberWorkers::DoWhereTheyStand(const TaskAt& task) const {
  std::vector<MemberTask> tasks, again;
  for (std::size_t r = 0; r < fleet_.Size(); ++r)
    tasks.push_back({r, task(r, PlaceNow(fleet_.At(r)))});
  std::vector<MemberAnswer> answers = Do(tasks);
  for (std::size_t r = 0; r < answers.size(); ++r)
    if (std::holds_alternative<NoEquilibrium>(answers[r]))
      again.push_back({r, task(r, fleet_.At(r).place)});
  if (again.empty()) return answers;
  std::vector<MemberAnswer> more = Do(again);
  for (std::size_t i = 0; i < again.size(); ++i) answers[again[i].member] = std::move(more[i]);
  return answers;
}

void MemberWorkers::Take(std::vector<MemberAnswer> answers) const {
  for (std::size_t r = 0; r < answers.size(); ++r)
    Take(r, std::move(std::get<MemberState>(answers[r])));
}

MemberServer::MemberServer(const std::vector<NamedRecording>& recordings,
                           const DiagnoseOptions& options)
    : fleet_(std::make_unique<Fleet>(recordings, options)), options_(options) {}

MemberServer::~MemberServer() = default;

std::string MemberServer::Reply(const std::string& request) {
  try {
    return PackReply(DoHere(*fleet_, UnpackTasks(request), options_, {}));
  } catch (const WorkError& error) {
    return Refusal(error.what());
  }
}

std::string MemberServer::Refusal(const std::string& why) { return PackRefusal(why); }

}  // namespace flextip::diagnosis
