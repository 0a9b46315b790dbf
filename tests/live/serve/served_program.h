// The program as a server in a process of its own.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace flextip {

class ServedProgram {
 public:
  /// Starts `flextip simulate ARGUMENTS` and waits for its port.
  explicit ServedProgram(const std::vector<std::string>& arguments);
  /// Ends it, if it still runs.
  ~ServedProgram();
  ServedProgram(const ServedProgram&) = delete;
  ServedProgram& operator=(const ServedProgram&) = delete;

  /// The port that it printed; 0 where it printed none.
  int port() const { return port_; }
  /// Sends Ctrl-C.
  void Interrupt() const;
  /// Reads its output to the end and returns the exit code, -1 after a signal.
  int Wait();
  /// Everything it printed.
  const std::string& out() const { return out_; }

 private:
  bool ReadMore();

  pid_t pid_ = -1;
  int pipe_ = -1, port_ = 0;
  std::string out_;
};

}  // namespace flextip
