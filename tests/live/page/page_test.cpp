// The page of a session without a robot: who is served, what watchers are told, who may command.
#include "live/page/page.h"

#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/error.h"
#include "live/page/server.h"
#include "live/streams/streams.h"
#include "tests/live/page/watcher_client.h"
#include "tests/live/session/sample_session.h"

namespace flextip::live {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kToken = "0123456789abcdef0123456789abcdef";
constexpr int kMostTexts = 200;  // that come before the one waited for

struct ServedPage : testing::Test {
  std::optional<Session> session;
  std::vector<std::string> said;
  std::unique_ptr<Page> page;
  PageSnapshot snapshot;

  void SetUp() override { Serve(SessionText()); }

  void Serve(const std::string& session_text) {
    page.reset();
    session = ReadSession(WriteSession(session_text));
    PageOptions options;
    options.token = kToken;
    options.said = [this](TimeNs, const std::string& what) { said.push_back(what); };
    page = std::make_unique<Page>(*session, options);
    snapshot.record.inputs.t_ns = 1'700'000'000'123'456'789;
  }

  std::string Here() const { return HostOf(page->port()); }

  /// A cycle with the next number.
  void Cycle() {
    ++snapshot.cycles;
    snapshot.record.inputs.t_ns += 10'000'000;
    page->Take(snapshot);
  }

