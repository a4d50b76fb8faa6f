#include "firmware/config/cross_checks.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "firmware/config/secret_file.h"

namespace etcm::firmware {

namespace {

// "5 s", "0.25 s".
std::string seconds(port::Duration duration) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g s",
                std::chrono::duration<double>(duration).count());
  return text.data();
}

// The units that a bus always asks, but for the one where new nodes answer: each may be a node.
std::size_t asked_count(const BusSettings& bus) {
  std::size_t count = 0;
  for (const ModbusAddress unit : UnitRange{.first = 1, .last = unit_max}) {
    const auto contains = [unit](UnitRange range) { return range.contains(unit); };
    count += std::any_of(bus.units.begin(), bus.units.end(), contains) ||
                     std::any_of(bus.assign.begin(), bus.assign.end(), contains)
                 ? 1
                 : 0;
  }
  return count;
}

bool is_reached(const port::HostAddress& host, const port::HostAddress& at) {
  const bool is_here = port::this_machine.contains(host) || host == port::loopback_ipv6;
  return host == at || (at == port::any_ipv6 && is_here) ||
         (at == port::any_ipv4 && is_here && host.is_ipv4());
}

// Whether a connection to `to` ends where somebody listens at `at`. The address of no host, to
// which one may connect, is this machine; of names one alone is known.
bool reaches(const port::Endpoint& to, const port::SocketAddress& at) {
  if (to.port != at.port) return false;
  if (to.host == "localhost") {
    return is_reached(port::loopback_ipv4, at.host) || is_reached(port::loopback_ipv6, at.host);
  }
  const auto host = port::address_of(to);
  if (!host) return false;
  return is_reached(*host == port::any_ipv4   ? port::loopback_ipv4
                    : *host == port::any_ipv6 ? port::loopback_ipv6
                                              : *host,
                    at.host);
}

// The same, with nothing in it beside the bits that count.
port::Network without_host(port::Network network) {
  std::size_t bits = network.prefix + (network.host.is_ipv4() ? 96u : 0u);
  for (std::uint8_t& byte : network.host.bytes) {
    const std::size_t here = std::min<std::size_t>(bits, 8);
    byte = static_cast<std::uint8_t>(byte & (0xff00u >> here));
    bits -= here;
  }
  return network;
}

// Whether a name with "/dev/" before it or without is the same line.
std::string_view without_folder(std::string_view line) {
  constexpr std::string_view folder = "/dev/";
  return line.starts_with(folder) ? line.substr(folder.size()) : line;
}

class CrossCheck {
 public:
  CrossCheck(const toml::table& file, const std::string& path, const Settings& settings)
      : file_(file), path_(path), settings_(settings) {}

  void run() {
    check_times();
    check_buses();
    check_room();
    for (std::size_t i = 0; i < settings_.buses.size(); ++i) {
      check_address(i);
      check_share(i);
      check_port(i);
      check_speed(i);
      check_sweep(i);
    }
    check_lines();
    check_servers();
    if (settings_.mqtt) {
      check_writing(*settings_.mqtt);
      check_broker(*settings_.mqtt);
      check_secrets(*settings_.mqtt);
    }
  }

