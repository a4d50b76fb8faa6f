// CommandSocket: one line, one answer, whoever is at the other end.
#include "posix/command_socket.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "no_descriptors.h"
#include "peer.h"
#include "support/scratch_folder.h"

namespace etcm::port {
namespace {

using namespace std::chrono_literals;

// Answers with what was said, in capitals, so many times.
class Echo final : public CommandHandler {
 public:
  void begin(std::size_t client, std::string_view line) override {
    lines.emplace_back(line);
    answers.at(client).clear();
    for (std::size_t i = 0; i < times; ++i) answers.at(client).append(line).append("!");
    ++open;
  }
  std::size_t read(std::size_t client, std::span<char> out) override {
    std::string& rest = answers.at(client);
    const std::size_t count = std::min(out.size(), rest.size());
    std::copy_n(rest.begin(), count, out.begin());
    rest.erase(0, count);
    return count;
  }
  void end(std::size_t) override { --open; }

  std::size_t times = 1;
  std::vector<std::string> lines;
  std::array<std::string, command_clients_max> answers;
  int open = 0;
};

class HeardLog final : public Log {
 public:
  void write(Level, std::string_view line) override { lines.emplace_back(line); }
  std::vector<std::string> lines;
};

class CommandSocketTest : public testing::Test {
 protected:
  CommandSocketTest() : path_(folder_.path("control")) { open(); }
  void open() { socket_.emplace(loop_, path_, echo_, log_); }