  /// The next text of a kind; everything before it is said to be seen. Null where it does not come.
  json Next(WatcherClient& watcher, const std::string& type) {
    for (int i = 0; i < kMostTexts; ++i) {
      const auto frame = watcher.Receive();
      if (!frame || frame->opcode == 8) return {};
      const json message = json::parse(frame->payload);
      if (message.contains("n"))
        watcher.Send("{\"seen\":" + std::to_string(message["n"].get<long>()) + "}");
      if (message["type"] == type) return message;
    }
    return {};
  }
  json Wish(WatcherClient& watcher, const std::string& what, const std::string& token) {
    watcher.Send(json{{"do", what}, {"token", token}}.dump());
    return Next(watcher, "answer");
  }
};

TEST_F(ServedPage, IsServedWithItsFiles) {
  const std::string page_text = Ask(page->port(), "/?token=anything", Here());
  EXPECT_THAT(page_text, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(page_text, HasSubstr("<script type=\"module\" src=\"/main.js\">"));
  EXPECT_THAT(page_text, HasSubstr("Content-Security-Policy: default-src 'none'"));
  EXPECT_THAT(page_text, HasSubstr("X-Frame-Options: DENY"));
  EXPECT_THAT(page_text, Not(HasSubstr(kToken)));
  EXPECT_THAT(Ask(page->port(), "/main.js", Here()), HasSubstr("text/javascript"));
  EXPECT_THAT(
      Ask(page->port(), "/page.css", "Host: localhost:" + std::to_string(page->port()) + "\r\n"),
      HasSubstr("text/css"));
  EXPECT_THAT(Ask(page->port(), "/../session.yaml", Here()), StartsWith("HTTP/1.1 404"));
  EXPECT_THAT(Ask(page->port(), "/", Here(), "POST"), StartsWith("HTTP/1.1 405"));
}

TEST_F(ServedPage, RefusesForeignHostsAndOrigins) {
  const std::string port = std::to_string(page->port());
  const std::vector<std::string> foreign = {
      "",
      "Host: evil.example\r\n",
      "Host: evil.example:" + port + "\r\n",
      "Host: 127.0.0.1\r\n",
      Here() + "Origin: http://evil.example\r\n",
      Here() + "Origin: null\r\n",
      Here() + "Origin: http://127.0.0.1:" + std::to_string(page->port() + 1) + "\r\n",
      Here() + "Origin: https://127.0.0.1:" + port + "\r\n",
      Here() + "Origin: http://127.0.0.1:" + port + ".evil.example\r\n",
  };
  for (const std::string& headers : foreign) {
    EXPECT_THAT(Ask(page->port(), "/", headers), Not(HasSubstr("200 OK"))) << headers;
    EXPECT_NE(WatcherClient(page->port(), headers).status(), 101) << headers;
  }
  EXPECT_EQ(WatcherClient(page->port(), Here() + "Origin: http://evil.example\r\n").status(), 403);
  EXPECT_EQ(
      WatcherClient(page->port(), Here() + "Origin: http://127.0.0.1:" + port + "\r\n").status(),
      101);
}

TEST_F(ServedPage, TellsNumbersToTheLastBit) {
  CycleOutputs& outputs = snapshot.record.outputs;
  outputs.has_command = true;
  outputs.p_RW_command = {0.1 + 0.2, -1.0 / 3.0, std::nextafter(0.3, 1.0)};
  outputs.p_RE = {M_PI * 1e-3, 5e-324, -0.0};
  outputs.p_RE_goal = Eigen::Vector3d(1e300, 0.1, 2.2250738585072014e-308);
  snapshot.on_path = true;
  snapshot.deviation_m = 1.0 / 7.0;
  WatcherClient watcher(page->port(), Here());
  Cycle();
  const json state = Next(watcher, "state");
  EXPECT_EQ(state["t_ns"], std::to_string(snapshot.record.inputs.t_ns));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(state["command_m"][i].get<double>(), outputs.p_RW_command[i]);
    EXPECT_EQ(state["tip_m"][i].get<double>(), outputs.p_RE[i]);
    EXPECT_EQ(state["goal_m"][i].get<double>(), (*outputs.p_RE_goal)[i]);
  }
  EXPECT_EQ(state["deviation_m"].get<double>(), snapshot.deviation_m);
}

/// As the holds count it: age beyond the latency.
TEST_F(ServedPage, TellsTheAgeAtWhichAStreamIsStale) {
  std::string text = SessionText();
  text.replace(text.find("moment_noise_Nm"), 0, "stale_s: 0.25, latency_s: 0.125, ");
  Serve(text);
  WatcherClient watcher(page->port(), Here());
  Cycle();
  const json streams = Next(watcher, "state")["streams"];
  ASSERT_EQ(streams.size(), 3u);
  EXPECT_EQ(streams[0]["limit_s"], 0.1);
  EXPECT_EQ(streams[2]["name"], "strain0");
  EXPECT_EQ(streams[2]["limit_s"], 0.375);
}

TEST_F(ServedPage, OnlyItsTokenCommands) {
  WatcherClient watcher(page->port(), Here());
  Cycle();
  const CrtkOperatingState enabled{CrtkState::kEnabled, true, false};
  const auto next = [&] {
    return page->operators().Next(snapshot.record.inputs.t_ns,
                                  Arrived<CrtkOperatingState>{1, 1, enabled}, {});
  };
  std::string almost = kToken;
  almost.back() = 'e';
  for (const std::string& token :
       {std::string(), std::string("0"), almost, kToken + std::string("0")}) {
    for (const char* what : {"pause", "enable", "stop"}) {
      const json answer = Wish(watcher, what, token);
      EXPECT_EQ(answer["accepted"], false);
      EXPECT_EQ(answer["why"], "token");
    }
  }
  EXPECT_FALSE(page->operators().StopWanted());
  EXPECT_FALSE(next());
  EXPECT_TRUE(said.empty());
  EXPECT_EQ(Wish(watcher, "pause", kToken)["accepted"], true);
  EXPECT_EQ(next(), CrtkCommand::kPause);
  EXPECT_EQ(Wish(watcher, "stop", kToken)["accepted"], true);
  EXPECT_TRUE(page->operators().StopWanted());
  EXPECT_THAT(said,
              testing::ElementsAre("a person at the page: pause", "a person at the page: stop"));
}

TEST_F(ServedPage, SendsThoseAwayWhoSayNothingOfUse) {
  Cycle();
  const std::vector<std::pair<std::string, int>> useless = {
      {"garbage", 1},
      {"{\"do\":\"disable\",\"token\":\"" + std::string(kToken) + "\"}", 1},
      {"[[[[[[", 1},
      {"{\"seen\":99999}", 1},
      {"{\"seen\":-1}", 1},
      {"", 1},
      {std::string(400, '['), 1},
      {"bytes", 2},
  };
  for (const auto& [text, opcode] : useless) {
    WatcherClient watcher(page->port(), Here());
    ASSERT_EQ(watcher.status(), 101);
    watcher.Send(text, opcode);
    std::optional<WatcherClient::Frame> frame;
    while ((frame = watcher.Receive()) && frame->opcode != 8) {
    }
    ASSERT_TRUE(frame) << text;
    EXPECT_EQ(frame->CloseCode(), 1008) << text;
  }
  WatcherClient watcher(page->port(), Here());
  EXPECT_EQ(Next(watcher, "state")["type"], "state");  // it goes on
}

TEST_F(ServedPage, RefusesLongFramesBeforeTheyCome) {
  Cycle();
  const std::string sixteen_gigabytes("\x81\xff\0\0\0\4\0\0\0\0\0\0\0\0", 14);
  const std::string thousand("\x81\xfe\x03\xe8\0\0\0\0", 8);
  for (const std::string& head : {sixteen_gigabytes, thousand}) {
    WatcherClient watcher(page->port(), Here());
    watcher.SendBytes(head);
    std::optional<WatcherClient::Frame> frame;
    while ((frame = watcher.Receive()) && frame->opcode != 8) {
    }
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->CloseCode(), 1009);
  }
}

