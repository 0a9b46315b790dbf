// Processes that share the work on several recordings.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "diagnosis/diagnose.h"

namespace flextip::diagnosis {

struct NamedRecording;
class Fleet;

/// Processes that have read the same recordings, each with a MemberServer.
struct Helpers {
  int count = 0;
  /// Sends a request to each, runs `meanwhile` here, and returns their replies in order.
  std::function<std::vector<std::string>(const std::vector<std::string>& requests,
                                         const std::function<void()>& meanwhile)>
      ask;
};

/// What a helper is: it works on its members as it is asked to.
class MemberServer {
 public:
  /// Throws as DiagnoseSeveral does. `options` are those of the process that asks.
  MemberServer(const std::vector<NamedRecording>& recordings, const DiagnoseOptions& options);
  ~MemberServer();

  /// Returns the reply to a request. Work that failed is told in the reply: the process that asked
  /// throws it.
  std::string Reply(const std::string& request);

  /// The reply of a helper that cannot work.
  static std::string Refusal(const std::string& why);

 private:
  std::unique_ptr<Fleet> fleet_;
  const DiagnoseOptions options_;
};

}  // namespace flextip::diagnosis
