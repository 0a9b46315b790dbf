// In the place of ranks.cpp where there is no MPI.
#include <cstdlib>

#include "batch/ranks.h"
#include "core/error.h"

namespace flextip::batch {

bool HasMpi() { return false; }

Ranks::Ranks() { throw WorkError("this program was built without MPI"); }
Ranks::~Ranks() = default;
bool Ranks::SeesFolder(const std::string&) const { return false; }
void Ranks::RunItems(Pool&, const std::vector<Item>&, const Done&, const Transfer&) const {}
void Ranks::Serve(Pool&, const std::function<void(Item&)>&, const Transfer&) const {}
std::vector<std::string> Ranks::Ask(const std::vector<std::string>&,
                                    const std::function<void()>&) const {
  return {};
}
void Ranks::StopAsking() const {}
void Ranks::Answer(const std::function<std::string(const std::string&)>&) const {}
void Ranks::Abort() const { std::abort(); }

}  // namespace flextip::batch