/// Whoever does not say what it has seen is sent three states, however long it waits.
TEST_F(ServedPage, ASlowWatcherIsSentNoQueue) {
  WatcherClient slow(page->port(), Here()), quick(page->port(), Here());
  long newest_of_quick = 0;
  {
    const std::jthread cycles([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        Cycle();
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    });
    for (int i = 0; i < 20; ++i) newest_of_quick = Next(quick, "state").value("n", 0L);
  }
  EXPECT_GE(newest_of_quick, 20);
  int seen_by_slow = 0;
  long last = 0;
  for (auto frame = slow.Receive(0.3); frame && frame->opcode == 1; frame = slow.Receive(0.3)) {
    const json message = json::parse(frame->payload);
    if (message["type"] != "state") continue;
    ++seen_by_slow;
    last = message["n"];
  }
  EXPECT_EQ(seen_by_slow, 3);
  EXPECT_LT(last, newest_of_quick - 10);
  slow.Send("{\"seen\":" + std::to_string(last) + "}");
  const json newest = Next(slow, "state");
  EXPECT_GT(newest.value("n", 0L), newest_of_quick);
  EXPECT_EQ(newest["cycles"], snapshot.cycles);
}

/// States of many numbers are on their way all the time; no answer is lost between them.
TEST_F(ServedPage, AnswersEveryWish) {
  WatcherClient watcher(page->port(), Here());
  Cycle();
  ASSERT_TRUE(Next(watcher, "state").is_object());
  for (int i = 0; i < 300; ++i) watcher.Send(json{{"do", "stop"}, {"token", ""}}.dump());
  for (int i = 0; i < 300; ++i) ASSERT_EQ(Next(watcher, "answer")["accepted"], false) << i;
}

TEST_F(ServedPage, HasRoomForEightWatchers) {
  Cycle();
  std::vector<std::unique_ptr<WatcherClient>> watchers;
  for (int i = 0; i < 8; ++i) {
    watchers.push_back(std::make_unique<WatcherClient>(page->port(), Here()));
    EXPECT_EQ(watchers.back()->status(), 101);
  }
  EXPECT_EQ(WatcherClient(page->port(), Here()).status(), 503);
}

TEST_F(ServedPage, TellsItsEventsAndItsEnd) {
  Cycle();
  page->TakeEvent(5, "peer \xff gone");  // no UTF-8
  WatcherClient watcher(page->port(), Here());
  snapshot.record.outputs.hold = Hold::kStaleTip;
  Cycle();
  std::string events;
  for (int i = 0; i < 5; ++i) events += Next(watcher, "state")["events"].dump();
  EXPECT_THAT(events, HasSubstr("gone"));
  EXPECT_THAT(events, HasSubstr("stale_tip"));
  const std::jthread end([&] { page->End(true); });
  json state = Next(watcher, "state");
  for (int i = 0; i < 20 && state["end"] == ""; ++i) state = Next(watcher, "state");
  EXPECT_EQ(state["end"], "done");
}

TEST_F(ServedPage, ATakenPortIsSaid) {
  PageOptions options;
  options.port = page->port();
  EXPECT_THROW(Page(*session, options), WorkError);
}

TEST_F(ServedPage, TheAddressHasAnotherTokenEachTime) {
  const Page one(*session, {}), other(*session, {});
  const auto token = [](const Page& p) { return p.Address().substr(p.Address().find('=') + 1); };
  EXPECT_EQ(token(one).size(), 32u);
  EXPECT_NE(token(one), token(other));
  EXPECT_THAT(page->Address(), HasSubstr(kToken));
}

}  // namespace
}  // namespace flextip::live
