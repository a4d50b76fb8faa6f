// What the operator decided: the configuration file, read and checked as a whole. Which keys there
// are, their ranges and defaults, is the table of settings_keys.h.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "etcm/config.h"
#include "etcm/port/clock.h"
#include "etcm/port/endpoint.h"
#include "etcm/port/projection.h"
#include "etcm/port/serial_line.h"
#include "etcm/port/socket_address.h"
#include "firmware/profile/profile.h"
#include "firmware/protocol/modbus_address.h"
#include "firmware/protocol/node_registers.h"
#include "firmware/site/feature_end.h"
#include "firmware/site/site_domain.h"
#include "firmware/site/site_plane.h"

namespace etcm::firmware {

inline constexpr std::uint8_t unit_max = 247;

// Units 1 to unit_max, from the first to the last.
struct UnitRange {
  std::uint8_t first = 0;
  std::uint8_t last = 0;

  struct Iterator {
    unsigned value;
    constexpr ModbusAddress operator*() const {
      return ModbusAddress{static_cast<std::uint8_t>(value)};
    }
    constexpr Iterator& operator++() {
      ++value;
      return *this;
    }
    friend constexpr bool operator==(const Iterator&, const Iterator&) = default;
  };
  constexpr Iterator begin() const { return {first}; }
  constexpr Iterator end() const { return {last + 1u}; }
  constexpr bool contains(ModbusAddress address) const {
    return first <= address.value && address.value <= last;
  }
  friend constexpr bool operator==(const UnitRange&, const UnitRange&) = default;
};

bool contain(const std::vector<UnitRange>& ranges, ModbusAddress unit);

// A digital line: its name or CHIP:OFFSET.
struct LineSettings {
  std::string name;
  bool is_active_low = false;
  friend bool operator==(const LineSettings&, const LineSettings&) = default;
};

struct GpioSettings {
  std::optional<LineSettings> alert;
  std::optional<LineSettings> join_button;
  std::optional<LineSettings> status_led;
  std::optional<LineSettings> watchdog;
  port::Duration debounce{};
};

// The profile of nodes that serve our own registers.
inline constexpr const char* node_profile = "etcm";

// A [[bus.device]]: what answers at these units of a bus.
struct DeviceSettings {
  std::vector<UnitRange> units;
  std::string profile;       // its name
  port::Duration timeout{};  // for an answer
  port::Duration pause{};    // of the bus, after each answer
  // In place of Profile::speed_max_nano.
  std::optional<std::int64_t> speed_max_nano{};
  std::string source{};  // where it was configured: "file:line"
};

// How frames stand in the bytes of a TCP connection.
enum class Framing : std::uint8_t { tcp, rtu };

// Who else may ask the units of a bus, through the gateway.
struct ShareSettings {
  std::optional<port::SocketAddress> listen;  // none: nobody
  std::vector<port::Network> allow{};         // who may connect
  std::vector<UnitRange> units{};             // that may be asked
  bool writes = false;                        // else they may only read
  std::uint32_t percent = 0;                  // of the time of a busy line
  port::Duration wait_max{};                  // of a request, for its turn
};

struct BusSettings {
  std::string name;
  Framing framing = Framing::tcp;
  std::variant<port::Endpoint, port::SerialLine> link;  // Modbus TCP, or RTU
  std::vector<UnitRange> units;
  std::vector<UnitRange> assign{};  // units that new nodes are given; they are asked as well
  std::vector<UnitRange> scan{};    // units that are looked for
  port::Duration scan_budget{};     // of each interval, where others want the bus
  WordOrder word_order = WordOrder::abcd;
  port::Duration timeout{};
  std::vector<DeviceSettings> devices{};  // a unit is in one at the most
  port::Duration quiet{};                 // of a serial line, after a wait in vain
  std::uint32_t outstanding_max = 0;
  std::optional<LineSettings> send_enable;  // switches the transceiver of a serial line
  ShareSettings share{};
};

// What the bus is named that has no name of its own: the address or the path.
std::string link_name(const BusSettings& bus);

// The least time that a question to a unit and its answer take on a line.
port::Duration exchange_floor(const port::SerialLine& line);

// When a unit of a bus is asked.
enum class Asked : std::uint8_t { never, always, looked_for };
Asked asked(const BusSettings& bus, ModbusAddress unit);
inline bool asks(const BusSettings& bus, ModbusAddress unit) {
  return asked(bus, unit) != Asked::never;
}

// What the settings say of the device at this unit; null: it is a node, with the bus's own timeout.
const DeviceSettings* device_at(const BusSettings& bus, ModbusAddress address);
// How long this unit of the bus may take to answer.
port::Duration timeout_of(const BusSettings& bus, ModbusAddress address);

struct PollSettings {
  port::Duration interval{};
  port::Duration timeout{};
  std::uint32_t outstanding_max = 0;
  port::Duration absent_interval{};  // the longest pause between two questions to a silent unit
  port::Duration stale_after{};
  port::Duration leave_after{};
  std::uint32_t dead_band = 0;  // a node that moved no farther than this stays where it is
};

struct WriteBackSettings {
  bool is_enabled = false;
};

struct FeatureSettings {
  FeatureEnd from;
  FeatureEnd to;
  std::string name{};  // what people call it, or empty
  std::string source;  // where it was configured: "file:line"
};

// In a site file, where a line may have vertices that are no nodes; else by [[feature]].
bool is_drawn(const FeatureSettings& feature);
inline bool ends_at(const FeatureSettings& feature, const FeatureEnd& end) {
  return feature.from == end || feature.to == end;
}

// What is known of the device at a unit that it does not tell itself.
struct NodeSettings {
  std::string bus;
  std::uint32_t address = 0;  // of its unit
  std::optional<std::uint32_t> serial{};
  // Where it was surveyed: in 10^-9 of what the plane of the site counts in, or of a degree.
  std::optional<std::int64_t> x{};
  std::optional<std::int64_t> y{};
  std::optional<std::int64_t> longitude{};
  std::optional<std::int64_t> latitude{};
  std::string name{};                  // only while it is read: see NodeName
  std::string source{};                // as above
  std::optional<Position> position{};  // where that is in the mesh
};

// What people call the node with a serial, or whichever answers at a unit.
struct NodeName {
  Serial serial{};  // none: it is the one at the unit
  std::string bus{};
  std::uint32_t address = 0;  // of the unit
  std::string name;
  std::string source{};  // as above
};

struct AnchorSettings {
  Position position;
  std::string source;  // as above
};

// What the node numbers of a .poly are.
enum class PolyNodes : std::uint8_t { serials, anchors };

// Lengths in 10^-9 of what the site file counts in, so that decimals are exact.
inline constexpr std::int64_t site_nano = 1'000'000'000;
struct SiteOrigin {
  std::int64_t x = 0;
  std::int64_t y = 0;
  friend constexpr bool operator==(const SiteOrigin&, const SiteOrigin&) = default;
};
// What the world file of a plan counts in.
enum class PlanIn : std::uint8_t {
  unsaid,
  plane,  // what the plane of the site counts in
  degrees,
};
// A picture that is drawn below the mesh (site_plan.h).
struct SitePlan {
  const char* media_type = "";
  std::string bytes;          // of its file
  std::uint64_t version = 0;  // another where the bytes are others
  std::uint32_t width = 0;    // pixels
  std::uint32_t height = 0;
  std::array<double, 6> world{};  // as the world file has them
  bool is_in_degrees = false;     // these numbers are
};
struct SiteSettings {
  std::string name{};       // what people call the site, or empty
  std::string path;         // empty: there is none
  std::string source;       // as above
  std::string plan_path{};  // empty: there is no plan
  PlanIn plan_in = PlanIn::unsaid;
  std::shared_ptr<const SitePlan> plan{};  // what is there; null: none
  PolyNodes poly_nodes = PolyNodes::serials;
  std::int64_t unit_length = site_nano;  // of a unit of the mesh
  SiteOrigin origin;                     // the mesh's (0, 0)
  bool round = false;                    // to the nearest unit
  std::string crs;                       // of the plane, as given
  std::int64_t metres = 0;               // 10^-9 metres in what the plane counts in; 0: not said
  // What `crs` and the degrees of the site make of it; with no degrees in it, null.
  std::shared_ptr<const port::Projection> projection;
  // The origin was given in degrees: it is the middle of the plane.
  bool has_origin_in_degrees = false;
  // What the projection is of: the coordinate system of this name, or metres about this place.
  std::string projected_crs;
  std::optional<port::EarthPoint> center;
  // The plane is about a place that stands for the one nobody has said, which is a mistake: what
  // else is wrong can still be found.
  bool lacks_center = false;

