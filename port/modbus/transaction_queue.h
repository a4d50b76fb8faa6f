// The requests under way on one connection, and what is known of the line behind it.
//
// Most connections lead to a converter: one queue, and one line on which a request that was given
// up is still waited for. Others lead to units that answer beside each other. Nothing tells which,
// so a queue is assumed until an answer overtakes an earlier request in good time for both:
// - the time of a request runs from when those before it are done with; a request behind a dead
//   unit has not failed;
// - a request that was waited for in vain keeps its room, and those behind it their time, until it
//   is answered after all or for as long as the slowest answer took (at first hold_at_first, or
//   hold_unheard as long as nothing has ever come; half as long each time nothing comes, where a
//   queue was seen down to hold_unheard). Where none is behind it, others may be sent at once until
//   a late answer has shown that there is a queue;
// - an answer that comes too late makes the unit waited for longer, by a quarter more than that
//   took, up to learned_patience_max, and halves the requests under way; one more is allowed after
//   grows_after answers without such. Where slow_units_of_a_line are slow the line is, and all are
//   waited for as long as the least slow of these.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <optional>
#include <vector>

#include "etcm/port/clock.h"
#include "modbus/frame.h"

namespace etcm::port {

inline constexpr Duration hold_at_first = std::chrono::seconds(4);
inline constexpr Duration hold_unheard = std::chrono::seconds(1);
inline constexpr Duration hold_max = std::chrono::seconds(5);
inline constexpr Duration learned_patience_max = std::chrono::seconds(5);
inline constexpr std::uint32_t grows_after = 64;
inline constexpr std::uint32_t slow_units_of_a_line = 3;

struct TcpRequest {
  std::uint16_t transaction = 0;
  std::uint8_t address = 0;
  std::uint8_t function = 0;
  RegisterRange range{};
  std::uint32_t ticket = 0;
  Duration timeout{};
  Instant sent_at{};
  bool is_of_client = false;  // a UnitRequest
};

// An answer that took longer than the timeout of a unit that has been late, or never came and held
// up the others.
struct LateTransaction {
  std::uint8_t address = 0;
  bool has_come = true;
  Duration latency{};  // since it was the first of those that wait
};

class TransactionQueue {
 public:
  explicit TransactionQueue(std::uint32_t window_max);

  // Whether one more may be sent.
  bool has_room() const;
  // Of requests whose answer is waited for.
  std::size_t waiting_count() const;
  // Nothing has room in it.
  bool is_empty() const { return taken_count() == 0; }
  // So many may be under way at present.
  std::uint32_t window() const { return window_; }
  // Whether a request that is not answered holds up the others, as far as was seen.
  bool is_one_line() const { return is_proven_; }
  // For how much longer than its timeout a request may be under way.
  Duration delay_max() const { return is_queue() ? hold_max + learned_patience_max : Duration{}; }
  // What a wait in vain may cost those behind it.
  Duration hold() const { return is_proven_ ? hold_ : Duration{}; }

  // An answer to this number would be one to a request that has none yet, however old that is.
  bool is_owed(std::uint16_t transaction) const;

  // REQUIRES: has_room(), and a number that is not owed.
  void add(const TcpRequest& request, Instant now);

  // An answer has come; its time counts with the next advance(). Returns the request where the
  // answer is still waited for. `is_of_unit`: it shows that the unit is there.
  std::optional<TcpRequest> answer(std::uint16_t transaction, bool is_of_unit = true);
  // A unit's absence was told: only a converter does that.
  void note_converter() { is_proven_ = true; }

  void advance(Instant now);
  // The next request that was waited for in vain, if any. `is_silent`: nothing at all comes, so
  // none is behind another any more.
  std::optional<TcpRequest> give_up(Instant now, bool is_silent);
  // The connection is lost: one after the other that was waited for, until there is none.
  std::optional<TcpRequest> abandon();

  Instant next_deadline() const;

  // The latest one since the last call.
  std::optional<LateTransaction> take_late();
  // A unit that was waited for in vain because others held it up, and has answered since; each
  // once.
  std::optional<std::uint8_t> take_held_up();

 private:
  enum class State : std::uint8_t {
    waiting,     // for its answer
    held,        // waited for in vain; keeps its room until `until`
    remembered,  // has no room any more; an answer may still come
    answered,
    answered_late,
  };
  struct Entry {
    TcpRequest request;
    State state = State::waiting;
    bool is_overtaken = false;
    bool is_of_unit = false;    // its answer is
    bool has_moved_up = false;  // one before it was answered since the last advance()
    Instant head_at = never;    // when all before it were done with
    Instant until{};
    bool owes(std::uint16_t transaction) const {
      return request.transaction == transaction && state < State::answered;
    }
  };
  static constexpr std::size_t remembered_max = 64;

  std::uint32_t taken_count() const;
  bool is_queue() const { return hold_ > Duration{}; }
  static bool blocks(const Entry& entry) {
    return !entry.is_overtaken && (entry.state == State::waiting || entry.state == State::held);
  }
  Duration patience(const TcpRequest& request) const;
  Instant deadline(const Entry& entry, bool is_silent) const;
  void take_answer(std::size_t index, Instant now);
  void overtake(std::size_t index, Instant now, bool is_in_time);
  void learn(const Entry& late, Duration latency);
  void note_late(const LateTransaction& late);
  void prove(Duration latency);
  void shrink_hold();
  void start_heads(Instant now);
  void forget_some();

  std::uint32_t window_max_;
  std::uint32_t window_;
  std::uint32_t in_time_ = 0;  // answers in a row
  bool is_heard_ = false;      // something has come
  bool is_proven_ = false;
  Duration hold_ = hold_at_first;
  std::array<Duration, 256> patience_{};  // learned, by unit
  std::uint32_t slow_count_ = 0;          // units for which it was
  Duration least_patience_{};             // of these
  std::vector<Entry> entries_;            // as they were sent
  std::optional<LateTransaction> late_;
  std::bitset<256> held_up_;
};

}  // namespace etcm::port
