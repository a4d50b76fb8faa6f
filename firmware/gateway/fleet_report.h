// Who is in the fleet, as the page, the metrics and the health tell it.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "etcm/port/clock.h"
#include "etcm/port/message_broker.h"

namespace etcm::firmware {

enum class MemberState : std::uint8_t {
  here,
  waiting,  // not all that it tells has come yet
  gone,     // its connection to the broker has ended
  unknown,  // this gateway has no connection itself, or that one may still come back to the broker
  name_taken,  // another gateway has the same name
  rejected,    // what it says is nonsense
};

// The word of a state in documents.
constexpr std::string_view to_string(MemberState state) {
  switch (state) {
    case MemberState::here:
      return "here";
    case MemberState::waiting:
      return "waiting";
    case MemberState::gone:
      return "gone";
    case MemberState::unknown:
      return "unknown";
    case MemberState::name_taken:
      return "name_taken";
    case MemberState::rejected:
      return "rejected";
  }
  return "";
}

// What to do about a gateway that is gone.
inline constexpr std::string_view gone_cure =
    "look at its machine, its power, its network and its log: the broker may refuse it";

// Of one that was there before the broker was away.
inline constexpr std::string_view not_back = " has not come back since the broker was away";

struct ReportedMember {
  std::string name{};
  MemberState state = MemberState::waiting;
  port::Instant since{};                     // it has been in this state
  std::uint32_t node_count = 0;              // that it hears
  std::uint32_t generation = 0;              // that it published last
  std::optional<std::uint64_t> mesh_hash{};  // of that; none: nobody knows
  bool agrees = false;                       // it has the mesh that this gateway has
  bool is_proven = false;  // it has spoken in this run: the broker had not just kept it
  std::string version{};   // of its program
  bool differs = false;    // it does not, and that is no news on their way
  std::string why{};       // what is wrong, for a person; or empty
  bool has_left = false;   // what came of it last is that it is gone, or nothing came
  // It was there before the broker was away, and is not since.
  bool left_with_broker = false;
};

// How one that is gone is dismissed; its name follows.
constexpr std::string_view how_to_dismiss(const ReportedMember& member) {
  return member.node_count == 0
             ? "; if it is gone for good: sudo etcm-gateway ctl dismiss "
             : "; if it is gone for good, once its nodes have left, after leave_after: sudo "
               "etcm-gateway ctl dismiss ";
}

// By name, this gateway among them.
struct FleetReport {
  std::string site{};
  std::string name{};
  bool is_connected = false;
  bool is_settled = false;    // what the broker had kept has come
  bool is_told = false;       // since then the broker has taken what this gateway says of itself
  bool has_told_all = false;  // and it had sent all else that was due, once
  std::uint64_t other_refused_count = 0;  // messages of others through its broker, ever
  bool is_silent = false;  // another gateway of its name goes on, and this one tells nothing
  port::Instant connected_or_not_since{};
  // Since when no connection has lasted, such as with a broker that refuses what it is told and
  // hangs up; none: this one has.
  std::optional<port::Instant> apart_since{};
  bool has_had_short = false;  // since then one has come and gone
  port::Duration lasting{};    // a connection that has stood for so long is one
  std::string trouble{};       // why there is none that lasts, for a person
  std::string refusal{};  // why the others hear nothing from here though there is one; or empty
  port::BrokerCounters broker{};
  std::uint32_t agreeing = 0;
  std::uint32_t site_number = 0;  // of the document of the site; 0: none
  std::string site_gateway{};     // whose file it is from
  std::string site_trouble{};     // what is wrong with it, for a person; or empty
  bool is_site_known = false;     // the broker has the one that holds here, or there is none
  port::Duration period{};        // each gateway is heard of at least so often
  std::vector<ReportedMember> members{};
};

// So long no connection has lasted: until the one that there is, or until now. That one may end as
// those before it have.
inline port::Duration time_apart(const FleetReport& fleet, port::Instant now) {
  if (!fleet.apart_since) return {};
  const port::Instant until = fleet.is_connected ? fleet.connected_or_not_since : now;
  return std::max<port::Duration>(until - *fleet.apart_since, {});
}

// It has been gone for longer than a restart of its program or of its connection takes: what the
// list says at once is then a trouble. Who was apart itself knows nothing of the others yet.
inline constexpr port::Duration gone_grace = std::chrono::seconds(10);
inline bool is_gone_for_long(const FleetReport& fleet, const ReportedMember& member,
                             port::Duration leave_after, port::Instant now) {
  if (member.state != MemberState::gone || !fleet.is_connected) return false;
  return now - std::max(member.since, fleet.connected_or_not_since) >
         std::min(gone_grace, leave_after);
}

}  // namespace etcm::firmware
