// A server of files and of texts for watchers on 127.0.0.1: HTTP and WebSocket at one port.
// This header keeps to C++17, as its library does.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace flextip::live {

/// Returns whether this build has the library.
bool HasPage();

struct ServedFile {
  std::string_view path, type, text;  ///< "/page.css", "text/css; charset=utf-8", the content
};

/// Called from the server's own thread.
struct ServerHandlers {
  std::function<std::string()> hello;  ///< the first text for a new watcher
  /// Answers a watcher's text; nothing: the text is of no use, and the watcher is sent away.
  std::function<std::optional<std::string>(std::string_view text)> answer;
  std::function<void()> tick;  ///< called at the server's rate
  /// Told of an exception that another handler or the library threw; the server goes on.
  std::function<void(const char* what)> fault;
};

/// A watcher says what it has seen ({"seen": N}). Three messages at most are on their way to it;
/// what comes meanwhile it never gets: a slow watcher sees fewer, and no queue grows.
class PageServer {
 public:
  /// Serves `files` at once, "/" as "/index.html". Throws WorkError where the port is taken, or
  /// this build lacks the library.
  PageServer(int port, std::vector<ServedFile> files, ServerHandlers handlers, double rate_hz);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  int port() const;

  // From the handlers only.

  int Watchers() const;
  /// Sends a text or bytes with the number `n`, which grows, to the watchers that are ready.
  void SendText(long n, const std::string& text);
  void SendBytes(long n, const std::string& bytes);

 private:
  class Worker;
  std::unique_ptr<Worker> worker_;
};

/// Returns whether a request may be answered: it names this server as its host, and comes from no
/// page but this server's own (`origin` empty: from no page).
bool IsFromHere(std::string_view host, std::string_view origin, int port);

/// Returns whether both are equal, in a time that does not tell where they differ.
bool SameSecret(std::string_view a, std::string_view b);

}  // namespace flextip::live
