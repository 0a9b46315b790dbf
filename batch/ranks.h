// Items over the ranks of an MPI job: rank 0 hands out, all of them work. Or rank 0 asks the others
// for parts of one work.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "batch/pool.h"
#include "batch/run.h"

namespace flextip::batch {

/// Whether mpirun (or srun) started this process, by its environment.
bool IsRank();
/// The number of this process among the ranks, by its environment; 0 where it is none.
int RankNumber();
/// The number of ranks, by the environment; 1 where it is none.
int RankCount();
/// How many ranks run on this machine, by the environment; 1 where it is not told.
int RanksOnThisMachine();
/// Makes this process none of the ranks: for the process of an item, which must not begin MPI.
void LeaveRanks();
/// Whether this program was built with MPI.
bool HasMpi();

/// Moves results from a rank that shares no files with rank 0.
struct Transfer {
  /// Returns the item's results as bytes, and removes them here. Called on the rank.
  std::function<std::string(const Outcome&)> pack;
  /// Puts them in their place. Called on rank 0 before it is told of the item.
  std::function<void(const Outcome&, const std::string& bytes)> unpack;
};

/// The MPI job, from its beginning to its end. One object a process, made after its Pool: a process
/// that has MPI must not fork. Without MPI in the program the constructor throws WorkError.
class Ranks {
 public:
  Ranks();
  ~Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;

  int size() const { return size_; }

  /// On all ranks: returns on each whether it sees the folder of rank 0's call, by a file that rank
  /// 0 writes there for the moment.
  bool SeesFolder(const std::string& folder) const;

  /// On rank 0: as RunItems of run.h, over all ranks. A rank asks for as many items as its pool has
  /// room for, and for another one with each that ends.
  void RunItems(Pool& pool, const std::vector<Item>& items, const Done& done,
                const Transfer& transfer) const;
  /// On the other ranks: works until rank 0 has nothing left. `begin` may change an item before it
  /// starts. Results are sent where `transfer.pack` is set.
  void Serve(Pool& pool, const std::function<void(Item&)>& begin, const Transfer& transfer) const;

  /// On rank 0: sends a text to each other rank, runs `meanwhile`, and returns the others' replies
  /// in order.
  std::vector<std::string> Ask(const std::vector<std::string>& texts,
                               const std::function<void()>& meanwhile) const;
  /// On rank 0: the others need not wait for questions any more.
  void StopAsking() const;
  /// On the other ranks: replies to what rank 0 asks until it has nothing left.
  void Answer(const std::function<std::string(const std::string&)>& reply) const;

  /// Ends the whole job.
  [[noreturn]] void Abort() const;

 private:
  int rank_ = 0, size_ = 1;
};

}  // namespace flextip::batch
