// What alarms are about: as a number that a restart does not change, and in words.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/alarms/alarm.h"
#include "firmware/gateway/gateway.h"
#include "firmware/logging/text_line.h"

namespace etcm::firmware {

std::uint64_t subject_of(std::string_view name, std::uint32_t number = 0);
constexpr std::uint64_t subject_of(Position position) {
  return std::uint64_t{static_cast<std::uint32_t>(position.x)} << 32 |
         static_cast<std::uint32_t>(position.y);
}

// Of disk_of_state: what is saved with the state has a disk writer of its own.
inline constexpr std::uint64_t alarms_of_state = 1;

// By its ends, whatever it is called and wherever it stands in the settings.
std::uint64_t subject_of(const FeatureSettings& feature);

// What has this subject now; none, or null, where nothing has.
BusIndex bus_of_subject(const Poller& poller, std::uint64_t subject);
UnitIndex unit_of_subject(const Poller& poller, std::uint64_t subject);
const ReportedMember* member_of_subject(const FleetReport* fleet, std::uint64_t subject);

// The node that it is about; none where it is about none, or no number says which.
Serial node_of_subject(AlarmKey key);

// False: about another gateway, or a node of another one.
bool is_about_here(const Gateway& gateway, AlarmKey key);

// For a person: the gateway that hears it, or has. REQUIRES: another one.
std::string_view gateway_of(const Gateway& gateway, const NodeRecord& node);

// The gateway that hears it is gone, and nobody else can say how it is.
bool is_with_its_gateway(const Gateway& gateway, const NodeRecord& node);

// "node 7, unit 3 of yard", "node 7 of gateway north".
void write_node(TextLine& text, const Gateway& gateway, const NodeRecord& node);

// What the alarm is about is there: in the settings, or a node or a gateway that is known.
bool is_there(const Gateway& gateway, AlarmKey key);

// What to do about a node that is missing.
void write_missing_cure(TextLine& cure, const Gateway& gateway, const NodeRecord& node);

}  // namespace etcm::firmware
