// StreamLog: what stands in a line for the journal, a person and a program, and that no reader
// holds it up.
#include "posix/stream_log.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>

#include "posix/file_descriptor.h"
#include "support/allocation_watch.h"
#include "support/scratch_folder.h"

namespace etcm::port {
namespace {

class StreamLogTest : public testing::Test {
 protected:
  StreamLogTest() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe2(ends.data(), O_NONBLOCK), 0);
    reader_ = FileDescriptor(ends[0]);
    writer_ = FileDescriptor(ends[1]);
    ::unsetenv("JOURNAL_STREAM");
  }
  ~StreamLogTest() override { ::unsetenv("JOURNAL_STREAM"); }

  std::string read_all() {
    std::string text;
    std::array<char, 4096> part;
    for (ssize_t count; (count = ::read(reader_.get(), part.data(), part.size())) > 0;) {
      text.append(part.data(), static_cast<std::size_t>(count));
    }
    return text;
  }
  void name_journal(int descriptor, ino_t other = 0) {
    struct stat status {};
    ASSERT_EQ(::fstat(descriptor, &status), 0);
    const std::string stream =
        std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino + other);
    ::setenv("JOURNAL_STREAM", stream.c_str(), 1);
  }
  static void write_each(StreamLog& log) {
    log.write(Level::error, "a");
    log.write(Level::warning, "b");
    log.write(Level::info, "c");
  }
  FileDescriptor reader_, writer_;
};

TEST_F(StreamLogTest, ForAProgramIsPlain) {
  StreamLog log(writer_.get());
  write_each(log);
  EXPECT_EQ(read_all(), "error: a\nwarning: b\nc\n");
}

TEST_F(StreamLogTest, ForTheJournalHasPriorities) {
  name_journal(writer_.get());
  StreamLog log(writer_.get());
  write_each(log);
  EXPECT_EQ(read_all(), "<3>a\n<4>b\n<6>c\n");
}

TEST_F(StreamLogTest, FiguresAreWrittenWhereTheyAreWanted) {
  StreamLog plain(writer_.get());
  plain.write(Level::detail, "d");
  plain.write(Level::info, "c");
  EXPECT_EQ(read_all(), "c\n");
  name_journal(writer_.get());
  StreamLog all(writer_.get(), Level::detail);
  all.write(Level::detail, "d");
  EXPECT_EQ(read_all(), "<7>d\n");
}

TEST_F(StreamLogTest, ThatWasSentElsewhereThanTheJournalHasNone) {
  for (const char* const stream : {"", "x", "1", "1:", ":1", "-1:-1"}) {
    ::setenv("JOURNAL_STREAM", stream, 1);
    StreamLog log(writer_.get());
    log.write(Level::info, "c");
    EXPECT_EQ(read_all(), "c\n");
  }
  name_journal(writer_.get(), 1);
  StreamLog log(writer_.get());
  log.write(Level::info, "c");
  EXPECT_EQ(read_all(), "c\n");
}

TEST_F(StreamLogTest, InAFileHasTheTime) {
  const test::ScratchFolder scratch;
  const FileDescriptor file(::open(scratch.path("log").c_str(), O_WRONLY | O_CREAT, 0600));
  StreamLog log(file.get());
  write_each(log);
  const std::string time = "[0-9]{4}-[0-9]{2}-[0-9]{2} [0-9]{2}:[0-9]{2}:[0-9]{2}.[0-9]{3} ";
  EXPECT_THAT(scratch.read("log"),
              testing::MatchesRegex(time + "error: a\n" + time + "warning: b\n" + time + "c\n"));
}

TEST_F(StreamLogTest, OnATerminalHasTheTime) {
  const FileDescriptor terminal(::posix_openpt(O_RDWR | O_NOCTTY));
  ASSERT_TRUE(terminal.is_open());
  ASSERT_EQ(::grantpt(terminal.get()) + ::unlockpt(terminal.get()), 0);
  const FileDescriptor end(::open(::ptsname(terminal.get()), O_RDWR | O_NOCTTY));
  StreamLog log(end.get());
  log.write(Level::info, "c");
  std::array<char, 100> text{};
  ASSERT_GT(::read(terminal.get(), text.data(), text.size() - 1), 0);
  EXPECT_THAT(std::string(text.data()), testing::MatchesRegex("20.*[0-9] c\r\n"));
}

TEST_F(StreamLogTest, KeepsALineALine) {
  StreamLog log(writer_.get());
  log.write(Level::info, "a\nb\r\x1b[31m\x7f" + std::string(1, '\0') + "\xc3\xa4");
  EXPECT_EQ(read_all(), "a?b??[31m??\xc3\xa4\n");
  log.write(Level::info, "");
  EXPECT_EQ(read_all(), "\n");
}

TEST_F(StreamLogTest, CutsALongLineBetweenCharacters) {
  StreamLog log(writer_.get());
  log.write(Level::error, std::string(StreamLog::line_max, 'x'));
  EXPECT_EQ(read_all(), "error: " + std::string(StreamLog::line_max, 'x') + "\n");
  log.write(Level::error, std::string(StreamLog::line_max - 1, 'x') + "\xc3\xa4" + "y");
  EXPECT_EQ(read_all(), "error: " + std::string(StreamLog::line_max - 1, 'x') + " ...\n");
}

TEST_F(StreamLogTest, DoesNotWaitForAReaderAndTellsWhatIsMissing) {
  // The log sees a pipe that blocks, as standard error is.
  ASSERT_EQ(::fcntl(writer_.get(), F_SETFL, 0), 0);
  StreamLog log(writer_.get());
  const std::string line(500, 'x');
  for (int i = 0; i < 1000; ++i) log.write(Level::info, line);
  const std::string taken = read_all();
  const std::size_t lines = taken.size() / (line.size() + 1);
  EXPECT_LT(lines, 1000u);
  EXPECT_EQ(taken.size(), lines * (line.size() + 1)) << "only whole lines";
  log.write(Level::info, "goes on");
  EXPECT_EQ(read_all(), "warning: " + std::to_string(1000 - lines) +
                            " lines of this log are missing: nobody took them\ngoes on\n");
}

TEST_F(StreamLogTest, SurvivesThatNobodyReadsAtAll) {
  StreamLog closed(-1);
  closed.write(Level::info, "a");
  ::signal(SIGPIPE, SIG_IGN);
  reader_.close();
  StreamLog log(writer_.get());
  log.write(Level::info, "a");
  log.write(Level::info, "b");
}

TEST_F(StreamLogTest, AllocatesNothing) {
  StreamLog log(writer_.get());
  log.write(Level::info, "warm");
  const test::AllocationWatch watch;
  write_each(log);
  EXPECT_EQ(watch.allocations(), 0u);
}

TEST_F(StreamLogTest, WhatIsNoUtf8IsReplaced) {
  StreamLog log(writer_.get());
  log.write(Level::info, "a\xff b\xe2\x82 \u20ac \xc0\xaf \xed\xa0\x80 c\xe2");
  EXPECT_EQ(read_all(), "a? b?? \u20ac ?? ??? c?\n");
}

}  // namespace
}  // namespace etcm::port
