// The process that forks items (pool.h), and the messages between it and its pool.
#pragma once

#include <optional>
#include <string>

#include "batch/pool.h"

namespace flextip::batch {

/// Serves requests on `socket` until its other end is closed, then kills what is at work and ends
/// the process. A request is a message of an index, a tab and Pack(item); an answer has
/// Pack(outcome).
[[noreturn]] void ServeItems(int socket, const Work& work, double timeout_s);

/// Sends a message: its length in four bytes, then itself. Returns whether the other end has it.
bool SendMessage(int socket, const std::string& message);

/// Takes the first whole message off `received`; nothing where there is none yet.
std::optional<std::string> TakeMessage(std::string& received);

/// Returns "INDEX\tTEXT", and both of such a message.
std::string WithIndex(std::size_t index, const std::string& text);
std::pair<std::size_t, std::string> IndexAndText(const std::string& message);

}  // namespace flextip::batch
