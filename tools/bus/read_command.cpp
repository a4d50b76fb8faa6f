// etcm-bus read: registers, as the numbers they mean, coils and discrete inputs.
#include <algorithm>
#include <cstdio>

#include "command.h"
#include "etcm/port/node_bus.h"

namespace etcm::bus {

namespace {

struct ReadOptions {
  BusOptions bus{"1", "0.5"};
  TypeOptions type;
  std::string first;
  std::uint32_t count = 1;
};

// Reads them in as few questions as there can be; a value never comes from two of them.
std::optional<ErrorDetail> read_all(Master& master, std::uint8_t unit, std::uint8_t function,
                                    std::uint16_t first, Registers& registers,
                                    std::size_t per_value, std::size_t at_most) {
  const std::size_t at_once = at_most / per_value * per_value;
  for (std::size_t at = 0; at < registers.size(); at += at_once) {
    const auto part = std::span(registers).subspan(at, std::min(at_once, registers.size() - at));
    const auto error_detail =
        master.read(unit, function, static_cast<std::uint16_t>(first + at), part);
    if (error_detail) return error_detail;
  }
  return std::nullopt;
}

int read(const ReadOptions& options) {
  const auto units = options.bus.units();
  const std::uint8_t function = options.type.function();
  const bool are_bits = options.type.are_bits();
  const ValueType type = options.type.type();
  const std::size_t at_once = are_bits ? bits_at_once : port::read_registers_max;
  const std::uint16_t first = parse_first(options.first);
  const std::size_t per_value = type.register_count();
  Registers registers(options.count * per_value);
  if (first + registers.size() > register_end) {
    throw UsageError("-c " + std::to_string(options.count) + ": ends behind " +
                     (are_bits ? "address" : "register") + " 65535");
  }
  const port::Duration timeout = options.bus.timeout();
  const auto link = options.bus.open();
  Master master(*link, timeout);
  int result = exit_ok;
  for (const std::uint8_t unit : units) {
    if (const auto error_detail =
            read_all(master, unit, function, first, registers, per_value, at_once)) {
      std::fprintf(stderr, "etcm-bus: unit %u on %s: %s%s\n", unit, link->name().c_str(),
                   to_string(*error_detail).c_str(), cure_of(*error_detail).c_str());
      result = exit_trouble;
      continue;
    }
    if (units.size() > 1) std::printf("unit %u\n", unit);
    for (std::size_t at = 0; at < registers.size(); at += per_value) {
      std::printf("%5zu  %s\n", first + at,
                  format_value(std::span(registers).subspan(at, per_value), type).c_str());
    }
  }
  return result;
}

}  // namespace

void add_read_command(CLI::App& program, Run& run) {
  CLI::App* const command = program.add_subcommand(
      "read", "registers, as the numbers they mean, coils and discrete inputs");
  const auto options = std::make_shared<ReadOptions>();
  options->bus.add_to(*command);
  options->type.add_to(*command, "4");
  add_first_option(*command, options->first);
  command->add_option("-c,--count", options->count, "values")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  command->callback([options, &run] { run = [options] { return read(*options); }; });
}

}  // namespace etcm::bus