  FileDescriptor connect() const {
    FileDescriptor client(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path_.c_str(), path_.size() + 1);
    const int done =
        ::connect(client.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address));
    return done == 0 ? std::move(client) : FileDescriptor();
  }
  static void say(const FileDescriptor& client, std::string_view text) {
    ASSERT_EQ(::send(client.get(), text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }
  // All that comes until the other end hangs up.
  std::string hear(const FileDescriptor& client) {
    std::string heard;
    std::array<char, 1000> buffer;
    EXPECT_TRUE(turn_until(loop_, [&] {
      while (true) {
        const ssize_t count = ::recv(client.get(), buffer.data(), buffer.size(), 0);
        if (count <= 0) return count == 0 || errno == ECONNRESET;
        heard.append(buffer.data(), static_cast<std::size_t>(count));
      }
    }));
    return heard;
  }
  std::string ask(std::string_view line) {
    const FileDescriptor client = connect();
    say(client, line);
    return hear(client);
  }

  test::ScratchFolder folder_;
  const std::string path_;
  EventLoop loop_;
  Echo echo_;
  HeardLog log_;
  std::optional<CommandSocket> socket_;
};

TEST_F(CommandSocketTest, AnswersALine) {
  EXPECT_EQ(ask("list\n"), "list!");
  EXPECT_EQ(ask("dismiss 7\nwhat follows is nothing\n"), "dismiss 7!");
  EXPECT_EQ(echo_.open, 0);
  EXPECT_TRUE(log_.lines.empty());
}

TEST_F(CommandSocketTest, ALongAnswerComesWhole) {
  echo_.times = 100'000;
  EXPECT_EQ(ask("ab\n").size(), 300'000u);
  EXPECT_EQ(echo_.open, 0);
}

TEST_F(CommandSocketTest, IsForItsOwnUserAlone) {
  struct stat status {};
  ASSERT_EQ(::stat(path_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
}

TEST_F(CommandSocketTest, ALineWithoutAnEndIsHungUpOn) {
  EXPECT_EQ(ask(std::string(command_bytes_max, 'x')), "");
  const FileDescriptor client = connect();
  say(client, "half a li");
  ::shutdown(client.get(), SHUT_WR);
  EXPECT_EQ(hear(client), "");
  EXPECT_TRUE(echo_.lines.empty());
}

TEST_F(CommandSocketTest, WhoSaysNothingHoldsUpNobodyForLong) {
  std::vector<FileDescriptor> idle;
  for (std::size_t i = 0; i < command_clients_max; ++i) idle.push_back(connect());
  const FileDescriptor late = connect();
  ASSERT_TRUE(late.is_open());
  say(late, "hello\n");
  while (loop_.wait(10ms)) {
  }
  EXPECT_TRUE(echo_.lines.empty()) << "all places are taken";
  Instant now{1h};
  socket_->advance(now);
  socket_->advance(now + CommandSocket::client_patience);
  EXPECT_EQ(hear(late), "hello!");
}

TEST_F(CommandSocketTest, WhoTakesNothingIsHungUpOn) {
  socket_->advance(Instant{1h});
  echo_.times = 1'000'000;
  const FileDescriptor client = connect();
  say(client, "much\n");
  while (loop_.wait(10ms)) {
  }
  EXPECT_EQ(echo_.open, 1);
  EXPECT_EQ(socket_->next_deadline(), Instant{1h} + CommandSocket::client_patience);
  socket_->advance(Instant{1h} + CommandSocket::client_patience);
  EXPECT_EQ(echo_.open, 0);
  EXPECT_EQ(socket_->next_deadline(), never);
}

TEST_F(CommandSocketTest, WithoutDescriptorsWhoeverWaitsLeavesTheLoopAtRest) {
  if (needs_descriptors_itself) GTEST_SKIP();
  Instant now{1h};
  const FileDescriptor late = connect();
  say(late, "hello\n");
  {
    const NoDescriptors none;
    EXPECT_LT(turns_in(10s, loop_, *socket_, now), 50);
    EXPECT_TRUE(echo_.lines.empty());
  }
  ASSERT_EQ(log_.lines.size(), 1u) << "said once";
  EXPECT_EQ(log_.lines[0], "no further command can come at " + path_ +
                               ": Too many open files; raise LimitNOFILE of the service, or lower "
                               "clients_max in [server] and [http]");
  socket_->advance(now + ListeningSocket::retry_interval);
  EXPECT_EQ(hear(late), "hello!");
  EXPECT_EQ(socket_->next_deadline(), never);
}

TEST_F(CommandSocketTest, WhoHangsUpInTheMiddleIsNoTrouble) {
  echo_.times = 1'000'000;
  {
    const FileDescriptor client = connect();
    say(client, "much\n");
    while (loop_.wait(10ms)) {
    }
  }
  EXPECT_TRUE(turn_until(loop_, [&] { return echo_.open == 0; }));
  echo_.times = 1;
  EXPECT_EQ(ask("again\n"), "again!");
}

TEST_F(CommandSocketTest, ASocketThatADeadProgramLeftIsReplaced) {
  socket_.reset();
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path_.c_str(), path_.size() + 1);
  {
    const FileDescriptor dead(::socket(AF_UNIX, SOCK_STREAM, 0));
    ASSERT_EQ(::bind(dead.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  }
  open();
  EXPECT_EQ(ask("list\n"), "list!");
}

TEST_F(CommandSocketTest, ThatOfALivingProgramStaysItsOwn) {
  Echo other;
  CommandSocket second(loop_, path_, other, log_);
  EXPECT_FALSE(second.is_listening());
  ASSERT_EQ(log_.lines.size(), 1u);
  EXPECT_EQ(log_.lines[0], "takes no commands: cannot listen at " + path_ +
                               " (Address already in use); goes on, and tries again; look who has "
                               "that path, or change `socket` of [control]");
  EXPECT_EQ(ask("list\n"), "list!");
  socket_.reset();
  second.advance(Instant{1h});
  EXPECT_TRUE(second.is_listening());
  EXPECT_EQ(log_.lines.size(), 2u);
  ask("list\n");
  EXPECT_EQ(other.lines.size(), 1u);
}

TEST_F(CommandSocketTest, AFileInTheWayIsNotTouched) {
  socket_.reset();
  std::ofstream(path_) << "mine";
  open();
  EXPECT_FALSE(socket_->is_listening());
  EXPECT_EQ(folder_.read("control"), "mine");
  for (int i = 0; i < 100; ++i) socket_->advance(Instant{1h} + i * 1s);
  EXPECT_EQ(log_.lines.size(), 1u) << "said once";
}

TEST_F(CommandSocketTest, APathThatIsTooLongIsSaid) {
  CommandSocket wrong(loop_, "/tmp/" + std::string(200, 'x'), echo_, log_);
  EXPECT_FALSE(wrong.is_listening());
  ASSERT_EQ(log_.lines.size(), 1u);
  EXPECT_NE(log_.lines[0].find("(File name too long)"), std::string::npos) << log_.lines[0];
}

TEST_F(CommandSocketTest, GoesWithItsProgram) {
  socket_.reset();
  struct stat status {};
  EXPECT_NE(::stat(path_.c_str(), &status), 0);
}

}  // namespace
}  // namespace etcm::port
