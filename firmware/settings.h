// What the operator decided: the configuration file, read and checked as a whole.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "etcm/config.h"
#include "etcm/port/clock.h"
#include "etcm/port/serial_line.h"
#include "etcm/port/socket_address.h"
#include "node_map.h"

namespace etcm::firmware {

struct UnitRange {
  std::uint8_t first = 0;
  std::uint8_t last = 0;
};

// A digital line: its name or CHIP:OFFSET.
struct LineSettings {
  std::string place;
  bool is_active_low = false;
};

struct GpioSettings {
  std::optional<LineSettings> alert;
  std::optional<LineSettings> join_button;
  std::optional<LineSettings> status_led;
  std::optional<LineSettings> watchdog;
  port::Duration debounce{};
};

struct BusSettings {
  std::string name;
  std::variant<port::SocketAddress, port::SerialLine> link;  // Modbus TCP, or RTU
  std::vector<UnitRange> units;
  WordOrder word_order = WordOrder::abcd;
  port::Duration timeout{};
  port::Duration quiet{};  // of a serial line, after a wait in vain
  std::uint32_t outstanding_max = 0;
  std::optional<LineSettings> send_enable;  // switches the transceiver of a serial line
};

struct PollSettings {
  port::Duration interval{};
  port::Duration timeout{};
  std::uint32_t outstanding_max = 4;
  port::Duration absent_interval{};  // the longest pause between two questions to a silent unit
  port::Duration stale_after{};
  port::Duration leave_after{};
  std::uint32_t dead_band = 0;  // a node that moved no farther than this stays where it is
};

struct FeatureSettings {
  std::uint32_t from = 0;  // serials
  std::uint32_t to = 0;
  std::string place;  // where it was configured: "file:line"
};

struct ServerSettings {
  port::SocketAddress listen;
  std::uint32_t clients_max = 0;
};

struct FileSettings {
  std::string folder;
  std::string name;
  port::Duration interval{};  // at the most so often
};

struct Settings {
  MeshConfig mesh;
  PollSettings poll;
  std::vector<BusSettings> buses;
  ServerSettings server;
  std::optional<FileSettings> files;
  GpioSettings gpio;
  std::string site;  // path of a .poly with features, or empty
  std::vector<FeatureSettings> features;
};

// Reads the file. Every mistake in it adds one line "file:line: what is wrong; the cure" to
// `mistakes`; the settings are good for use only when there are none. Relative paths in the file
// start from its folder.
Settings read_settings(const std::string& path, std::vector<std::string>& mistakes);

// "500ms", "2s", "5min"; nothing for anything else.
std::optional<port::Duration> parse_duration(const std::string& text);

// "1-60" or "7" or "1-3,9".
std::optional<std::vector<UnitRange>> parse_units(const std::string& text);

}  // namespace etcm::firmware
