// AlarmBook and its bytes: what began, ended and is known of, over looks and restarts.
#include <gtest/gtest.h>

#include <array>
#include <initializer_list>
#include <string>
#include <vector>

#include "fakes.h"
#include "firmware/alarms/alarm_codec.h"
#include "firmware/alarms/alarm_keeper.h"
#include "firmware/control/alarm_list.h"
#include "firmware/status/alarms_document.h"
#include "memory_store.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

constexpr AlarmKey node_7{AlarmKind::missing_node, 7};
constexpr AlarmKey yard{AlarmKind::silent_bus, 42};

const auto always = [](const Alarm&) { return true; };
const auto never_yet = [](const Alarm&) { return false; };

class BookWallClock final : public port::WallClock {
 public:
  std::int64_t milliseconds() const override { return now_ms; }
  std::int64_t now_ms = 1'700'000'000'000;
};

class AlarmBookTest : public testing::Test {
 protected:
  // A look that finds these, so long after the last one.
  void look(const std::vector<AlarmKey>& wrong, port::Duration later = 1s) {
    now_ += later;
    wall_.now_ms += later / 1ms;
    book_.begin_look(now_);
    for (const AlarmKey& key : wrong) book_.hold(key, {}, "something is wrong", "do something");
    book_.end_look(always);
  }
  void look_with_cure(std::string_view cure, port::Duration later = 1s) {
    now_ += later;
    wall_.now_ms += later / 1ms;
    book_.begin_look(now_);
    book_.hold(yard, {}, "something is wrong", cure);
    book_.end_look(always);
  }
  const Alarm& only() const {
    EXPECT_EQ(book_.open_count(), 1u);
    return book_.open(0);
  }

  BookWallClock wall_;
  port::Instant now_{1h};
  AlarmBook book_;
};

TEST_F(AlarmBookTest, KnowsSinceWhenAndUntilWhen) {
  look({node_7});
  const port::Instant began = now_;
  look({node_7});
  look({node_7});
  EXPECT_EQ(only().since.at, began);
  EXPECT_TRUE(only().is_on);
  EXPECT_EQ(only().text(), "something is wrong");
  EXPECT_EQ(only().cure(), "do something");
  EXPECT_EQ(book_.on_count(), 1u);
  EXPECT_EQ(book_.on_count(Severity::major), 1u);
  EXPECT_EQ(book_.on_count(Severity::critical), 0u);
  look({});
  EXPECT_FALSE(only().is_on);
  EXPECT_EQ(only().until.at, now_);
  EXPECT_EQ(book_.on_count(), 0u);
  look({}, recurrence_pause + 1s);
  EXPECT_EQ(book_.open_count(), 0u);
  ASSERT_EQ(book_.ended_count(), 1u);
  EXPECT_EQ(book_.ended(0).since.at, began);
}

TEST_F(AlarmBookTest, TakesWhatComesAndGoesForOneAlarm) {
  for (int i = 0; i < 50; ++i) {
    look({node_7}, 1min);
    look({}, 1min);
  }
  EXPECT_EQ(only().number, 1u);
  EXPECT_EQ(only().times, 50u);
  EXPECT_EQ(book_.ended_count(), 0u);
  look({}, recurrence_pause + 1s);
  look({node_7});
  EXPECT_EQ(only().number, 2u) << "it was quiet for long enough to be another one";
  EXPECT_EQ(only().times, 1u);
}

TEST_F(AlarmBookTest, IsAcknowledgedByNumberUntilItEnds) {
  look({node_7, yard});
  EXPECT_EQ(book_.unacknowledged_count(), 2u);
  EXPECT_FALSE(book_.acknowledge(3));
  EXPECT_TRUE(book_.acknowledge(1));
  EXPECT_TRUE(book_.acknowledge(1));
  EXPECT_EQ(book_.unacknowledged_count(), 1u);
  look({node_7, yard});
  EXPECT_EQ(book_.unacknowledged_count(), 1u);
  EXPECT_EQ(book_.acknowledge_all(), 1u);
  look({});
  EXPECT_FALSE(book_.acknowledge(1)) << "it is not on";
  look({}, recurrence_pause + 1s);
  look({node_7});
  EXPECT_EQ(book_.unacknowledged_count(), 1u) << "another alarm";
}

