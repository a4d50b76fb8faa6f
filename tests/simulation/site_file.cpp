#include "site_file.h"

#include <algorithm>
#include <sstream>

namespace etcm::simulation {

using namespace std::chrono_literals;

namespace {

std::string ms(Duration time) { return "\"" + std::to_string(time / 1ms) + "ms\""; }

void write_bus(std::ostream& out, std::size_t number, const BusText& bus) {
  out << "[[bus]]\nname = \"bus-" << static_cast<char>('a' + number) << "\"\n";
  if (bus.kind == LinkKind::serial) {
    out << "rtu = \"/dev/simulated" << number << "\"\nbaud = " << bus.baud
        << "\nquiet = \"50ms\"\n";
  } else if (bus.kind == LinkKind::serial_over_tcp) {
    out << "tcp = \"192.0.2." << number + 1 << ":4001\"\nframing = \"rtu\"\n";
  } else {
    out << "tcp = \"192.0.2." << number + 1 << ":502\"\noutstanding = " << bus.outstanding << "\n";
  }
  out << "units = \"1-" << int{bus.units} << "\"\n";
  if (bus.assigned > 0) {
    out << "assign = \"" << int{first_assigned} << "-" << first_assigned + bus.assigned - 1
        << "\"\n";
  }
  if (bus.is_shared) out << "share = \"127.0.0.1:" << 1510 + number << "\"\n";
  if (bus.first_make != Make::ours) {
    out << "[[bus.device]]\nunits = \"1\"\nprofile = \"" << profile_name(bus.first_make) << "\"\n";
  }
}

}  // namespace

bool SiteFile::asks(std::size_t bus, std::uint8_t unit) const {
  if (unit <= units(bus)) return true;
  const std::uint8_t assigned = bus < buses.size() ? buses[bus].assigned : std::uint8_t{0};
  return assigned > 0 &&
         (unit == newcomers_unit || (unit >= first_assigned && unit < first_assigned + assigned));
}

std::string SiteFile::text() const {
  std::ostringstream out;
  out << "[mesh]\nvertices_max = " << vertices_max << "\nfeatures_max = 40\nwork_max = " << work_max
      << "\n[poll]\ninterval = " << ms(interval) << "\ntimeout = " << ms(unit_timeout)
      << "\nabsent_interval = " << ms(absent_interval) << "\nstale_after = " << ms(stale_after)
      << "\nleave_after = " << ms(leave_after)
      << "\n[state]\nfolder = \"/state\"\ninterval = \"10s\"\n"
         "[files]\nfolder = \"/files\"\nname = \"mesh\"\ninterval = \"5s\"\n"
         "[http]\nlisten = \"127.0.0.1:8080\"\n"
         "[analysis]\nradio_range = 1500\nsensing_range = 900\n";
  if (plane != PlaneText{}) {
    out << "[site]\nunit = \"" << 1.0 / plane.units << "\"\norigin = [\"" << plane.origin
        << "\", \"" << -plane.origin << "\"]\n";
  }
  if (has_broker) {
    out << "[mqtt]\nbroker = \"192.0.2.200\"\nsite = \"yard\"\nname = \"west\"\n"
        << "home_assistant = \"homeassistant\"\nshare = \"" << (is_site_shared ? "site" : "publish")
        << "\"\n";
    if (has_sparkplug) out << "sparkplug = \"" << sparkplug_group << "\"\n";
  }
  if (has_write_back) out << "[write_back]\nenabled = true\n";
  for (std::size_t i = 0; i < buses.size(); ++i) write_bus(out, i, buses[i]);
  for (const Make make : {Make::in_blocks, Make::checked}) {
    if (std::ranges::find(buses, make, &BusText::first_make) != buses.end())
      out << profile_of(make);
  }
  for (const auto& [from, to] : features) {
    out << "[[feature]]\nfrom = " << from << "\nto = " << to << "\n";
  }
  return out.str();
}

std::string with_mistake(const SiteFile& file, std::size_t which) {
  SiteFile other = file;
  switch (which) {
    case 0:  // the editor was killed while it wrote
      return file.text().substr(0, file.text().size() / 2) + "\n[[bus";
    case 1:
      other.features.emplace_back(7, 7);
      return other.text();
    case 2:
      other.stale_after = other.interval / 2;
      return other.text();
    case 3:
      return other.text() + "[[bus]]\nname = \"bus-a\"\nrtu = \"/dev/another\"\nunits = \"1\"\n";
    case 4:
      return "polling = 1\n" + other.text();
    case 5:
      other.buses.front().units = 248;
      return other.text();
    case 6:
      return other.text() + "[[bus.device]]\nunits = \"1\"\nprofile = \"nobody-has-it\"\n";
    case 7:
      return {};  // the disk was full
    default: {
      // Written over by something else.
      std::string text = other.text();
      for (std::size_t i = text.size() / 3; i < text.size() / 2; ++i) text[i] = '\0';
      return text;
    }
  }
}

}  // namespace etcm::simulation
