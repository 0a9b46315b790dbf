#include "tests/batch/work_of_tests.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace flextip::batch {
namespace {

void Sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

void LeaveAProcess(const std::string& file) {
  if (fork() != 0) return;
  Sleep(0.3);
  std::ofstream(file) << "still here\n";
  _exit(0);
}

}  // namespace

int DoAsTold(const Item& item, std::string& payload) {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  const std::string& what = item.arguments.at(0);
  if (what == "exit") return std::stoi(item.arguments.at(1));
  if (what == "throw") throw std::runtime_error("thrown by " + item.name);
  if (what == "segv") {
    signal(SIGSEGV, SIG_DFL);  // sanitizers have a handler of their own
    raise(SIGSEGV);
  }
  if (what == "abort") std::abort();
  if (what == "sleep") Sleep(std::stod(item.arguments.at(1)));
  if (what == "payload") payload = std::string(std::stoul(item.arguments.at(1)), 'x') + "\t\n\\t";
  if (what == "orphan") LeaveAProcess(item.arguments.at(1));
  if (what == "append") {
    const std::string line = item.name + "\n";
    const int file = open(item.arguments.at(1).c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    return write(file, line.data(), line.size()) == static_cast<ssize_t>(line.size()) ? 0 : 1;
  }
  return 0;
}

BatchTestFolder::BatchTestFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "flextip-XXXXXX").string();
  path_ = mkdtemp(name.data());
}

BatchTestFolder::~BatchTestFolder() {
  std::error_code error;
  std::filesystem::remove_all(path_, error);
}

}  // namespace flextip::batch
