// The web server against clients of all sorts, on real sockets; time is in the test's hand.
#include "http/web_server.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <iterator>
#include <map>

#include "http/host_check.h"
#include "no_descriptors.h"
#include "peer.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

// Counts from 0 in lines, for as many bytes as a path asks for: "/100". Other paths are not there.
class CountingSite final : public WebSite {
 public:
  WebAnswer begin(std::size_t reader, std::string_view path) override {
    paths.emplace_back(path);
    ++begun;
    left_[reader] = static_cast<std::size_t>(std::atoll(std::string(path.substr(1)).c_str()));
    if (left_[reader] == 0) return {.status = web_status::not_found};
    return {.media_type = "text/plain", .version = 0xabcd};
  }
  std::size_t read(std::size_t reader, std::span<char> out) override {
    const std::size_t count = std::min(left_[reader], out.size());
    std::fill_n(out.begin(), count, 'x');
    left_[reader] -= count;
    return count;
  }
  void end(std::size_t) override { ++ended; }

  std::vector<std::string> paths;
  std::uint32_t begun = 0;
  std::uint32_t ended = 0;

 private:
  std::map<std::size_t, std::size_t> left_;
};

class WebServerTest : public testing::Test {
 protected:
  // A client that has sent `request`.
  FileDescriptor client(const std::string& request) {
    FileDescriptor socket = connect_tcp(server_.address());
    EXPECT_TRUE(turn_until([&] { return is_writable(socket.get()); }));
    send(socket.get(), request);
    return socket;
  }
  static bool is_writable(int descriptor) {
    pollfd waiting{.fd = descriptor, .events = POLLOUT, .revents = 0};
    return ::poll(&waiting, 1, 0) == 1;
  }
  // Closed by the server, politely or not.
  static bool is_gone(int descriptor) {
    char byte;
    const ssize_t count = ::recv(descriptor, &byte, 1, MSG_DONTWAIT | MSG_PEEK);
    return count == 0 || (count < 0 && errno == ECONNRESET);
  }
  static void send(int descriptor, const std::string& text) {
    ASSERT_EQ(::send(descriptor, text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }

  void turn() {
    server_.advance(now_);
    loop_.wait(std::clamp<Duration>(server_.next_deadline() - now_, 0ms, 5ms));
  }
  testing::AssertionResult turn_until(const std::function<bool()>& condition) {
    const SteadyClock clock;
    const Instant end = clock.now() + patience;
    while (!condition()) {
      if (clock.now() > end) return testing::AssertionFailure() << "it never came";
      turn();
    }
    return testing::AssertionSuccess();
  }

  // Everything until `ending` has come or the server has closed.
  std::string receive(int descriptor, const std::string& ending = "\r\n0\r\n\r\n") {
    Bytes bytes;
    std::string text;
    EXPECT_TRUE(turn_until([&] {
      receive_available(descriptor, bytes);
      text.assign(bytes.begin(), bytes.end());
      return text.ends_with(ending) || is_gone(descriptor);
    })) << text.substr(0, 500);
    return text;
  }
  std::string get(const std::string& path) {
    const FileDescriptor socket = client("GET " + path + " HTTP/1.1\r\nHost: gateway\r\n\r\n");
    return receive(socket.get());
  }

  EventLoop loop_;
  CountingSite site_;
  ServiceCounters counters_;
  WebServer server_{
      loop_, site_, {.listen = {.host = 0x7f000001, .port = 0}, .clients_max = 8}, counters_};
  Instant now_{1h};
};

TEST_F(WebServerTest, AnAnswerHasItsContentAndItsHeaders) {
  const std::string answer = get("/100");
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200 OK\r\n")) << answer;
  EXPECT_NE(answer.find("\r\nContent-Type: text/plain\r\n"), std::string::npos);
  EXPECT_NE(answer.find("\r\nETag: \"abcd\"\r\n"), std::string::npos);
  EXPECT_NE(answer.find("\r\nContent-Security-Policy: default-src 'self'"), std::string::npos);
  EXPECT_EQ(std::count(answer.begin(), answer.end(), 'x'), 100 + 1) << "one is in a header";
}

TEST_F(WebServerTest, AConnectionServesOneRequestAfterTheOther) {
  const FileDescriptor socket = client("GET /10 HTTP/1.1\r\nHost: a\r\n\r\n");
  receive(socket.get());
  send(socket.get(), "GET /20 HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_NE(receive(socket.get()).find(std::string(20, 'x')), std::string::npos);
  EXPECT_EQ(site_.begun, 2u);
  EXPECT_TRUE(turn_until([&] { return site_.ended == 2; }));
  EXPECT_EQ(counters_.clients, 1u);
}

TEST_F(WebServerTest, WhoIsNotAllowedIsTurnedAway) {
  const FileDescriptor before = client("GET /10 HTTP/1.1\r\nHost: a\r\n\r\n");
  receive(before.get());
  KeptLog log;
  server_.allow({{.host = 0x0a000000, .prefix = 8}}, log, "/etc/etcm/gateway.toml, line 12");
  EXPECT_TRUE(turn_until([&] { return is_gone(before.get()) && counters_.clients == 0; }));
  const FileDescriptor after = client("GET /10 HTTP/1.1\r\nHost: a\r\n\r\n");
  const std::string answer = receive(after.get());
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 403 Forbidden\r\n")) << answer;
  EXPECT_NE(answer.find("allow = [\"10.0.0.0/8\", \"127.0.0.1\"]"), std::string::npos) << answer;
  EXPECT_NE(answer.find("below\n`listen` of [http] in /etc/etcm/gateway.toml, line 12, in "),
            std::string::npos);
  EXPECT_NE(answer.find("Ask whoever looks after the gateway"), std::string::npos);
  EXPECT_EQ(answer.find("xxx"), std::string::npos);
  EXPECT_EQ(site_.begun, 1u);
  EXPECT_EQ(counters_.rejected, 2u);
  ASSERT_EQ(log.lines.size(), 1u);
  EXPECT_EQ(log.lines[0],
            "a browser at 127.0.0.1 is rejected: its network is not in allow of [http]; add it "
            "there if it may see everything");
  server_.allow({this_machine}, log);
  EXPECT_TRUE(get("/10").starts_with("HTTP/1.1 200 OK\r\n"));
}

// A browser opens connections in advance. An answer that lies there would be taken for that to the
// next question, when its address is let in by then.
TEST_F(WebServerTest, WhoIsNotAllowedAndHasNotAskedIsToldNothing) {
  KeptLog log;
  server_.allow({{.host = 0x0a000000, .prefix = 8}}, log);
  const FileDescriptor early = client("");
  EXPECT_TRUE(turn_until([&] { return counters_.rejected == 1; }));
  const FileDescriptor gone = client("");
  EXPECT_TRUE(turn_until([&] { return counters_.rejected == 2; }));
  char byte;
  EXPECT_LT(::recv(early.get(), &byte, 1, MSG_DONTWAIT), 0);
  EXPECT_EQ(errno, EAGAIN);
  send(early.get(), "GET /10 HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_TRUE(receive(early.get()).starts_with("HTTP/1.1 403 Forbidden\r\n"));
  now_ += Farewell::time;
  server_.advance(now_);
  EXPECT_TRUE(turn_until([&] { return is_gone(gone.get()); }));
}

// Who keeps its end open, or asks again and again, holds a few descriptors for two seconds.
TEST_F(WebServerTest, WhoIsNotAllowedHoldsNothingForLong) {
  KeptLog log;
  server_.allow({{.host = 0x0a000000, .prefix = 8}}, log);
  const auto open_files = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
  };
  const auto before = open_files();
  std::vector<FileDescriptor> stubborn;
  for (int i = 0; i < 12; ++i) stubborn.push_back(client("GET /10 HTTP/1.1\r\nHost: a\r\n\r\n"));
  EXPECT_TRUE(turn_until([&] { return counters_.rejected == 12; }));
  const auto kept = static_cast<std::ptrdiff_t>(stubborn.size() + Farewell::places);
  EXPECT_LE(open_files(), before + kept);
  EXPECT_LE(server_.next_deadline(), now_ + Farewell::time);
  now_ += Farewell::time;
  server_.advance(now_);
  EXPECT_EQ(open_files(), before + 12);
  EXPECT_EQ(counters_.clients, 0u);
}

TEST(HostCheck, KnowsAddressesAndItsOwnNames) {
  const std::vector<std::string> names{"etcm.example", "north"};
  for (const char* const known :
       {"127.0.0.1", "127.0.0.1:8080", "192.0.2.7", "[::1]", "[2001:db8::1]:8080",
        "[fe80::1%25eth0]:80", "localhost", "LocalHost:80", "etcm.example", "ETCM.Example:8080",
        "etcm.example.", "north:1"}) {
    EXPECT_TRUE(check_host(known, names).is_known) << known;
  }
  for (const char* const unknown :
       {"", "evil.example", "etcm.example.evil.example", "xetcm.example", "localhost.evil.example",
        "127.0.0.1.evil.example", "127.1", "0x7f.1", "2130706433", "127.0.0.1:", "[::1", "a b",
        "north:99999", "<script>", "127.0.0.1, evil.example"}) {
    EXPECT_FALSE(check_host(unknown, names).is_known) << unknown;
  }
  EXPECT_EQ(check_host("Evil.Example.:8080", names).name, "evil.example");
  EXPECT_EQ(check_host("<script>", names).name, "");
  EXPECT_FALSE(check_host("etcm.example", {}).is_known);
}

// A page of another site whose name leads here by now: the browser says whose page asks.
TEST_F(WebServerTest, WhoAsksByANameOfAnotherSiteIsToldNothingButWhy) {
  KeptLog log;
  server_.allow({everybody}, log);
  server_.expect_names({"gateway"});
  EXPECT_TRUE(get("/10").starts_with("HTTP/1.1 200 OK\r\n"));
  const auto ask = [&](const std::string& headers, const std::string& method = "GET") {
    const FileDescriptor socket = client(method + " /10 HTTP/1.1\r\n" + headers + "\r\n");
    return receive(socket.get(), "nothing.\n");
  };
  const std::string answer = ask("Host: Evil.example:8080\r\n");
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 421 ")) << answer;
  EXPECT_NE(answer.find("was asked for, evil.example.\n"), std::string::npos) << answer;
  EXPECT_NE(answer.find("names = [\"evil.example\"]"), std::string::npos) << answer;
  EXPECT_NE(answer.find("\r\nX-Content-Type-Options: nosniff\r\n"), std::string::npos);
  EXPECT_NE(answer.find("\r\nContent-Type: text/plain"), std::string::npos);
  EXPECT_EQ(answer.find("xxxxxxxxxx"), std::string::npos);
  ASSERT_EQ(log.lines.size(), 1u);
  EXPECT_EQ(log.lines[0],
            "a browser at 127.0.0.1 asks for the page by the name evil.example and is told "
            "nothing: add it to names of [http] if it is right; else another site tries to read "
            "the page through that browser");
  // Whatever stands beside it, and whatever it asks.
  EXPECT_TRUE(ask("Host: gateway\r\nHost: evil.example\r\n").starts_with("HTTP/1.1 4"));
  EXPECT_TRUE(ask("Host: evil.example\r\nHost: gateway\r\n").starts_with("HTTP/1.1 4"));
  EXPECT_TRUE(ask("hOsT: evil.example\r\n", "POST").starts_with("HTTP/1.1 421 "));
  const std::string odd = ask("Host: <script>\r\n");
  EXPECT_TRUE(odd.starts_with("HTTP/1.1 421 ")) << odd;
  EXPECT_EQ(odd.find("script"), std::string::npos) << odd;
  EXPECT_EQ(site_.begun, 1u);
  EXPECT_GE(counters_.rejected, 3u);
  server_.expect_names({"evil.example"});
  EXPECT_TRUE(ask("Host: gateway\r\n").starts_with("HTTP/1.1 421 ")) << "the names are others";
}

TEST_F(WebServerTest, AClientOfOldWithoutAHostIsServed) {
  server_.expect_names({});
  const FileDescriptor socket = client("GET /10 HTTP/1.0\r\n\r\n");
  EXPECT_NE(receive(socket.get(), "xxxxxxxxxx").find("200 OK"), std::string::npos);
}

TEST_F(WebServerTest, ABrowserOfIpv6IsServedAsItIsAllowed) {
  WebServer both(loop_, site_, {.listen = {.host = loopback_ipv6, .port = 0}, .clients_max = 2},
                 counters_);
  KeptLog log;
  both.allow({this_machine}, log);
  const auto turn_both_until = [&](const std::function<bool()>& condition) {
    return port::turn_until(loop_, [&] {
      both.advance(now_);
      return condition();
    });
  };
  const FileDescriptor stranger = connect_tcp(both.address());
  ASSERT_TRUE(turn_both_until([&] { return log.lines.size() == 1; }));
  EXPECT_TRUE(log.lines[0].starts_with("a browser at ::1 is rejected")) << log.lines[0];
  both.allow({{.host = loopback_ipv6, .prefix = 128}}, log);
  const FileDescriptor browser = connect_tcp(both.address());
  EXPECT_TRUE(turn_both_until([&] { return is_writable(browser.get()); }));
  send(browser.get(), "GET /10 HTTP/1.1\r\nHost: a\r\n\r\n");
  Bytes answer;
  EXPECT_TRUE(turn_both_until([&] {
    receive_available(browser.get(), answer);
    return !answer.empty();
  }));
  EXPECT_TRUE(std::string(answer.begin(), answer.end()).starts_with("HTTP/1.1 200 OK"));
}

TEST_F(WebServerTest, WhatTheClientHasIsNotSentAgain) {
  const FileDescriptor socket =
      client("GET /1000 HTTP/1.1\r\nHost: a\r\nIf-None-Match: \"abcd\"\r\n\r\n");
  EXPECT_TRUE(receive(socket.get(), "\r\n\r\n").starts_with("HTTP/1.1 304 Not Modified\r\n"));
  EXPECT_EQ(site_.ended, 1u);
}

TEST_F(WebServerTest, WhatAProxyHasMadeOfATagIsThatTag) {
  const auto first_line = [&](const std::string& tags) {
    const FileDescriptor socket =
        client("GET /1000 HTTP/1.1\r\nHost: a\r\nIf-None-Match: " + tags + "\r\n\r\n");
    const std::string answer = receive(socket.get(), "\r\n\r\n");
    return answer.substr(0, answer.find('\r'));
  };
  for (const char* known : {"W/\"abcd\"", "\"1\", \"abcd\"", "\"1\",W/\"abcd\" , \"2\"", "*"}) {
    EXPECT_EQ(first_line(known), "HTTP/1.1 304 Not Modified") << known;
  }
  for (const char* unknown : {"abcd", "\"abc\"", "\"abcde\", \"1\"", ",", "W/", "W/*\""}) {
    EXPECT_EQ(first_line(unknown), "HTTP/1.1 200 OK") << unknown;
  }
}

TEST_F(WebServerTest, HeadHasNoContent) {
  const FileDescriptor socket = client("HEAD /100 HTTP/1.1\r\nHost: a\r\n\r\n");
  const std::string answer = receive(socket.get(), "until it hangs up");
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200 OK\r\n"));
  EXPECT_EQ(answer.find("\r\n\r\n"), answer.size() - 4) << "not even a last chunk";
}

TEST_F(WebServerTest, OtherMethodsAreRefusedAndReachNobody) {
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "TRACE", "get", "X"}) {
    const FileDescriptor socket = client(std::string(method) + " /10 HTTP/1.1\r\nHost: a\r\n\r\n");
    EXPECT_TRUE(receive(socket.get(), "\r\n\r\n").starts_with("HTTP/1.1 405 ")) << method;
  }
  EXPECT_EQ(site_.begun, 0u);
  EXPECT_EQ(counters_.rejected, 7u);
}

TEST_F(WebServerTest, APathIsOnlyEverText) {
  for (const char* path : {"/../../etc/passwd", "/..%2f..%2fetc%2fpasswd", "/%00", "/%zz", "//"}) {
    const std::string answer = get(path);
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 404 ") || answer.starts_with("HTTP/1.1 400 "))
        << path << ": " << answer.substr(0, 100);
  }
}

TEST_F(WebServerTest, ContentOfAQuestionMeansNothing) {
  const FileDescriptor socket =
      client("GET /10 HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\n\r\nhello");
  EXPECT_TRUE(receive(socket.get()).starts_with("HTTP/1.1 200 OK\r\n"));
  send(socket.get(), "GET /20 HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_NE(receive(socket.get()).find(std::string(20, 'x')), std::string::npos);
  EXPECT_EQ(site_.paths, (std::vector<std::string>{"/10", "/20"}));
}

// Of the same time as any other request.
TEST_F(WebServerTest, ContentWithoutEndRunsOutOfTime) {
  const FileDescriptor socket =
      client("GET /10 HTTP/1.1\r\nHost: a\r\nContent-Length: 999999999\r\n\r\n");
  for (int i = 0; i < 100 && !is_gone(socket.get()); ++i) {
    static_cast<void>(::send(socket.get(), "hello", 5, MSG_NOSIGNAL));
    turn();
    now_ += 1s;
  }
  EXPECT_TRUE(turn_until([&] { return is_gone(socket.get()); }));
  EXPECT_EQ(site_.begun, 0u);
}

TEST_F(WebServerTest, APathDoesNotEndAtANul) {
  get("/%31%30");
  get("/10%00.html");
  EXPECT_EQ(site_.paths, (std::vector<std::string>{"/10", "/10%00.html"}));
}

TEST_F(WebServerTest, WhatIsNoHttpCostsTheConnection) {
  for (const std::string& garbage :
       {std::string("\x16\x03\x01\x02\x00\x01\x00\r\n\r\n", 11), std::string("GET\r\n\r\n"),
        std::string("\r\n\r\n\r\n\r\n"), std::string("GET /10 HTTP/9.9\r\n\r\n"),
        "GET /10 HTTP/1.1\r\nContent-Length: -5\r\nHost: a\r\n\r\n" + std::string(64, '\0')}) {
    const FileDescriptor socket = client(garbage);
    // Whatever it is told, it is gone when its time is up.
    for (int i = 0; i < 20; ++i) turn();
    now_ += 2min;
    EXPECT_TRUE(turn_until([&] {
      Bytes bytes;
      receive_available(socket.get(), bytes);
      return is_gone(socket.get());
    }));
  }
  EXPECT_NE(get("/10").find("xxxxxxxxxx"), std::string::npos);
}

TEST_F(WebServerTest, AHugeHeaderIsRefused) {
  const FileDescriptor socket = client("GET /10 HTTP/1.1\r\nHost: a\r\nCookie: ");
  const std::string more(4096, 'c');
  std::size_t sent = 0;
  EXPECT_TRUE(turn_until([&] {
    // The server may close meanwhile.
    if (sent < 100'000 && ::send(socket.get(), more.data(), more.size(), MSG_NOSIGNAL) > 0) {
      sent += more.size();
    }
    Bytes bytes;
    receive_available(socket.get(), bytes);
    return is_gone(socket.get());
  }));
  EXPECT_EQ(site_.begun, 0u);
}

TEST_F(WebServerTest, ARequestThatDripsInRunsOutOfTime) {
  const FileDescriptor slow = client("GET /10 HTTP/1.1\r\n");
  for (int i = 0; i < 20 && !is_gone(slow.get()); ++i) {
    ::send(slow.get(), "A: b\r\n", 6, MSG_NOSIGNAL);
    now_ += 1s;
    for (int turns = 0; turns < 3; ++turns) turn();
  }
  EXPECT_TRUE(is_gone(slow.get()));
  EXPECT_EQ(counters_.clients, 0u);
  EXPECT_EQ(counters_.rejected, 1u);
}

TEST_F(WebServerTest, ASlowReaderHoldsUpNobodyAndIsClosedInTheEnd) {
  constexpr std::size_t much = 50'000'000;
  const FileDescriptor slow =
      client("GET /" + std::to_string(much) + " HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_TRUE(turn_until([&] { return site_.begun == 1; }));
  // Nothing can be done for it, so nothing is.
  EXPECT_TRUE(turn_until([&] { return server_.next_deadline() > now_; }));
  EXPECT_NE(get("/10").find("xxxxxxxxxx"), std::string::npos);
  now_ += 61s;
  EXPECT_TRUE(turn_until([&] { return counters_.clients == 0; }));
  EXPECT_EQ(site_.ended, site_.begun);
}

TEST_F(WebServerTest, AnIdleConnectionIsClosed) {
  const FileDescriptor idle = client("");
  EXPECT_TRUE(turn_until([&] { return counters_.clients == 1; }));
  now_ += 14s;
  turn();
  EXPECT_EQ(counters_.clients, 1u);
  now_ += 2s;
  EXPECT_TRUE(turn_until([&] { return counters_.clients == 0; }));
  EXPECT_TRUE(turn_until([&] { return server_.next_deadline() == never; }));
}

TEST_F(WebServerTest, MoreClientsThanThereIsRoomForComeLater) {
  std::vector<FileDescriptor> idle;
  for (std::uint8_t host = 1; host <= 100; ++host) {
    idle.push_back(connect_from(host, server_.address()));
    idle.push_back(connect_from(host, server_.address()));
  }
  for (int i = 0; i < 20; ++i) turn();
  EXPECT_EQ(counters_.clients, 8u);
  // They have nothing to say, so their time ends, again and again.
  const FileDescriptor last = client("GET /10 HTTP/1.1\r\nHost: a\r\n\r\n");
  Bytes bytes;
  EXPECT_TRUE(turn_until([&] {
    now_ += 1s;
    receive_available(last.get(), bytes);
    return bytes.size() > 10;
  }));
  EXPECT_LE(counters_.clients, 8u);
}

// Clients that say nothing for as long as they may, each followed by another one.
TEST_F(WebServerTest, OneAddressDoesNotKeepAllOthersOut) {
  KeptLog log;
  server_.allow({everybody}, log);
  std::vector<FileDescriptor> slow;
  for (int i = 0; i < 200; ++i) slow.push_back(connect_from(2, server_.address()));
  const FileDescriptor visitor = client("GET /10 HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_NE(receive(visitor.get()).find("xxxxxxxxxx"), std::string::npos) << "at once";
  EXPECT_EQ(counters_.clients, 7u);
  EXPECT_EQ(counters_.rejected, 194u);
  EXPECT_TRUE(is_gone(slow.back().get()));
  ASSERT_EQ(log.lines.size(), 194u);
  EXPECT_EQ(log.lines[0],
            "a browser at 127.0.0.2 is rejected: it has 6 connections, as many as one address may "
            "have of clients_max in [http]; raise that if it is a proxy");
  // Whose connections end may have others.
  slow.clear();
  EXPECT_TRUE(turn_until([&] {
    now_ += 1s;
    return counters_.clients <= 1;
  }));
  const FileDescriptor again = connect_from(2, server_.address());
  send(again.get(), "GET /10 HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_NE(receive(again.get()).find("xxxxxxxxxx"), std::string::npos);
}

TEST_F(WebServerTest, WithoutDescriptorsItNeitherSpinsNorStays) {
  if (needs_descriptors_itself) GTEST_SKIP() << "the sanitizer needs descriptors";
  KeptLog log;
  turn();
  server_.allow({everybody}, log);
  for (const bool has_client : {false, true}) {
    SCOPED_TRACE(has_client);
    FileDescriptor early;
    if (has_client) {
      early = client("GET /10 HTTP/1.1\r\nHost: a\r\n\r\n");
      receive(early.get());
    }
    log.lines.clear();
    const FileDescriptor late = connect_tcp(server_.address());
    const FileDescriptor later = connect_tcp(server_.address());
    {
      const NoDescriptors none;
      ASSERT_TRUE(turn_until([&] { return !log.lines.empty(); }));
      EXPECT_LE(turns_in(10s, loop_, server_, now_), 50)
          << "once a second it looks whether there are descriptors again";
      ASSERT_EQ(log.lines.size(), 1u) << "said once";
      EXPECT_EQ(log.lines[0],
                "no further browser can connect: Too many open files; raise LimitNOFILE of the "
                "service, or lower clients_max in [server] and [http]");
      if (has_client) {
        send(early.get(), "GET /20 HTTP/1.1\r\nHost: a\r\n\r\n");
        EXPECT_NE(receive(early.get()).find(std::string(20, 'x')), std::string::npos)
            << "who is connected is served";
      }
    }
    now_ += 1s;
    for (const FileDescriptor* socket : {&late, &later}) {
      send(socket->get(), "GET /10 HTTP/1.1\r\nHost: a\r\n\r\n");
      EXPECT_NE(receive(socket->get()).find("xxxxxxxxxx"), std::string::npos);
    }
    // Nobody is connected when the next round begins.
    early.close();
  }
}

TEST_F(WebServerTest, ClientsThatVanishLeaveNothingBehind) {
  for (int i = 0; i < 50; ++i) {
    const FileDescriptor gone =
        client(i % 2 == 0 ? "GET /1000000 HTTP/1.1\r\nHost: a\r\n\r\n" : "GET /1");
    turn();
  }
  // One that went away with half a request said may look like one that has yet to say the rest.
  EXPECT_TRUE(turn_until([&] {
    now_ += 1s;
    return counters_.clients == 0;
  }));
  EXPECT_EQ(site_.ended, site_.begun);
}

}  // namespace
}  // namespace etcm::port
