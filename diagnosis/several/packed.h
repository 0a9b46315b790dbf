// Tasks of members and their answers as bytes, for processes on machines of one kind: numbers are
// as in memory.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/several/member_work.h"

namespace flextip::diagnosis {

std::string Pack(const std::vector<MemberTask>& tasks);
std::vector<MemberTask> UnpackTasks(const std::string& bytes);

std::string PackReply(const std::vector<MemberAnswer>& answers);
std::string PackRefusal(const std::string& why);
/// Throws WorkError with the reason of a refusal.
std::vector<MemberAnswer> UnpackReply(const std::string& bytes);

}  // namespace flextip::diagnosis
