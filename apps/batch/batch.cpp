// flextip batch: a command on many inputs, several at a time, with a table of all.
#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/batch/commands.h"
#include "apps/batch/folder.h"
#include "apps/batch/list.h"
#include "apps/batch/table.h"
#include "apps/batch/transfer.h"
#include "apps/batch/work.h"
#include "apps/common/commands.h"
#include "apps/common/exit_code.h"
#include "apps/common/progress.h"
#include "batch/cores.h"
#include "batch/ranks.h"
#include "batch/run.h"
#include "core/error.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

struct BatchOptions {
  std::vector<std::string> words;  // COMMAND LIST
  fs::path out;
  int jobs = 0;  // 0: as many as there are cores
  double timeout_s = 0.0;
  bool resume = false, no_shared_files = false;
};

/// What was done, on a terminal in one line, else in a line an item.
class Reporter {
 public:
  Reporter(std::size_t all, std::size_t done, std::size_t failed, bool quiet)
      : all_(all),
        before_(done),
        done_(done),
        failed_(failed),
        logs_(!quiet && isatty(STDERR_FILENO) != 1),
        progress_("items", all - done, quiet || logs_, "items/s") {}

  void Add(const batch::Outcome& end) {
    ++done_;
    failed_ += end.status == batch::Status::kOk ? 0 : 1;
    if (logs_) {
      fmt::print(stderr, "flextip: {} of {}, {} failed: {} {}, {:.1f} s\n", done_, all_, failed_,
                 end.name, StatusText(end), end.seconds);
    }
    progress_.Update(done_ - before_, fmt::format("{} of {}, {} failed", done_, all_, failed_));
  }

 private:
  std::size_t all_, before_, done_, failed_;
  bool logs_;
  Progress progress_;
};

/// As if nobody had caught the signal: a shell then sees what ended the program.
[[noreturn]] void EndBy(int signal, const fs::path& out) {
  fmt::print(stderr,
             "\nflextip: interrupted; {} keeps what was done: the same command with --resume goes "
             "on\n",
             out.string());
  std::fflush(nullptr);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
  std::_Exit(128 + signal);
}

[[noreturn]] void StopForTheDisk(const fs::path& out, const std::string& why) {
  throw WorkError(fmt::format(
      "{}: the disk takes no more ({}); when there is room, the same command with --resume goes on",
      out.string(), why));
}

/// Keeps the ends of items but for those that the disk did not take.
void Keep(const std::vector<batch::Ended>& ended, BatchFolder& folder, Reporter& reporter) {
  constexpr std::uintmax_t kLeast_bytes = 1 << 20;  // below it a result may be torn unnoticed
  std::error_code error;
  const fs::space_info space = fs::space(folder.out(), error);
  if (!error && space.available < kLeast_bytes) {
    StopForTheDisk(folder.out(), fmt::format("{} bytes left", space.available));
  }
  std::vector<batch::Ended> kept;
  const batch::Ended* refused = nullptr;
  for (const batch::Ended& one : ended) {
    if (DiskRefused(one.outcome)) {
      refused = &one;
    } else {
      kept.push_back(one);
    }
  }
  folder.records().Add(kept);
  for (const batch::Ended& one : kept) reporter.Add(one.outcome);
  if (refused) {
    StopForTheDisk(folder.out(), fmt::format("{} failed to write", refused->outcome.name));
  }
}

/// The command with its options; `list` is what names the items.
BatchPlan CommandOf(const BatchOptions& options, const AppContext& context, std::string& list) {
  BatchPlan plan;
  std::vector<std::string> words = options.words;
  plan.command = TakeBatchCommand(words);
  if (words.empty()) throw InputError("no list was given, expected a file of paths or a glob");
  if (words.size() > 1) {
    throw InputError(
        fmt::format("found {} behind the list, expected options behind --; a glob "
                    "stands in quotes",
                    words[1]));
  }
  list = words[0];
  plan.options = context.behind_dashes;
  RefuseBatchOptions(plan.options, "", 0);
  return plan;
}

int JobsOf(const BatchOptions& options) {
  if (options.jobs > 0) return options.jobs;
  return batch::IsRank() ? 1 : batch::CoresOfThisProcess();
}

std::unique_ptr<batch::Pool> PoolOf(const BatchOptions& options, const BatchWork& work,
                                    const fs::path& place) {
  return std::make_unique<batch::Pool>(
      [&](const batch::Item& item, std::string& payload) { return DoItem(work, item, payload); },
      batch::PoolOptions{JobsOf(options), options.timeout_s,
                         [&](batch::Outcome& end) { FinishItem(place, end); }});
}

BatchWork WorkOf(const BatchOptions& options, const BatchPlan& plan, const AppContext& context) {
  const int threads = batch::ThreadsOfAnItem(JobsOf(options));
  return {plan.command, plan.options, context.defaults, threads, context.program};
}