TEST_F(AlarmBookTest, ItsEditionChangesWithTheWordsOfAnAlarmThatIsOn) {
  look_with_cure("reset the converter");
  const std::uint32_t first = book_.edition();
  look_with_cure("reset the converter");
  EXPECT_EQ(book_.edition(), first);
  look_with_cure("look at the cable");
  EXPECT_EQ(book_.edition(), first + 1) << "at once";
  look_with_cure("look at the supply");
  EXPECT_EQ(book_.edition(), first + 1) << "not so soon";
  look_with_cure("look at the supply", words_pause);
  EXPECT_EQ(book_.edition(), first + 2) << "the last words are told, though nothing changed since";
  look_with_cure("look at the supply", words_pause);
  EXPECT_EQ(book_.edition(), first + 2);
}

TEST_F(AlarmBookTest, WordsThatAlternateMakeNeitherSavesNorEditionsWithoutEnd) {
  MemoryStore store;
  RecordingLog log;
  AlarmKeeper keeper(book_, store, wall_, log);
  look_with_cure("reset the converter");
  keeper.step(now_);
  const std::uint32_t first = book_.edition();
  for (int i = 0; i < 3600; ++i) {
    look_with_cure(i % 2 == 0 ? "look at the cable" : "reset the converter");
    keeper.step(now_);
  }
  EXPECT_EQ(store.saves, 1u);
  EXPECT_LE(book_.edition() - first, 361u);
  EXPECT_GE(book_.edition() - first, 300u);
}