  SitePlane plane() const {
    const SiteOrigin at = has_origin_in_degrees ? SiteOrigin{} : origin;
    return {.unit_length = unit_length,
            .origin_x = at.x,
            .origin_y = at.y,
            .projection = projection,
            .metres = metres};
  }
};

struct ServerSettings {
  port::SocketAddress listen;
  std::vector<port::Network> allow{};  // who may connect
  std::uint32_t clients_max = 0;
};

struct HttpSettings {
  port::SocketAddress listen;
  std::vector<port::Network> allow{};  // who may look
  std::string allow_place{};           // where that is written, "gateway.toml, line 12"
  std::vector<std::string> names{};    // by which it is asked for, beside its addresses
  std::uint32_t clients_max = 0;
};

struct FileSettings {
  std::string folder;
  std::string name;
  port::Duration interval{};  // at the most so often
};

// What a gateway of a fleet tells the others, and takes from them.
enum class FleetShare : std::uint8_t {
  publish,  // its nodes are told, and its mesh is of its own alone
  site,     // the nodes of the others are nodes here too
};

// The broker by which gateways of one site know of each other.
struct MqttSettings {
  port::Endpoint broker;
  std::string site;  // is the same for all of them
  std::string name;  // is another one for each
  FleetShare share = FleetShare::publish;
  bool is_alone = false;        // `publish` is written there: a mesh of its own is what is wanted
  std::string user{};           // empty: none
  std::string password_file{};  // empty: no password
  std::string tls_ca{};         // files; empty: no TLS by certificates
  std::string tls_certificate{};
  std::string tls_key{};
  std::string psk_identity{};  // empty: no TLS by a key that both know
  std::string psk_file{};
  port::Duration keep_alive{};
  // A node is told of no sooner than the first after the last time, where it has changed, and no
  // later than the second.
  port::Duration period_min{};
  port::Duration period_max{};
  std::string sparkplug{};       // the group of this edge node; empty: it is none
  std::string home_assistant{};  // before the topics where it looks for devices; empty: not told
};

// What is worked out for the operator at each generation; 0: not asked for.
struct AnalysisSettings {
  std::uint32_t radio_range = 0;
  std::uint32_t sensing_range = 0;
};

// Where a person on this machine tells the gateway something.
struct ControlSettings {
  std::string socket{};  // empty: `control` in the folder that systemd gives, or nowhere
};

struct StateSettings {
  std::string folder;
  port::Duration interval{};  // at the most so often
};

// For how many of them memory is taken at the start.
struct UnitRoom {
  std::uint32_t units = 0;
  std::uint32_t buses = 0;
};

struct Settings {
  MeshConfig mesh;
  std::uint32_t work_max = 0;  // of one change of the mesh; 0: no limit
  PollSettings poll;
  WriteBackSettings write_back;
  std::vector<BusSettings> buses;
  UnitRoom room{};                    // that of the start, whatever a reload adds
  std::vector<std::string> profiles;  // files and folders, beside what is installed
  std::vector<Profile> device_profiles;
  bool has_all_profiles = true;  // else some could not be read, and that was told
  std::vector<NodeSettings> nodes;
  std::vector<NodeName> node_names{};
  ServerSettings server;
  std::optional<HttpSettings> http;
  std::optional<FileSettings> files;
  std::optional<StateSettings> state;
  std::optional<MqttSettings> mqtt;
  GpioSettings gpio;
  ControlSettings control{};
  AnalysisSettings analysis;
  SiteSettings site;
  // Of the file itself and of the site file.
  std::vector<FeatureSettings> features;
  std::vector<AnchorSettings> anchors;
  SiteDomain domain;
  // Lines "file:line: what; the cure" about what can work, but hardly as it was meant.
  std::vector<std::string> warnings;
};

// The [[node]] of the device at this unit; null where there is none.
const NodeSettings* node_at(const Settings& settings, const BusSettings& bus,
                            ModbusAddress address);

// The profile of this name; null where there is none, and for node_profile.
const Profile* find_profile(const Settings& settings, const std::string& name);

// Adds what is known of a device, with `address` 1 to unit_max; without a bus to the only one. If
// that is wrong, the answer says what and the cure, and which key it is about.
struct NodeMistake {
  const char* key = "";
  std::string what;  // empty: nothing is wrong
};
NodeMistake add_node(Settings& settings, NodeSettings node);

// That the bus of this name asks this unit; without a name the only bus gives its own. The answer
// is as above.
NodeMistake find_bus(const Settings& settings, std::uint32_t address, std::string& name);

// The serial by which the device at this unit is known, unless it tells one: that of its [[node]],
// or made of the number of the bus, from 0, and the unit.
Serial device_serial(const Settings& settings, std::size_t bus, ModbusAddress address);

// Reads the file. Every mistake in it adds one line "file:line: what is wrong; the cure" to
// `mistakes`; the settings are good for use only when there are none. Relative paths in the file
// start from its folder.
Settings read_settings(const std::string& path, std::vector<std::string>& mistakes);

}  // namespace etcm::firmware
