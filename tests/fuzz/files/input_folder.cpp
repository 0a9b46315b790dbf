#include "tests/fuzz/files/input_folder.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include "core/error.h"

namespace flextip {

InputFolder::InputFolder() {
  std::error_code error;
  const std::filesystem::path memory = "/dev/shm";
  const bool has_memory = std::filesystem::is_directory(memory, error);
  std::string name =
      ((has_memory ? memory : std::filesystem::temp_directory_path()) / "flextip-fuzz-XXXXXX")
          .string();
  Require(mkdtemp(name.data()) != nullptr);
  path_ = name;
}

InputFolder::~InputFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path InputFolder::Write(const std::string& name, std::string_view text) const {
  const std::filesystem::path file = path_ / name;
  if (!std::filesystem::exists(file.parent_path()))
    std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary).write(text.data(), std::streamsize(text.size()));
  return file;
}

void Require(bool holds) {
  if (!holds) std::abort();
}

bool ReadsOrRefuses(const std::function<void()>& read) {
  try {
    read();
    return true;
  } catch (const InputError& error) {
    const std::string_view message = error.what();
    Require(!message.empty());
    for (const char c : message) Require(static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
    return false;
  }
}

std::string_view TextOf(std::span<const std::uint8_t> input) {
  return {reinterpret_cast<const char*>(input.data()), input.size()};
}

std::vector<std::string_view> PartsOf(std::span<const std::uint8_t> input) {
  constexpr std::string_view kBetween = "====\n";
  std::string_view rest = TextOf(input);
  std::vector<std::string_view> parts;
  for (;;) {
    const auto at = rest.find(kBetween);
    parts.push_back(rest.substr(0, at));
    if (at == std::string_view::npos) return parts;
    rest.remove_prefix(at + kBetween.size());
  }
}

}  // namespace flextip