TEST_F(AlarmBookTest, CountsWhatItHasNoRoomFor) {
  std::vector<AlarmKey> many;
  for (std::uint32_t i = 0; i < open_alarms_max + 17; ++i) {
    many.push_back({AlarmKind::missing_node, 999'999 - i});
  }
  look(many);
  EXPECT_EQ(book_.on_count(), open_alarms_max);
  EXPECT_EQ(book_.untold_count(), 17u);
  for (std::uint32_t i = 1; i < book_.open_count(); ++i) {
    ASSERT_LT(book_.open(i - 1).key, book_.open(i).key);
  }
  look({});
  look({}, recurrence_pause + 1s);
  EXPECT_EQ(book_.untold_count(), 0u);
  EXPECT_EQ(book_.ended_count(), open_alarms_max);
}

TEST_F(AlarmBookTest, KeepsTheLastThatEnded) {
  for (std::uint32_t i = 0; i < kept_alarms_max + 5; ++i) {
    look({{AlarmKind::no_fix, i}}, recurrence_pause + 1s);
    look({});
  }
  look({}, recurrence_pause + 1s);
  EXPECT_EQ(book_.ended_count(), kept_alarms_max);
  EXPECT_EQ(book_.ended(0).number, 6u);
  EXPECT_EQ(book_.ended(kept_alarms_max - 1).number, kept_alarms_max + 5);
}

TEST_F(AlarmBookTest, IsOneAlarmBeforeAndAfterARestart) {
  look({node_7, yard});
  book_.acknowledge(1);
  look({yard}, 10min);
  std::vector<std::byte> bytes;
  encode_alarms(book_, now_, wall_.now_ms, bytes);
  const std::int64_t began_ms = wall_.now_ms - 600'000;

  AlarmBook after;
  ASSERT_EQ(decode_alarms(bytes, now_, wall_.now_ms, after), "");
  ASSERT_EQ(after.open_count(), 2u);
  EXPECT_EQ(after.on_count(), 1u);
  EXPECT_TRUE(after.open(1).is_acknowledged);
  EXPECT_EQ(after.open(1).until.unix_ms, wall_.now_ms);
  const port::Instant later = now_ + 5s;
  after.begin_look(later);
  after.hold(yard, {}, "the same", "");
  after.end_look(always);
  EXPECT_EQ(after.open(0).number, 2u);
  EXPECT_EQ(after.open(0).times, 1u);
  EXPECT_EQ(after.open(0).since.time_of_day_ms(later, wall_.now_ms + 60'000), began_ms);
  after.begin_look(later + 1s);
  after.hold({AlarmKind::no_fix, 7}, {}, "", "");
  after.end_look(always);
  EXPECT_EQ(after.open(2).number, 3u) << "numbers go on";
}

TEST_F(AlarmBookTest, WhatBeginsAgainSoonAfterARestartIsTheSameAlarm) {
  look({node_7});
  look({}, 10min);
  wall_.now_ms += 60'000;  // until it is saved
  std::vector<std::byte> bytes;
  encode_alarms(book_, now_ + 1min, wall_.now_ms, bytes);
  const std::int64_t saved_ms = wall_.now_ms;
  struct Restart {
    port::Duration off;  // by the clock of the machine, which may have been set meanwhile
    bool is_same;
  };
  for (const auto& [off, is_same] :
       {Restart{0s, true}, Restart{14min, true}, Restart{14min + 1s, false}, Restart{-5min, true},
        Restart{-20min, false}, Restart{24h, false}}) {
    const std::int64_t unix_ms = saved_ms + off / 1ms;
    AlarmBook after;
    const port::Instant started{3s};
    ASSERT_EQ(decode_alarms(bytes, started, unix_ms, after), "");
    EXPECT_EQ(after.open_count(), is_same ? 1u : 0u) << off / 1s;
    EXPECT_EQ(after.ended_count(), is_same ? 0u : 1u) << off / 1s;
    after.begin_look(started);
    after.hold(node_7, {}, "again", "");
    after.end_look(always);
    EXPECT_EQ(after.open(0).number, is_same ? 1u : 2u) << off / 1s;
    EXPECT_EQ(after.open(0).times, is_same ? 2u : 1u) << off / 1s;
  }
}

TEST_F(AlarmBookTest, WhatEndedBeforeARestartHasEndedForGoodOnceItsPauseIsOver) {
  look({node_7});
  look({}, 10min);
  std::vector<std::byte> bytes;
  encode_alarms(book_, now_, wall_.now_ms, bytes);
  AlarmBook after;
  const port::Instant started{3s};
  ASSERT_EQ(decode_alarms(bytes, started, wall_.now_ms + 600'000, after), "");
  const auto look_after = [&](port::Duration passed) {
    after.begin_look(started + passed);
    after.end_look(always);
    return after.open_count();
  };
  EXPECT_EQ(look_after(5min), 1u);
  EXPECT_EQ(look_after(5min + 1s), 0u);
  ASSERT_EQ(after.ended_count(), 1u);
  EXPECT_EQ(after.ended(0).until.unix_ms, wall_.now_ms);
  EXPECT_EQ(after.ended(0).end, AlarmEnd::by_itself);
}

TEST_F(AlarmBookTest, ABookOfAnEarlierGatewayHasNothingThatMayGoOn) {
  look({node_7});
  look({});
  std::vector<std::byte> bytes;
  encode_alarms(book_, now_, wall_.now_ms, bytes);
  constexpr std::size_t flags_of_first = 8 + 5;
  bytes[flags_of_first] = std::byte{0};
  AlarmBook after;
  ASSERT_EQ(decode_alarms(bytes, now_, wall_.now_ms, after), "");
  EXPECT_EQ(after.open_count(), 0u);
  EXPECT_EQ(after.ended_count(), 1u);
}

TEST_F(AlarmBookTest, WhyItEndedOutlivesARestart) {
  look({node_7, yard});
  book_.dismiss(node_7);
  book_.dismiss(yard);
  book_.dismiss({AlarmKind::missing_node, 8});
  look({yard});
  look({});
  look({}, recurrence_pause + 1s);
  look({node_7});
  std::vector<std::byte> bytes;
  encode_alarms(book_, now_, wall_.now_ms, bytes);
  AlarmBook after;
  ASSERT_EQ(decode_alarms(bytes, now_, wall_.now_ms, after), "");
  ASSERT_EQ(after.ended_count(), 2u);
  EXPECT_EQ(after.ended(0).end, AlarmEnd::by_itself) << "it went on when it was dismissed";
  EXPECT_EQ(after.ended(1).end, AlarmEnd::dismissed);
  EXPECT_EQ(after.open(0).end, AlarmEnd::unknown) << "it is on";

  constexpr std::size_t end_of_first = 8 + 6;
  for (const unsigned other : {0u, 4u, 255u}) {
    bytes[end_of_first] = static_cast<std::byte>(other);
    AlarmBook of_another_version;
    ASSERT_EQ(decode_alarms(bytes, now_, wall_.now_ms, of_another_version), "");
    EXPECT_EQ(of_another_version.ended(0).end, AlarmEnd::unknown) << other;
    EXPECT_EQ(of_another_version.ended(1).end, AlarmEnd::dismissed);
  }
}

TEST_F(AlarmBookTest, EndsNoAlarmOfAnEarlierRunBeforeThatIsKnown) {
  look({yard});
  std::vector<std::byte> bytes;
  encode_alarms(book_, now_, wall_.now_ms, bytes);
  AlarmBook after;
  ASSERT_EQ(decode_alarms(bytes, now_, wall_.now_ms, after), "");
  after.begin_look(port::Instant{1s});
  after.end_look(never_yet);
  EXPECT_EQ(after.on_count(), 1u);
  after.begin_look(port::Instant{5min});
  after.end_look(always);
  EXPECT_EQ(after.on_count(), 0u);
}

TEST_F(AlarmBookTest, RefusesBytesThatMakeNoSense) {
  look({node_7, yard});
  std::vector<std::byte> sound;
  encode_alarms(book_, now_, wall_.now_ms, sound);
  for (std::size_t size = 0; size < sound.size(); ++size) {
    AlarmBook book;
    EXPECT_NE(decode_alarms(std::span(sound).first(size), now_, wall_.now_ms, book), "") << size;
  }
  std::vector<std::byte> longer = sound;
  longer.push_back(std::byte{0});
  AlarmBook book;
  EXPECT_EQ(decode_alarms(longer, now_, wall_.now_ms, book), "something follows its last alarm");
  for (std::size_t at = 0; at < sound.size(); ++at) {
    for (const unsigned bits : {0x01u, 0x80u, 0xffu}) {
      std::vector<std::byte> wrong = sound;
      wrong[at] ^= static_cast<std::byte>(bits);
      AlarmBook whatever;
      static_cast<void>(decode_alarms(wrong, now_, wall_.now_ms, whatever));
      EXPECT_LE(whatever.open_count() + whatever.ended_count(), 2u);
    }
  }
}

TEST_F(AlarmBookTest, ALongCureIsCutBetweenWords) {
  book_.begin_look(now_);
  const std::string cure(Alarm::text_max - 20, 'c');
  book_.hold(node_7, {}, "text", cure + " how: /guide/site.html");
  book_.end_look(always);
  EXPECT_EQ(only().cure(), cure + " how:");
}

TEST_F(AlarmBookTest, ALongTextLosesTheEndOfItsCureAndStaysUtf8) {
  book_.begin_look(now_);
  std::string long_text;
  for (int i = 0; i < 190; ++i) long_text += "ü";
  book_.hold(node_7, {}, long_text, "ä" + long_text);
  book_.end_look(always);
  EXPECT_EQ(only().text(), long_text);
  EXPECT_EQ(only().cure(), "ä" + long_text.substr(0, 18));
}

TEST_F(AlarmBookTest, TheWorstTextFitsInAPieceOfEachDocument) {
  std::string controls;
  for (std::size_t i = 0; i < Alarm::text_max; ++i) controls += static_cast<char>(i % 0x20);
  const std::string quotes(Alarm::text_max, '"');
  const std::string slashes(Alarm::text_max, '\\');
  const std::string no_utf8(Alarm::text_max, '\xff');
  for (const std::string& words :
       {controls, quotes, slashes, no_utf8, std::string("\x1b[2J\x7f")}) {
    AlarmBook book;
    Alarm worst;
    worst.number = worst.times = 0xffffffff;
    worst.key = {AlarmKind::refused_configuration, ~std::uint64_t{0}};
    worst.severity = Severity::critical;
    worst.until.unix_ms = 253'402'300'799'000;
    worst.since.unix_ms = 1;
    worst.is_acknowledged = true;
    worst.end = AlarmEnd::dismissed;
    worst.set_words(words.substr(0, words.size() / 2), words.substr(words.size() / 2));
    EXPECT_EQ(worst.text().find_first_of(controls + "\x7f"), std::string::npos);
    ASSERT_TRUE(book.restore(worst));
    const AlarmsDocument history(book, wall_, AlarmsShown::all);
    const AlarmsCsv table(book, wall_);
    const AlarmList list(book, wall_);
    for (const Document* const document :
         std::initializer_list<const Document*>{&history, &table, &list}) {
      std::array<char, piece_bytes_max> room;
      TextWriter piece(room);
      Cursor cursor;
      while (document->write_next(cursor, now_, piece)) {
        EXPECT_FALSE(piece.is_full()) << piece.text();
        // There is room for the bus that it is about, of the worst name.
        EXPECT_LT(piece.text().size() + 6 * 200 + 40, piece_bytes_max);
        piece.clear();
      }
    }
  }
}

TEST_F(AlarmBookTest, IsOnTheDiskWithinTheMinuteAndAtTheEnd) {
  MemoryStore store;
  RecordingLog log;
  {
    AlarmKeeper keeper(book_, store, wall_, log);
    keeper.restore(now_);
    look({node_7});
    keeper.step(now_);
    EXPECT_EQ(store.saves, 1u);
    look({node_7, yard});
    keeper.step(now_);
    EXPECT_EQ(store.saves, 1u) << "not so soon";
    look({node_7, yard}, 1min);
    keeper.step(now_);
    EXPECT_EQ(store.saves, 2u);
    EXPECT_EQ(book_.acknowledge_all(), 2u);
    keeper.step(now_);
    keeper.step(now_);
    EXPECT_EQ(store.saves, 3u) << "at once";
    look({yard});
    keeper.finish(now_);
    EXPECT_EQ(store.saves, 4u);
    keeper.finish(now_);
    EXPECT_EQ(store.saves, 4u) << "nothing new";
  }
  AlarmBook after;
  AlarmKeeper keeper(after, store, wall_, log);
  keeper.restore(now_);
  EXPECT_EQ(after.open_count(), 2u);
  EXPECT_EQ(after.on_count(), 1u);
}

TEST_F(AlarmBookTest, ADamagedCopyIsSetAsideAndTheOneBeforeIsTaken) {
  MemoryStore store;
  RecordingLog log;
  look({node_7});
  encode_alarms(book_, now_, wall_.now_ms, store.previous);
  store.last = {std::byte{1}};
  AlarmBook after;
  AlarmKeeper keeper(after, store, wall_, log);
  keeper.restore(now_);
  EXPECT_EQ(after.open_count(), 1u);
  EXPECT_EQ(log.count("alarms: what was saved is not used, it is cut off; it is kept as aside-1"),
            1u);
}

TEST_F(AlarmBookTest, AFullBookThatCouldNotBeSavedIsTriedAgainSoon) {
  MemoryStore store;
  RecordingLog log;
  AlarmKeeper keeper(book_, store, wall_, log);
  std::vector<AlarmKey> many;
  for (std::uint32_t i = 0; i < open_alarms_max; ++i) many.push_back({AlarmKind::no_fix, i});
  look(many);
  keeper.step(now_);
  ASSERT_EQ(store.saves, 1u);
  many.pop_back();
  store.why = "the disk is full";
  look(many, 2h);
  keeper.step(now_);
  keeper.step(now_);
  ASSERT_EQ(store.saves, 2u);
  EXPECT_TRUE(keeper.disk().is_in_trouble());
  EXPECT_EQ(keeper.disk().trouble(), "the disk is full");
  store.why.clear();
  look(many, alarm_retry_max);
  keeper.step(now_);
  EXPECT_EQ(store.saves, 3u);
  keeper.step(now_);
  EXPECT_FALSE(keeper.disk().is_in_trouble());
}

TEST_F(AlarmBookTest, ADiskThatIsFullIsSaidOnceAndTriedAgain) {
  MemoryStore store;
  store.why = "the disk is full";
  RecordingLog log;
  AlarmKeeper keeper(book_, store, wall_, log);
  for (int i = 0; i < 10; ++i) {
    look({node_7}, 1min);
    keeper.step(now_);
  }
  EXPECT_EQ(log.count("the alarms are not saved: the disk is full; goes on, and tries again"), 1u);
  store.why = "";
  for (int i = 0; i < 3; ++i) {
    look({node_7, yard}, 1min);
    keeper.step(now_);
  }
  EXPECT_EQ(log.count("the alarms are saved again"), 1u);
  EXPECT_FALSE(store.last.empty());
}

}  // namespace
}  // namespace etcm::firmware