/// A rank but the first: works for that one.
void WorkAsRank(const BatchOptions& options, const AppContext& context) {
  std::string list;
  const BatchPlan plan = CommandOf(options, context, list);
  const BatchWork work = WorkOf(options, plan, context);
  fs::path place = options.out;  // of the results
  const auto pool = PoolOf(options, work, place);
  const batch::Ranks ranks;
  const batch::StopSignals signals;  // the first rank ends the job
  const bool sees = ranks.SeesFolder(options.out.string()) && !options.no_shared_files;
  std::string own = (fs::temp_directory_path() / "flextip-batch-XXXXXX").string();
  batch::Transfer transfer;
  if (!sees) {
    if (!mkdtemp(own.data())) throw WorkError(fmt::format("{}: cannot be made", own));
    place = own;
    fs::create_directories(place / "items");
    fs::create_directories(place / "logs");
    transfer.pack = [&](const batch::Outcome& end) { return PackItem(place, end.name); };
  }
  try {
    ranks.Serve(
        *pool, [&](batch::Item& item) { item.arguments[0] = place.string(); }, transfer);
  } catch (const std::exception& error) {
    Complain(error.what(), kWorkFailed);
    ranks.Abort();
  }
  std::error_code ignored;
  if (!sees) fs::remove_all(place, ignored);
}

/// All open items, on this machine or over the ranks.
void RunOpenItems(const BatchOptions& options, const BatchPlan& plan, const AppContext& context,
                  const std::vector<std::size_t>& open, BatchFolder& folder) {
  const BatchWork work = WorkOf(options, plan, context);
  const auto pool = PoolOf(options, work, options.out);  // before anything here has threads
  std::optional<batch::Ranks> ranks;
  if (batch::IsRank()) {
    ranks.emplace();
    ranks->SeesFolder(options.out.string());
  }
  std::vector<batch::Item> items;
  for (const std::size_t i : open) items.push_back(ItemOf(plan.items[i], options.out));
  std::size_t failed = 0;
  for (const ListedItem& item : plan.items) {
    const batch::Outcome* end = folder.records().Find(item.name);
    failed += end && end->status != batch::Status::kOk ? 1 : 0;
  }
  {
    Reporter reporter(plan.items.size(), plan.items.size() - open.size(), failed, context.quiet);
    const auto keep = [&](const std::vector<batch::Ended>& ended) {
      Keep(ended, folder, reporter);
    };
    if (ranks) {
      const batch::Transfer transfer{{}, [&](const batch::Outcome& end, const std::string& bytes) {
                                       UnpackItem(options.out, end.name, bytes);
                                     }};
      ranks->RunItems(*pool, items, keep, transfer);
    } else {
      RunItems(*pool, items, keep);
    }
  }
  if (batch::StopSignals::Caught() != 0) EndBy(batch::StopSignals::Caught(), options.out);
}

void RunBatch(const BatchOptions& options, const AppContext& context) {
  if (batch::IsRank() && !batch::HasMpi()) {
    throw InputError(
        "this flextip was built without MPI: it cannot spread a batch over the ranks of mpirun");
  }
  if (batch::IsRank() && batch::RankNumber() > 0) return WorkAsRank(options, context);
  std::string list;
  BatchPlan plan = CommandOf(options, context, list);
  plan.items = ReadBatchList(list);
  const batch::StopSignals signals;  // from here on, an interrupted batch says how it goes on
  BatchFolder folder(options.out, plan, options.resume);
  const std::vector<std::size_t> open = folder.TakeNotDone();
  if (options.resume && !context.quiet) {
    fmt::print("{} of {} were done before\n", plan.items.size() - open.size(), plan.items.size());
    std::fflush(stdout);
  }
  RunOpenItems(options, plan, context, open, folder);
  const std::size_t failed = WriteBatchResults(plan, folder, list);
  const std::string page = (options.out / "report.html").string();
  if (failed > 0) {
    throw WorkError(fmt::format("{} of {} items failed: {}", failed, plan.items.size(), page));
  }
  if (!context.quiet) fmt::print("{}\n", page);
}

}  // namespace

void AddBatch(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand("batch", "A command on many inputs, with a table of all");
  auto options = std::make_shared<BatchOptions>();
  command
      ->add_option("command", options->words,
                   "The command; a file of paths, one a line, or a glob in quotes; behind --, "
                   "options of the command for all items")
      ->required()
      ->type_name("COMMAND LIST [-- OPTIONS]");
  command->add_option("-o,--output", options->out, "Folder for the items' results and the table")
      ->required()
      ->type_name("OUT");
  command->add_option("--jobs", options->jobs, "Items at a time; as many as there are cores")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  command->add_option("--timeout", options->timeout_s, "Seconds after which an item is killed")
      ->check(CLI::PositiveNumber)
      ->type_name("SECONDS");
  command->add_flag("--resume", options->resume, "Go on with an interrupted batch");
  command->add_flag("--no-shared-files", options->no_shared_files,
                    "Under mpirun: the ranks send their results to the first one, also where they "
                    "see its folder");
  command->footer(
      "Example:\n  flextip batch diagnose recordings.txt -o diagnoses --jobs 2 -- "
      "--no-closed-loop\n");
  OnRun(*command, context, [options, &context] { RunBatch(*options, context); });
}

}  // namespace flextip
