// etcm-bus probe: a device by its profile, each field raw and as what it means.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>

#include "command.h"
#include "firmware/profile/profile_reader.h"
#include "firmware/protocol/modbus_exception.h"

namespace etcm::bus {

namespace {

using firmware::Condition;
using firmware::Field;
using firmware::FieldValue;
using firmware::Profile;
using firmware::RegisterSpan;

struct ProbeOptions {
  BusOptions bus{"1", "0.5"};
  std::string profile;
  std::string path;  // empty: those that were installed
};

const Profile& find_profile(const std::vector<Profile>& profiles, const std::string& name,
                            const std::string& path) {
  std::string names;
  for (const Profile& profile : profiles) {
    if (profile.name == name) return profile;
    names += (names.empty() ? "" : ", ") + profile.name;
  }
  throw UsageError("--profile " + name + ": no such profile in " + path +
                   "; there are: " + (names.empty() ? "none" : names));
}

std::vector<Profile> read_profiles(const std::string& path) {
  std::vector<std::string> mistakes;
  std::vector<Profile> profiles =
      firmware::read_profiles_or_gateways(path, firmware::installed_profiles(), mistakes);
  if (mistakes.empty()) return profiles;
  std::string text = mistakes.front();
  for (std::size_t i = 1; i < mistakes.size(); ++i) text += "\netcm-bus: " + mistakes[i];
  throw UsageError(text);
}

// "12.5"; every digit that is not zero.
std::string decimal_text(std::int64_t nano) {
  char text[32];
  const bool is_negative = nano < 0;
  const std::uint64_t size =
      is_negative ? ~static_cast<std::uint64_t>(nano) + 1 : static_cast<std::uint64_t>(nano);
  std::snprintf(text, sizeof text, "%s%llu.%09llu", is_negative ? "-" : "",
                static_cast<unsigned long long>(size / 1'000'000'000),
                static_cast<unsigned long long>(size % 1'000'000'000));
  std::string shown = text;
  shown.erase(shown.find_last_not_of('0') + 1);
  if (shown.back() == '.') shown.pop_back();
  return shown;
}

std::string meaning_of(const FieldValue& value, const std::string& unit) {
  std::string shown = decimal_text(value.nano) + (unit.empty() ? "" : " " + unit);
  switch (value.state) {
    case FieldValue::State::value:
      return shown;
    case FieldValue::State::none:
      return "none";
    case FieldValue::State::malformed:
      return "malformed: not written as its type and format say";
    case FieldValue::State::other_axis:
      return std::string("malformed: the letter ") + value.letter +
             " does not belong to this field";
    case FieldValue::State::no_letter:
      return "malformed: no letter of this field where negative_if looks for it";
    case FieldValue::State::out_of_range:
      return value.nano == 0 ? "out of range" : "out of range: " + shown;
  }
  return "";
}

std::string meaning_of(const firmware::DevicePosition& position) {
  if (position.is_value()) return "yes";
  const firmware::NoPosition why = explain(position.state);
  return std::string("no: it ") + why.what + "; " + why.cure;
}

// A table with columns as wide as they need to be, a row for each field.
class FieldTable {
 public:
  FieldTable(const Profile& profile, const firmware::Sweep& sweep)
      : profile_(profile), sweep_(sweep) {}

  void add(const std::string& name, const Field& field, const FieldValue& value,
           const std::string& unit = "") {
    std::vector<RegisterSpan> spans;
    add_spans(field, spans);
    add(name, spans, meaning_of(value, unit));
  }
  void add(const std::string& name, std::span<const Condition> conditions) {
    for (const Condition& condition : conditions) {
      std::vector<RegisterSpan> spans;
      add_spans(condition, spans);
      add(name, spans, condition.holds(sweep_) ? "yes" : "no");
    }
  }
  void add(const std::string& name, std::span<const RegisterSpan> spans, const std::string& value) {
    Row row{name, "", "", value};
    for (const RegisterSpan span : spans) {
      const std::uint32_t first = profile_.counts_from + span.first;
      row[1] += (row[1].empty() ? "" : ",") + std::to_string(first);
      if (span.count > 1) row[1] += "-" + std::to_string(first + span.count - 1);
      for (const std::uint16_t word : sweep_.at(span)) {
        char text[8];
        std::snprintf(text, sizeof text, "%s%04X", row[2].empty() ? "" : " ", word);
        row[2] += text;
      }
    }
    rows_.push_back(row);
  }

  void print() const {
    std::array<int, 3> widths{};
    for (const Row& row : rows_) {
      for (std::size_t i = 0; i < widths.size(); ++i) {
        widths[i] = std::max(widths[i], static_cast<int>(row[i].size()));
      }
    }
    for (const Row& row : rows_) {
      std::printf("  %-*s  %-*s  %-*s  %s\n", widths[0], row[0].c_str(), widths[1], row[1].c_str(),
                  widths[2], row[2].c_str(), row[3].c_str());
    }
    std::fflush(stdout);
  }

 private:
  using Row = std::array<std::string, 4>;

  const Profile& profile_;
  const firmware::Sweep& sweep_;
  std::vector<Row> rows_{{"field", "registers", "raw", "value"}};
};

void print(const Profile& profile, const firmware::Sweep& sweep) {
  FieldTable table(profile, sweep);
  if (profile.serial) table.add("serial", *profile.serial, decode(*profile.serial, sweep));
  table.add("valid", profile.valid);
  if (profile.positioning != Profile::Positioning::surveyed) {
    const bool is_plane = profile.positioning == Profile::Positioning::plane;
    const char* const unit = is_plane ? "" : "degrees";
    table.add(is_plane ? "x" : "longitude", profile.east, decode(profile.east, sweep), unit);
    table.add(is_plane ? "y" : "latitude", profile.north, decode(profile.north, sweep), unit);
    table.add("position", {}, meaning_of(position_of(profile, sweep)));
  }
  for (const Profile::Reading& reading : profile.readings) {
    table.add(reading.name + " valid", reading.valid);
    table.add(reading.name, reading.value, reading_of(reading, sweep), reading.unit);
  }
  table.print();
}

// What to do about one that reading these registers met.
std::string complaint_of(const Profile& profile, RegisterSpan block, const ErrorDetail& detail) {
  const bool is_exception = detail.kind == ErrorDetail::Kind::exception && !detail.is_absence();
  if (!is_exception) return to_string(detail) + cure_of(detail);
  const std::uint32_t first = profile.counts_from + block.first;
  return "registers " + std::to_string(first) + " to " + std::to_string(first + block.count - 1) +
         ": " + to_string(detail) + "; " +
         firmware::explain_exception(detail.exception, false).cure;
}

// One sweep of all blocks. Why there is none, or an empty text.
std::string read_sweep(Master& master, std::uint8_t unit, const Profile& profile,
                       std::span<const RegisterSpan> blocks, Registers& registers) {
  registers.clear();
  for (const RegisterSpan block : blocks) {
    const std::size_t before = registers.size();
    registers.resize(before + block.count);
    const auto error_detail =
        master.read(unit, profile.function, block.first, std::span(registers).subspan(before));
    if (profile.pause > port::Duration{}) master.link().pause(profile.pause);
    if (error_detail) return complaint_of(profile, block, *error_detail);
  }
  return "";
}

int probe(const ProbeOptions& options) {
  const auto units = options.bus.units();
  const std::string path = options.path.empty() ? firmware::installed_profiles() : options.path;
  const std::vector<Profile> profiles = read_profiles(path);
  const Profile& profile = find_profile(profiles, options.profile, path);
  const auto blocks = firmware::blocks_of(profile);
  const port::Duration timeout = options.bus.timeout();
  const auto link = options.bus.open();
  Master master(*link, timeout);
  Registers registers;
  int result = exit_ok;
  for (const std::uint8_t unit : units) {
    const std::string complaint = read_sweep(master, unit, profile, blocks, registers);
    if (!complaint.empty()) {
      std::fprintf(stderr, "etcm-bus: unit %u on %s: %s\n", unit, link->name().c_str(),
                   complaint.c_str());
      result = exit_trouble;
      continue;
    }
    std::printf("unit %u, %s: %zu registers in %zu %s\n", unit, profile.name.c_str(),
                registers.size(), blocks.size(), blocks.size() == 1 ? "question" : "questions");
    print(profile, firmware::Sweep(blocks, registers));
  }
  return result;
}

}  // namespace

void add_probe_command(CLI::App& program, Run& run) {
  CLI::App* const command =
      program.add_subcommand("probe", "a device by its profile, raw and as what it means");
  const auto options = std::make_shared<ProbeOptions>();
  options->bus.add_to(*command);
  command->add_option("--profile", options->profile, "name of the profile")->required();
  command->add_option("--profiles", options->path,
                      "file or folder with profiles, or the configuration of a gateway; without it "
                      "those that were installed");
  command->callback([options, &run] { run = [options] { return probe(*options); }; });
}

}  // namespace etcm::bus