  static std::vector<std::string> in_order(std::vector<std::pair<std::uint32_t, std::string>> all) {
    std::stable_sort(all.begin(), all.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::string> lines;
    lines.reserve(all.size());
    for (auto& [line, text] : all) lines.push_back(std::move(text));
    return lines;
  }

  std::vector<std::string> mistakes() const { return in_order(mistakes_); }
  std::vector<std::string> warnings() const { return in_order(warnings_); }

 private:
  using Lines = std::vector<std::pair<std::uint32_t, std::string>>;

  void add(Lines& to, const toml::node* node, const std::string& what) const {
    const std::uint32_t line = node == nullptr ? 1 : node->source().begin.line;
    to.emplace_back(line, path_ + ":" + std::to_string(line) + ": " + what);
  }

  // The first of the keys that the table has, or the table.
  const toml::node* find(const char* table, std::initializer_list<const char*> keys) const {
    const toml::node* const node = file_.get(table);
    return node == nullptr ? nullptr : find(*node->as_table(), keys);
  }
  const toml::node* find_in_bus(std::size_t bus, std::initializer_list<const char*> keys) const {
    return find(*(*file_.get_as<toml::array>("bus"))[bus].as_table(), keys);
  }
  static const toml::node* find(const toml::table& table, std::initializer_list<const char*> keys) {
    for (const char* const key : keys) {
      if (const toml::node* const node = table.get(key)) return node;
    }
    return &table;
  }

  void check_times() {
    const PollSettings& poll = settings_.poll;
    const std::string stale_after = "stale_after (" + seconds(poll.stale_after) + ") is ";
    if (poll.stale_after < poll.interval) {
      add(mistakes_, find("poll", {"stale_after", "interval"}),
          stale_after + "shorter than interval (" + seconds(poll.interval) +
              "), so every node would be stale between two questions; make stale_after several "
              "times as long as interval");
    } else if (poll.stale_after > poll.leave_after) {
      add(warnings_, find("poll", {"stale_after", "leave_after"}),
          stale_after + "longer than leave_after (" + seconds(poll.leave_after) +
              "), so a silent node leaves before it is marked stale; make leave_after longer than "
              "stale_after");
    }
  }

  // A gateway that has the nodes of others may have none of its own.
  void check_buses() {
    const bool has_others = settings_.mqtt && settings_.mqtt->share == FleetShare::site;
    if (!settings_.buses.empty() || has_others) return;
    if (settings_.mqtt) {
      add(warnings_, find("mqtt", {"share"}),
          "there is no [[bus]], and no share = \"site\", so the mesh stays empty; set share = "
          "\"site\" in [mqtt] for the nodes of the other gateways, or add a [[bus]]");
      return;
    }
    add(warnings_, nullptr,
        "there is no [[bus]], so nobody is asked where it stands; add one with tcp or rtu, and "
        "units");
  }

  void check_room() {
    std::size_t units = 0;
    for (const BusSettings& bus : settings_.buses) units += asked_count(bus);
    if (units <= settings_.mesh.vertices_max) return;
    add(warnings_, find("mesh", {"vertices_max"}),
        "the buses have " + std::to_string(units) + " units, and vertices_max is " +
            std::to_string(settings_.mesh.vertices_max) +
            ", so nodes may find no room in the mesh; set vertices_max to twice as many as there "
            "are "
            "nodes");
  }

  // Who listens for others means to let some of them in. `node`: the key that says so; null: it is
  // not written.
  void check_reach(const toml::node* node, const std::string& key, const char* allow_key,
                   const port::SocketAddress& at, const std::vector<port::Network>& allow) {
    const auto is_here = [](const port::HostAddress& host) {
      return port::this_machine.contains(host) || host == port::loopback_ipv6;
    };
    const bool lets_in_any = std::any_of(allow.begin(), allow.end(), [&](const auto& network) {
      return network.prefix == 0 || !is_here(network.host);
    });
    if (is_here(at.host) || lets_in_any || node == nullptr) return;
    add(warnings_, node,
        key + " is for other machines, but '" + allow_key +
            "' lets in this one alone; add your network there, such as " + allow_key +
            " = [\"127.0.0.0/8\", \"192.168.1.0/24\"]");
  }

  // `node`: where they are listed; whatever it is where they are not.
  void check_networks(const toml::node* node, const std::string& key,
                      const std::vector<port::Network>& networks) {
    for (const port::Network& network : networks) {
      const port::Network meant = without_host(network);
      if (meant == network) continue;
      add(warnings_, node,
          key + " has \"" + to_string(network) + "\", which is taken as the network " +
              to_string(meant) + "; write that, or \"" + port::host_text(network.host) +
              "\" for this address alone");
    }
  }

  void check_servers() {
    const ServerSettings& server = settings_.server;
    check_networks(find("server", {"allow"}), "'allow' of [server]", server.allow);
    if (settings_.http) {
      check_networks(find("http", {"allow"}), "'allow' of [http]", settings_.http->allow);
    }
    check_reach(find("server", {"listen"}), "'listen' of [server]", "allow", server.listen,
                server.allow);
    if (!settings_.http) return;
    check_reach(find("http", {"listen"}), "'listen' of [http]", "allow", settings_.http->listen,
                settings_.http->allow);
  }

  void check_address(std::size_t bus) {
    const auto* const end = std::get_if<port::Endpoint>(&settings_.buses[bus].link);
    if (end == nullptr) return;
    const auto wrong = [&](const std::string& what) {
      add(mistakes_, find_in_bus(bus, {"tcp"}), what);
    };
    const auto is_itself = [&](const char* does) {
      wrong(to_string(*end) + " is where this gateway itself " + does +
            "; give the address of the converter or of the nodes");
    };
    if (end->port == 0) {
      wrong("nobody answers at port 0; give the port of the converter, such as " +
            to_string(port::Endpoint{end->host, 502}));
    } else if (reaches(*end, settings_.server.listen)) {
      is_itself("serves the mesh");
    } else if (settings_.http && reaches(*end, settings_.http->listen)) {
      is_itself("shows its page");
    }
    for (const BusSettings& other : settings_.buses) {
      if (!other.share.listen || !reaches(*end, *other.share.listen)) continue;
      is_itself(("shares bus '" + other.name + "'").c_str());
    }
  }

  // Where others come to the bus nothing else of the gateway listens.
  void check_share(std::size_t number) {
    const ShareSettings& share = settings_.buses[number].share;
    const auto& listen = share.listen;
    if (!listen) return;
    check_networks(find_in_bus(number, {"share_allow"}),
                   "'share_allow' of bus '" + settings_.buses[number].name + "'", share.allow);
    check_reach(find_in_bus(number, {"share"}),
                "'share' of bus '" + settings_.buses[number].name + "'", "share_allow", *listen,
                share.allow);
    const auto taken = [&](const std::string& by) {
      add(mistakes_, find_in_bus(number, {"share"}),
          to_string(*listen) + " is where " + by + "; give share another port");
    };
    if (is_one_place(*listen, settings_.server.listen)) taken("[server] listens");
    if (settings_.http && is_one_place(*listen, settings_.http->listen)) taken("[http] listens");
    for (std::size_t i = 0; i < number; ++i) {
      const auto& other = settings_.buses[i].share.listen;
      if (other && is_one_place(*listen, *other)) {
        taken("bus '" + settings_.buses[i].name + "' is shared");
      }
    }
  }

  // A serial port may have several names. One that is not there yet has none to compare; when it
  // comes, the bus that finds it taken tells.
  void check_port(std::size_t number) {
    const std::filesystem::path path = port_of(number);
    if (path.empty()) return;
    std::error_code unknown;
    if (!std::filesystem::is_character_file(path, unknown) && !unknown) {
      const bool is_folder = std::filesystem::is_directory(path, unknown);
      add(mistakes_, find_in_bus(number, {"rtu"}),
          link_name(settings_.buses[number]) + " is a " + (is_folder ? "folder" : "file") +
              ", and no serial port; give the path of one (ls /dev/serial/by-path lists them)");
      return;
    }
    for (std::size_t i = 0; i < number; ++i) {
      if (port_of(i) != path) continue;
      const auto name = [&](std::size_t bus) { return link_name(settings_.buses[bus]); };
      add(mistakes_, find_in_bus(number, {"rtu"}),
          name(number) + " is the serial port of bus '" + settings_.buses[i].name + "' too (" +
              name(i) + ", both are " + path.string() + "); put the units of both into one");
      return;
    }
  }
  std::filesystem::path port_of(std::size_t bus) const {
    const auto* const line = std::get_if<port::SerialLine>(&settings_.buses[bus].link);
    std::error_code is_not_there;
    return line == nullptr ? "" : std::filesystem::canonical(line->path, is_not_there);
  }

  // Within this of a usual speed it is more likely meant to be that one.
  void check_speed(std::size_t number) {
    constexpr std::uint32_t likely_percent = 5;
    const auto* const line = std::get_if<port::SerialLine>(&settings_.buses[number].link);
    if (line == nullptr) return;
    const std::uint32_t usual = port::usual_baud_near(line->baud);
    const std::uint32_t apart = usual < line->baud ? line->baud - usual : usual - line->baud;
    if (apart == 0 || apart > usual * likely_percent / 100) return;
    add(warnings_, find_in_bus(number, {"baud"}),
        "baud = " + std::to_string(line->baud) + " is no usual speed, and " +
            std::to_string(usual) + " is near; correct it unless the units have just that one");
  }

  // Of a bus over TCP it is not known how fast it is.
  void check_sweep(std::size_t number) {
    const BusSettings& bus = settings_.buses[number];
    const auto* const line = std::get_if<port::SerialLine>(&bus.link);
    if (line == nullptr) return;
    const std::size_t units = asked_count(bus);
    const port::Duration sweep = static_cast<std::int64_t>(units) * exchange_floor(*line);
    if (sweep <= settings_.poll.stale_after) return;
    add(warnings_, find_in_bus(number, {"units", "assign"}),
        "to ask all " + std::to_string(units) + " units of bus '" + bus.name + "' takes " +
            seconds(sweep) + " at " + std::to_string(line->baud) +
            " baud at the least, and stale_after is " + seconds(settings_.poll.stale_after) +
            ", so nodes would be stale between two answers; raise baud or stale_after, or divide "
            "the units between two buses");
  }

  // A line of the board does one thing.
  void check_lines() {
    struct Use {
      std::string_view line;
      std::string what;
      const toml::node* node;
    };
    std::vector<Use> uses;
    const auto use = [&](const std::optional<LineSettings>& line, std::string what,
                         const toml::node* node) {
      if (line) uses.push_back({without_folder(line->name), std::move(what), node});
    };
    const GpioSettings& gpio = settings_.gpio;
    use(gpio.alert, "alert", find("gpio", {"alert"}));
    use(gpio.join_button, "join_button", find("gpio", {"join_button"}));
    use(gpio.status_led, "status_led", find("gpio", {"status_led"}));
    use(gpio.watchdog, "watchdog", find("gpio", {"watchdog"}));
    for (std::size_t i = 0; i < settings_.buses.size(); ++i) {
      use(settings_.buses[i].send_enable, "rs485_line of bus '" + settings_.buses[i].name + "'",
          find_in_bus(i, {"rs485_line"}));
    }
    std::stable_sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
      return a.node->source().begin.line < b.node->source().begin.line;
    });
    for (auto later = uses.begin(); later != uses.end(); ++later) {
      const auto earlier = std::find_if(
          uses.begin(), later, [&](const Use& other) { return other.line == later->line; });
      if (earlier == later) continue;
      add(mistakes_, later->node,
          "the line " + std::string(later->line) + " is " + earlier->what +
              " already; give each a line of its own");
    }
  }

  // Neighbours of a node are nodes of other gateways too, which are known by MQTT.
  void check_writing(const MqttSettings& mqtt) {
    if (!settings_.write_back.is_enabled || mqtt.share != FleetShare::site) return;
    add(mistakes_, find("write_back", {"enabled"}),
        "[write_back] would write to devices here what other gateways tell by MQTT, with share = "
        "\"site\" in [mqtt]; take enabled = true out, or write share = \"publish\"");
  }

  void check_broker(const MqttSettings& mqtt) {
    const char* does = nullptr;
    if (reaches(mqtt.broker, settings_.server.listen)) does = "serves the mesh";
    if (settings_.http && reaches(mqtt.broker, settings_.http->listen)) does = "shows its page";
    for (const BusSettings& bus : settings_.buses) {
      if (bus.share.listen && reaches(mqtt.broker, *bus.share.listen)) does = "shares a bus";
    }
    if (does == nullptr) return;
    add(mistakes_, find("mqtt", {"broker"}),
        to_string(mqtt.broker) + " is where this gateway itself " + does +
            "; give the address of the broker");
  }

  // Files whose content is told nobody.
  void check_secrets(const MqttSettings& mqtt) {
    struct File {
      const char* key;
      const std::string& path;
      std::string (*read)(const std::string&, std::string&);
      bool is_secret;
    };
    for (const File& file : {File{"password_file", mqtt.password_file, read_secret, true},
                             File{"psk_file", mqtt.psk_file, read_key, true},
                             File{"tls_ca", mqtt.tls_ca, read_secret, false},
                             File{"tls_certificate", mqtt.tls_certificate, read_secret, false},
                             File{"tls_key", mqtt.tls_key, read_secret, true}}) {
      if (file.path.empty()) continue;
      std::string why;
      if (is_credential(file.path) && read_secret(file.path, why).empty()) {
        // The service itself will see: it does not start without.
        add(warnings_, find("mqtt", {file.key}),
            file.path +
                " is not looked at: systemd gives it to the service alone, and only while that "
                "runs");
      } else if (file.read(file.path, why).empty()) {
        add(mistakes_, find("mqtt", {file.key}), why);
      } else if (file.is_secret && is_public(file.path)) {
        add(warnings_, find("mqtt", {file.key}),
            "everybody on this machine may read " + file.path +
                "; take that away: chmod o= " + file.path);
      }
    }
  }

  const toml::table& file_;
  const std::string& path_;
  const Settings& settings_;
  Lines mistakes_;
  Lines warnings_;
};

}  // namespace

void check_across(const toml::table& file, const std::string& path, Settings& settings,
                  std::vector<std::string>& mistakes) {
  CrossCheck check(file, path, settings);
  check.run();
  for (std::string& mistake : check.mistakes()) mistakes.push_back(std::move(mistake));
  if (mistakes.empty()) settings.warnings = check.warnings();
}

}  // namespace etcm::firmware
