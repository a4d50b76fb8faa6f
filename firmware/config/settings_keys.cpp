#include "firmware/config/settings_keys.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "etcm/analysis.h"
#include "etcm/policy.h"
#include "firmware/protocol/mesh_register_layout.h"
#include "firmware/protocol/node_registers.h"

namespace etcm::firmware {

namespace {

using namespace std::chrono_literals;
using enum Effect;

constexpr std::uint32_t any_count = std::numeric_limits<std::uint32_t>::max();

constexpr Standard standard(const char* toml) { return {Standard::Kind::value, toml, ""}; }
constexpr Standard required(const char* example) {
  return {Standard::Kind::required, example, "required"};
}
constexpr Standard conditional(const char* example, const char* words) {
  return {Standard::Kind::conditional, example, words};
}
constexpr Standard unset(const char* example, const char* words = "none") {
  return {Standard::Kind::unset, example, words};
}

constexpr Key with_tcp(Key key) {
  key.bus = BusKind::tcp;
  return key;
}
constexpr Key with_rtu(Key key) {
  key.bus = BusKind::rtu;
  return key;
}

constexpr Meaning<PolyNodes> poly_nodes[] = {{"serials", PolyNodes::serials},
                                             {"anchors", PolyNodes::anchors}};

constexpr Meaning<PlanIn> plan_frames[] = {{"plane", PlanIn::plane}, {"degrees", PlanIn::degrees}};

constexpr Key profile_keys[] = {
    {"profiles", paths_from_file<&Settings::profiles>(), unset(R"(["profiles.toml"])", "none"),
     at_once,
     "files with [profiles of devices](profiles.md), or folders of such, looked through in this "
     "order, and those of the package (`/usr/share/etcm/profiles`) behind them; a `[[profile]]` "
     "may "
     "stand in this file too"},
};

constexpr Key site_keys[] = {
    {"name", called<&Settings::site, &SiteSettings::name>(), unset(R"("Harbour east")"), at_once,
     "what people call the site: title of the page, and of the files that are written"},
    {"file", path_from_file<&Settings::site, &SiteSettings::path>(), unset(R"("site.geojson")"),
     at_once, "a `.geojson`, or a Triangle `.poly`"},
    {"plan", path_from_file<&Settings::site, &SiteSettings::plan_path>(), unset(R"("plan.png")"),
     at_once,
     "a picture to be [drawn below the mesh](page.md#a-plan), PNG or JPEG, with a world file "
     "beside it"},
    {"plan_in", choice<plan_frames, &Settings::site, &SiteSettings::plan_in>(),
     unset(R"("degrees")", "what only can be"), at_once,
     "what the world file counts in, where it can be either: degrees, or what the plane counts in"},
    {"crs", text<&Settings::site, &SiteSettings::crs>(),
     unset(R"("EPSG:25833")", "[found out](site.md#degrees)"), at_once,
     "coordinate system of the plane; `\"plane\"`: of a drawing, nobody knows where on the earth",
     "`\"EPSG:...\"`, or `\"plane\"`"},
    {"unit", scale<&Settings::site, &SiteSettings::unit_length>(), standard(R"("1")"), at_once,
     "length of a unit of the mesh, in what the plane counts in: metres, where the site is in "
     "degrees"},
    {"metres", scale<&Settings::site, &SiteSettings::metres>(), unset(R"("0.001")", "nobody knows"),
     at_once,
     "metres in what the plane counts in, where it is nowhere on the earth: lengths are shown in "
     "metres then"},
    {"origin", origin<&Settings::site, &SiteSettings::origin>(), standard(R"(["0", "0"])"), at_once,
     "place in the plane that is (0, 0) to the nodes; longitude and latitude where the site is in "
     "degrees and has no `crs`"},
    {"round", flag<&Settings::site, &SiteSettings::round>(), standard("false"), at_once,
     "coordinates that are no whole units become the nearest"},
    {"nodes", choice<poly_nodes, &Settings::site, &SiteSettings::poly_nodes>(),
     standard(R"("serials")"), at_once, "what the node numbers of a `.poly` are"},
};

constexpr Meaning<SplitPolicy> policies[] = {{"default", split_default}, {"paper", split_paper}};

constexpr Key mesh_keys[] = {
    {"vertices_max",
     count<&Settings::mesh, &MeshConfig::vertices_max>(
         1, std::min(mesh_registers_vertices_max(), vertices_limit)),
     required("1000"), restart,
     "nodes, anchors and Steiner vertices together; twice the nodes is plenty for most sites"},
    {"features_max", count<&Settings::mesh, &MeshConfig::features_max>(0, features_limit),
     standard("0"), restart, "one for each segment of a feature, from one node on it to the next"},
    {"steiner_max", count<&Settings::mesh, &MeshConfig::steiner_max>(0, vertices_limit),
     standard("0"), restart, "most Steiner vertices; 0: as room allows"},
    {"work_max", count<&Settings::work_max>(0, any_count), standard("0"), restart,
     "most work for one change, in units of some 20 ns to 1 us (what needs more is refused); 0: no "
     "limit"},
    {"policy", choice<policies, &Settings::mesh, &MeshConfig::policy>(), standard(R"("default")"),
     restart,
     "where features are split: for the fewest points, or by the split rule of the ETCM paper"},
};

constexpr Key poll_keys[] = {
    {"interval", duration<&Settings::poll, &PollSettings::interval>(1ms), standard(R"("1s")"),
     at_once, "from one question to a unit to the next"},
    {"timeout", duration<&Settings::poll, &PollSettings::timeout>(1ms), standard(R"("200ms")"),
     at_once, "for an answer"},
    {"outstanding", count<&Settings::poll, &PollSettings::outstanding_max>(1, 32), standard("4"),
     restart,
     "most questions under way on one connection: fewer, down to one, while answers come late; 1 "
     "for "
     "a serial bus behind a converter"},
    {"absent_interval", duration<&Settings::poll, &PollSettings::absent_interval>(1ms),
     standard(R"("10s")"), at_once,
     "a unit that does not answer is asked ever less often, down to this"},
    {"stale_after", duration<&Settings::poll, &PollSettings::stale_after>(1ms), standard(R"("5s")"),
     at_once,
     "time without a position after which a node is marked stale; several times `interval`"},
    {"leave_after", duration<&Settings::poll, &PollSettings::leave_after>(1ms),
     standard(R"("30s")"), at_once,
     "silence after which a node leaves the mesh and "
     "[is missing](nodes.md#when-it-falls-silent), while others of its bus answer; longer "
     "than "
     "`interval`"},
    {"dead_band",
     count<&Settings::poll, &PollSettings::dead_band>(0, static_cast<std::uint32_t>(position_max),
                                                      "units"),
     standard("0"), at_once, "a node that moved no farther stays where the mesh has it"},
};

constexpr Meaning<WordOrder> word_orders[] = {{"ABCD", WordOrder::abcd},
                                              {"BADC", WordOrder::badc},
                                              {"CDAB", WordOrder::cdab},
                                              {"DCBA", WordOrder::dcba}};
constexpr Meaning<port::Parity> parities[] = {
    {"none", port::Parity::none}, {"even", port::Parity::even}, {"odd", port::Parity::odd}};
constexpr Meaning<port::Rs485Mode> rs485_modes[] = {
    {"keep", port::Rs485Mode::keep}, {"off", port::Rs485Mode::off}, {"on", port::Rs485Mode::on}};
constexpr Meaning<std::optional<port::RtsLevel>> rts_levels[] = {{"high", port::RtsLevel::high},
                                                                 {"low", port::RtsLevel::low}};

constexpr Meaning<Framing> framings[] = {{"tcp", Framing::tcp}, {"rtu", Framing::rtu}};

constexpr Key bus_keys[] = {
    with_tcp({"tcp", endpoint<&BusSettings::link>(),
              conditional(R"("127.0.0.1:502")", "this or `rtu`"), restart,
              "Modbus TCP: an address, `\"[2001:db8::1]:502\"` of IPv6, or a "
              "[name](wiring.md#by-name)"}),
    with_rtu({"rtu", text<&BusSettings::link, &port::SerialLine::path>(),
              conditional(R"("/dev/serial/by-path/...")", "this or `tcp`"), restart,
              "Modbus RTU on a serial port; better `/dev/serial/by-path/...` than `/dev/ttyUSB0`, "
              "which is renumbered",
              "path"}),
    with_tcp(
        {"framing", choice<framings, &BusSettings::framing>(), standard(R"("tcp")"), restart,
         "with `tcp`: Modbus TCP, or RTU frames as they are, which most serial servers pass on; "
         "one question at a time then"}),
    {"units", units<&BusSettings::units>(),
     conditional(R"("1-60")", "required, unless `assign`, `scan` or a `[[bus.device]]` is there"),
     additions, "1 ... 247: asked all the time, whether they answer or not"},
    {"assign", units<&BusSettings::assign>(), unset(R"("61-120")"), additions,
     "units that are given to new nodes, which answer at 247; asked like `units`, and so is 247",
     "as `units`, without 247"},
    {"scan", units<&BusSettings::scan>(), unset(R"("121-140")"), additions,
     "units that are looked for, one in each `interval`, until a node answers", "as `units`"},
    {"scan_budget", duration<&BusSettings::scan_budget>(1ms), standard(R"("20ms")"), restart,
     "of each `interval`, so much at the most goes into looking where others want the line"},
    {"name", called<&BusSettings::name>(), unset(R"("yard")", "address or path"), restart,
     "for the log and the page"},
    {"word_order", choice<word_orders, &BusSettings::word_order>(), standard(R"("ABCD")"), restart,
     "the bytes of 32-bit values, A the highest"},
    {"timeout", duration<&BusSettings::timeout>(1ms), unset(R"("200ms")", "that of `[poll]`"),
     at_once, "for an answer; the time of the bytes on a serial line is not counted"},
    with_tcp({"outstanding", count<&BusSettings::outstanding_max>(1, 32),
              unset("4", "that of `[poll]`"), restart, "with `tcp`: as in `[poll]`"}),
    {"share", optional_address<&BusSettings::share, &ShareSettings::listen>(),
     unset(R"("127.0.0.1:1510")", "the bus is the gateway's alone"), at_once,
     "where other programs [ask the units of the bus](sharing.md) through the gateway, over Modbus "
     "TCP; port 0: the system chooses, the log says"},
    {"share_allow", networks<&BusSettings::share, &ShareSettings::allow>(),
     standard(R"(["127.0.0.0/8", "::1"])"), at_once,
     "who may; a client from elsewhere is rejected, and the log says so"},
    {"share_units", units<&BusSettings::share, &ShareSettings::units>(), standard(R"("1-247")"),
     at_once, "which units they may ask"},
    {"share_writes", flag<&BusSettings::share, &ShareSettings::writes>(), standard("false"),
     at_once, "whether they may write; else a write is answered by exception 1"},
    {"share_time", count<&BusSettings::share, &ShareSettings::percent>(1, 50), standard("20"),
     at_once,
     "percent of the time that they have at the most where the gateway's own questions "
     "wait for it"},
    {"share_wait", duration<&BusSettings::share, &ShareSettings::wait_max>(1ms),
     standard(R"("500ms")"), at_once,
     "a request that has waited so long for its turn is answered by exception 6; this and the "
     "`timeout` of its unit should be less than the client's own patience"},
    with_rtu({"baud", baud<&BusSettings::link, &port::SerialLine::baud>(), standard("19200"),
              restart, "speed of the line; with `rtu`, as all that follow"}),
    with_rtu({"parity", choice<parities, &BusSettings::link, &port::SerialLine::parity>(),
              standard(R"("even")"), restart, "of each byte, as its units have it"}),
    with_rtu({"stop_bits", count<&BusSettings::link, &port::SerialLine::stop_bits>(1, 2),
              standard("1"), restart, "2 where units without parity want it so"}),
    with_rtu(
        {"rs485",
         choice<rs485_modes, &BusSettings::link, &port::SerialLine::rs485, &port::Rs485::mode>(),
         standard(R"("keep")"), restart,
         "whether the driver [switches the transceiver](wiring.md#who-switches-the-transceiver) "
         "by RTS: `keep` leaves that to the device tree"}),
    with_rtu({"rs485_rts",
              choice<rts_levels, &BusSettings::link, &port::SerialLine::rs485,
                     &port::Rs485::rts_while_sending>(),
              unset(R"("high")", "as the driver has it"), restart,
              "RTS while the gateway sends, with `rs485 = \"on\"`"}),
    with_rtu({"rs485_delay_before",
              optional_duration<&BusSettings::link, &port::SerialLine::rs485,
                                &port::Rs485::delay_before>(port::rs485_delay_max),
              unset(R"("1ms")", "as the driver has it"), restart,
              "from that switch to the first bit, in whole milliseconds"}),
    with_rtu(
        {"rs485_delay_after",
         optional_duration<&BusSettings::link, &port::SerialLine::rs485, &port::Rs485::delay_after>(
             port::rs485_delay_max),
         unset(R"("0ms")", "as the driver has it"), restart,
         "from the last bit to the switch back"}),
    with_rtu({"rs485_line", board_line<&BusSettings::send_enable>(), unset(R"("RS485_DE")"),
              restart,
              "a digital line that switches the transceiver: active while the gateway sends"}),
    with_rtu({"quiet", duration<&BusSettings::quiet>(0ms), standard(R"("50ms")"), restart,
              "silence after a wait in vain: the slowest unit's answer takes at most `timeout` and "
              "this. For a unit that has answered later it is longer for a while, up to a second"}),
};

constexpr std::int64_t plane_max = site_nano * 1'000'000'000;

constexpr Key device_keys[] = {
    {"units", units<&DeviceSettings::units>(), required(R"("7")"), additions,
     "where they answer; units that the bus does not name itself are added to its `units`",
     "`\"7\"`, `\"12-14\"`"},
    {"profile", text<&DeviceSettings::profile>(), standard(R"("etcm")"), restart,
     "what they are: the name of a [profile](profiles.md); `etcm` is a node of our own", "name"},
    {"timeout", duration<&DeviceSettings::timeout>(1ms), unset(R"("500ms")", "that of the bus"),
     at_once, "for an answer of these"},
    {"pause", duration<&DeviceSettings::pause>(0ms), unset(R"("20ms")", "that of the profile"),
     restart, "silence that they need after an answer"},
    {"speed_max", decimal<&DeviceSettings::speed_max_nano>(plane_max),
     unset(R"("30")", "that of the profile"), restart,
     "how far they move in a second at the most, in metres or what the plane counts in: a position "
     "that [jumps farther](profiles.md#a-position-that-jumps) is asked for once more",
     "decimal in quotes, above 0"},
};

constexpr Key node_keys[] = {
    {"bus", text<&NodeSettings::bus>(), unset(R"("yard")", "the only one"), restart,
     "where its device answers: the name of a bus", "name"},
    {"unit", count<&NodeSettings::address>(1, unit_max),
     conditional("7", "required, unless `serial` and `name` are all that is there"), restart,
     "the unit of its device"},
    {"serial", optional_count<&NodeSettings::serial>(0, Serial::none_value - 1),
     unset("1007", "1000 times the number of its bus, and the unit"), restart,
     "by which it is known, where the device itself tells none; with `name` alone, whose name that "
     "is, whichever gateway hears it"},
    {"name", called<&NodeSettings::name>(), unset(R"("pump house")"), at_once,
     "what [people call it](nodes.md#names), in the log, on the page and in documents"},
    {"x", decimal<&NodeSettings::x>(plane_max), unset(R"("120")", "the device tells it"), restart,
     "where it was surveyed, in what the plane counts in, to the unit; with `y`"},
    {"y", decimal<&NodeSettings::y>(plane_max), unset(R"("-40")", "the device tells it"), restart,
     "as `x`"},
    {"longitude", decimal<&NodeSettings::longitude>(180 * site_nano),
     unset(R"("10.3951")", "the device tells it"), restart,
     "where it was surveyed, in degrees (WGS 84), east positive; with `latitude`"},
    {"latitude", decimal<&NodeSettings::latitude>(90 * site_nano),
     unset(R"("63.4305")", "the device tells it"), restart, "as `longitude`, north positive"},
};

constexpr Key write_back_keys[] = {
    {"enabled", flag<&Settings::write_back, &WriteBackSettings::is_enabled>(), standard("false"),
     restart,
     "nodes are told their neighbours (registers 200...). Off until the operator says so: a "
     "gateway that only reads can disturb nobody's device, whatever answers at a unit. Not "
     "together with `share = \"site\"` of `[mqtt]`"},
};

constexpr Key gpio_keys[] = {
    {"alert", board_line<&Settings::gpio, &GpioSettings::alert>(), unset(R"("NODE_ALERT")"),
     restart, "input: up while a new node waits at unit 247"},
    {"join_button", board_line<&Settings::gpio, &GpioSettings::join_button>(), unset(R"("JOIN")"),
     restart, "input: the same, by hand"},
    {"status_led", board_line<&Settings::gpio, &GpioSettings::status_led>(),
     unset(R"("STATUS_LED")"), restart, "output: [flashes tell](wiring.md) how the gateway is"},
    {"watchdog", board_line<&Settings::gpio, &GpioSettings::watchdog>(), unset(R"("WATCHDOG")"),
     restart,
     "output for an external watchdog: changes its level every 500 ms while the gateway's loop "
     "turns"},
    {"debounce", duration<&Settings::gpio, &GpioSettings::debounce>(0ms), standard(R"("20ms")"),
     restart, "an input counts once it has stood still so long"},
};

constexpr Key server_keys[] = {
    {"listen", address<&Settings::server, &ServerSettings::listen>(),
     standard(R"("127.0.0.1:1502")"), restart,
     "port 0: the system chooses, the log says; `\"[::]:1502\"`: all addresses, of IPv4 too"},
    {"allow", networks<&Settings::server, &ServerSettings::allow>(),
     standard(R"(["127.0.0.0/8", "::1"])"), at_once,
     "who may read; a client from elsewhere is rejected, and the log says so"},
    {"clients_max", count<&Settings::server, &ServerSettings::clients_max>(1, 1000), standard("16"),
     restart,
     "one more takes the place of the client that has asked nothing for longest, if that is over a "
     "minute; else it is rejected. One address may have three quarters of the places"},
};

constexpr Key analysis_keys[] = {
    {"radio_range",
     count<&Settings::analysis, &AnalysisSettings::radio_range>(1, range_max, "units"),
     unset("400"), restart, "how far a radio reaches: links, relays, least range"},
    {"sensing_range",
     count<&Settings::analysis, &AnalysisSettings::sensing_range>(1, range_max, "units"),
     unset("150"), restart, "how far a node senses: coverage holes, barrier gaps"},
};

constexpr Key http_keys[] = {
    {"listen", address<&Settings::http, &HttpSettings::listen>(), standard(R"("127.0.0.1:8080")"),
     restart, "whoever can reach it sees everything and can change nothing"},
    {"allow", networks<&Settings::http, &HttpSettings::allow>(),
     standard(R"(["127.0.0.0/8", "::1"])"), at_once,
     "who may look; others are rejected, and the log says so"},
    {"names", host_names<&Settings::http, &HttpSettings::names>(), standard("[]"), at_once,
     "by which the page is asked for: its addresses and `localhost` need not be here; [any other "
     "is told nothing](page.md#by-name)"},
    {"clients_max", count<&Settings::http, &HttpSettings::clients_max>(1, 1000), standard("32"),
     restart,
     "connections; a browser takes up to 6; further ones wait. One address may have three "
     "quarters of them; more of it are rejected"},
};

constexpr Key file_keys[] = {
    {"folder", path_from_file<&Settings::files, &FileSettings::folder>(),
     required(R"("/var/lib/etcm/mesh")"), restart,
     "made where there is none; while it cannot be, the mesh goes on without"},
    {"name", called<&Settings::files, &FileSettings::name>(), standard(R"("mesh")"), restart,
     "`NAME` of the files, which are this gateway's alone (`.NAME.lock`)"},
    {"interval", duration<&Settings::files, &FileSettings::interval>(1ms), standard(R"("1min")"),
     at_once,
     "written at the most so often, sooner while the mesh grows after a start, and at the end; "
     "what that [costs a disk](capacity.md#disk)"},
};

constexpr Key state_keys[] = {
    {"folder", path_from_file<&Settings::state, &StateSettings::folder>(),
     required(R"("/var/lib/etcm/state")"), restart,
     "made where there is none; a folder of its own for each gateway"},
    {"interval", duration<&Settings::state, &StateSettings::interval>(1s), standard(R"("1min")"),
     restart, "saved at the most so often, where something has changed, and at the end"},
};

constexpr Key control_keys[] = {
    {"socket", path_from_file<&Settings::control, &ControlSettings::socket>(),
     unset(R"("/run/etcm/control")", "`control` in the folder that systemd gives the service"),
     restart,
     "a Unix socket, for `etcm-gateway ctl`: root and the user of the gateway may use it, and "
     "nobody over a network"},
};

constexpr Meaning<FleetShare> shares[] = {{"publish", FleetShare::publish},
                                          {"site", FleetShare::site}};

constexpr Key mqtt_keys[] = {
    {"broker", endpoint_with_standard_port<&Settings::mqtt, &MqttSettings::broker>(),
     required(R"("192.0.2.5")"), restart,
     "an address, `\"[2001:db8::1]:1883\"` of IPv6, or a [name](wiring.md#by-name); without a port "
     "1883, with TLS 8883"},
    {"site", name<&Settings::mqtt, &MqttSettings::site>(), required(R"("harbour")"), restart,
     "the same for all gateways of a site"},
    {"name", name<&Settings::mqtt, &MqttSettings::name>(), required(R"("north")"), restart,
     "of this gateway; no other one of the site has it, and none is called `site`"},
    {"share", choice<shares, &Settings::mqtt, &MqttSettings::share>(), standard(R"("publish")"),
     restart,
     "`publish`: others learn the nodes of this gateway; `site`: and the nodes of the others are "
     "in its mesh, so that all gateways with `site` have the same; it needs no `[[bus]]` then; "
     "where `publish` is written, nobody tells that its mesh is another one"},
    {"user", text<&Settings::mqtt, &MqttSettings::user>(),
     unset(R"("north")", "`name`, where there is a `password_file`"), restart,
     "who it is to the broker"},
    {"password_file", path_from_file<&Settings::mqtt, &MqttSettings::password_file>(),
     unset(R"("mqtt.password")"), restart, "a file with the password, in its first line"},
    {"tls_ca", path_from_file<&Settings::mqtt, &MqttSettings::tls_ca>(), unset(R"("ca.pem")"),
     restart, "TLS: the certificate of the CA that has signed the broker's, in PEM"},
    {"tls_certificate", path_from_file<&Settings::mqtt, &MqttSettings::tls_certificate>(),
     unset(R"("north.pem")"), restart, "certificate of the gateway, where the broker wants one"},
    {"tls_key", path_from_file<&Settings::mqtt, &MqttSettings::tls_key>(), unset(R"("north.key")"),
     restart, "the key of that, without a password"},
    {"psk_identity", text<&Settings::mqtt, &MqttSettings::psk_identity>(), unset(R"("north")"),
     restart, "TLS without certificates, by a key that both know: the name of the key"},
    {"psk_file", path_from_file<&Settings::mqtt, &MqttSettings::psk_file>(), unset(R"("mqtt.psk")"),
     restart, "a file with that key, hexadecimal, in its first line: `openssl rand -hex 32`"},
    {"keep_alive", duration<&Settings::mqtt, &MqttSettings::keep_alive>(5s), standard(R"("30s")"),
     restart,
     "a broker that has heard nothing for half as much again tells the others that this gateway is "
     "gone; whole seconds, up to 18 hours"},
    {"period_min", duration<&Settings::mqtt, &MqttSettings::period_min>(100ms),
     standard(R"("500ms")"), restart, "a node that changes is told of at the most so often"},
    {"period_max", duration<&Settings::mqtt, &MqttSettings::period_max>(1s), standard(R"("10min")"),
     restart, "one that does not is told of again at the latest then"},
    {"sparkplug", text<&Settings::mqtt, &MqttSettings::sparkplug>(), unset(R"("plant")"), restart,
     "the group in which this gateway is an edge node of [Sparkplug B](mqtt.md#sparkplug-b), "
     "`name` is its name there"},
    {"home_assistant", text<&Settings::mqtt, &MqttSettings::home_assistant>(),
     unset(R"("homeassistant")"), restart,
     "the topic below which [Home Assistant](mqtt.md#home-assistant) looks for devices, "
     "`homeassistant` where nobody has changed it"},
};

constexpr Key feature_keys[] = {
    {"from",
     count<&FeatureSettings::from, &FeatureEnd::serial, &Serial::value>(0, Serial::none_value - 1,
                                                                        "serial"),
     required("1001"), at_once, "the node at one end; in the mesh while both nodes are"},
    {"to",
     count<&FeatureSettings::to, &FeatureEnd::serial, &Serial::value>(0, Serial::none_value - 1,
                                                                      "serial"),
     required("1002"), at_once, "the node at the other end"},
    {"name", called<&FeatureSettings::name>(), unset(R"("north fence")"), at_once,
     "what people call it, in the log, on the page and in documents"},
};

template <auto member>
bool is_set(const Settings& settings) {
  return (settings.*member).has_value();
}
template <auto member>
void emplace(Settings& settings) {
  (settings.*member).emplace();
}

using TableKind = KeyTable::Kind;

constexpr KeyTable tables[] = {
    {"", TableKind::always, "", "keys that stand before all tables", profile_keys},
    {"site", TableKind::optional, "no site file",
     "features, anchors and the domain, [drawn in a file](site.md)", site_keys},
    {"mesh", TableKind::always, "required", "the memory of the mesh is taken once, at the start",
     mesh_keys, "[mesh] with vertices_max"},
    {"poll", TableKind::always, "", "how the nodes are asked, on all buses", poll_keys},
    {"bus", TableKind::list, "as many as needed; without one nobody is asked",
     "a connection with Modbus TCP, or a serial port; [a reload adds more](#additions)", bus_keys},
    {"bus.device", TableKind::list, "as many as needed",
     "after its `[[bus]]`: units that are other devices, or need longer than the others; [a reload "
     "adds more](#additions)",
     device_keys},
    {"node", TableKind::list, "as many as needed",
     "[a device](profiles.md) that does not know where it stands, or is to have a serial; [a "
     "reload "
     "adds more](#additions)",
     node_keys},
    {"write_back", TableKind::always, "", "what nodes are told", write_back_keys},
    {"gpio", TableKind::always, "",
     "lines by name, or `\"CHIP:OFFSET\"`; `\"!NAME\"` is active when low. `gpioinfo` lists them",
     gpio_keys},
    {"server", TableKind::always, "", "where other masters read the mesh, over Modbus TCP",
     server_keys},
    {"analysis", TableKind::always, "nothing worked out",
     "[what each mesh tells](analysis.md) about radio links and coverage", analysis_keys},
    {"http", TableKind::optional, "no page",
     "the status page: `http://` and the address of `listen`, in a browser", http_keys, nullptr,
     is_set<&Settings::http>, emplace<&Settings::http>},
    {"files", TableKind::optional, "none written",
     "`NAME.node`, `NAME.ele`, `NAME.svg`, and `NAME.geojson` where devices measure; replaced "
     "one right after the other, each whole: of one mesh are `.node` and `.ele` whose first lines "
     "are the same",
     file_keys, nullptr, is_set<&Settings::files>, emplace<&Settings::files>},
    {"state", TableKind::optional, "none kept", "what [outlives a restart](#a-restart)", state_keys,
     nullptr, is_set<&Settings::state>, emplace<&Settings::state>},
    {"control", TableKind::always, "", "where a person on the gateway [tells it something](ctl.md)",
     control_keys},
    {"mqtt", TableKind::optional, "no fleet",
     "a broker by which the gateways of a site [know of each other](mqtt.md)", mqtt_keys, nullptr,
     is_set<&Settings::mqtt>, emplace<&Settings::mqtt>},
    {"feature", TableKind::list, "as many as needed",
     "a line from node to node that the mesh follows", feature_keys},
};

}  // namespace

std::span<const KeyTable> key_tables() { return tables; }

const KeyTable& key_table(std::string_view name) {
  for (const KeyTable& table : tables) {
    if (table.name == name) return table;
  }
  throw std::logic_error("no table of the settings is named " + std::string(name));
}

const Key& key_of(const KeyTable& table, std::string_view name) {
  for (const Key& key : table.keys) {
    if (key.name == name) return key;
  }
  throw std::logic_error("no key of " + heading_of(table) + " is named " + std::string(name));
}

BusKind kind_of(const BusSettings& bus) {
  return std::holds_alternative<port::SerialLine>(bus.link) ? BusKind::rtu : BusKind::tcp;
}

const char* to_string(Effect effect) {
  switch (effect) {
    case Effect::at_once:
      return "at once";
    case Effect::additions:
      return "additions";
    case Effect::restart:
      return "restart";
  }
  return "";
}

std::string heading_of(const KeyTable& table) {
  if (*table.name == '\0') return {};
  const std::string heading = "[" + std::string(table.name) + "]";
  return table.kind == TableKind::list ? "[" + heading + "]" : heading;
}

std::string path_of(const KeyTable& table, const Key& key) {
  return heading_of(table) + (*table.name == '\0' ? "" : " ") + key.name;
}

}  // namespace etcm::firmware
