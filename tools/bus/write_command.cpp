// etcm-bus write: registers or coils, with what was there before, and a look at what is there
// after.
#include <algorithm>
#include <cstdio>

#include "command.h"
#include "etcm/port/node_bus.h"
#include "modbus/frame.h"
#include "modbus/question.h"

namespace etcm::bus {

namespace {

struct WriteOptions {
  BusOptions bus{"1", "0.5"};
  TypeOptions type;
  std::string first;
  std::vector<std::string> values;
  bool is_broadcast = false;
  bool is_blind = false;
};

// What stands in the table that this function reads.
const char* what(std::uint8_t table) { return table == port::read_coils ? "coils" : "registers"; }

// What the user wants to stand there.
Registers wanted_by(const WriteOptions& options, ValueType type, std::uint16_t first) {
  Registers wanted;
  for (const std::string& value : options.values) {
    if (!parse_value(value, type, wanted)) {
      throw UsageError("value " + value + " does not fit -t; see -t in etcm-bus write --help");
    }
  }
  const bool are_coils = options.type.are_bits();
  const std::size_t most = are_coils ? coils_at_once : port::write_registers_max;
  if (wanted.size() > most) {
    throw UsageError(std::to_string(wanted.size()) + (are_coils ? " coils" : " registers") +
                     "; at most " + std::to_string(most) + " are written at a time");
  }
  if (are_coils && std::any_of(wanted.begin(), wanted.end(), [](auto bit) { return bit > 1; })) {
    throw UsageError("a coil is 0 or 1; give each of them so");
  }
  if (first + wanted.size() > register_end) {
    throw UsageError(std::string("ends behind ") + (are_coils ? "coil" : "register") + " 65535");
  }
  return wanted;
}

class Writer {
 public:
  Writer(Master& master, const TypeOptions& type, std::uint16_t first, const Registers& wanted)
      : master_(master),
        type_(type.type()),
        table_(type.function()),
        first_(first),
        wanted_(wanted) {}

  int write_blindly(std::uint8_t unit) const {
    if (const auto error_detail = master_.write(unit, table_, first_, wanted_)) {
      return complain(unit, refusal(*error_detail));
    }
    std::printf("unit %u took %zu %s from %u\n", unit, wanted_.size(), what(table_), first_);
    return exit_ok;
  }

  int write(std::uint8_t unit) const {
    Registers before(wanted_.size()), after(wanted_.size());
    if (const auto error_detail = read(unit, before)) {
      return complain(unit, "nothing was written, for what stands there cannot be read: " +
                                to_string(*error_detail) +
                                (error_detail->kind == ErrorDetail::Kind::exception
                                     ? "; --blind writes without reading"
                                     : ""));
    }
    try {
      const auto error_detail = master_.write(unit, table_, first_, wanted_);
      const bool is_refused = error_detail && error_detail->kind == ErrorDetail::Kind::exception;
      if (is_refused) return complain(unit, refusal(*error_detail));
      if (const auto unread = read(unit, after)) {
        print(unit, before, nullptr);
        return complain(unit, (error_detail ? refusal(*error_detail) : "took it") +
                                  ", and cannot be read any more: " + to_string(*unread));
      }
      print(unit, before, &after);
      if (error_detail) return complain(unit, refusal(*error_detail));
    } catch (const Interrupted&) {
      print(unit, before, nullptr);
      complain(unit, "interrupted, and it may have taken it: read what stands there now");
      throw;
    } catch (const LinkError&) {
      print(unit, before, nullptr);
      complain(unit, "it may have taken it: read what stands there now");
      throw;
    }
    if (after == wanted_) return exit_ok;
    return complain(unit, std::string("took it, but other values stand there now: the ") +
                              what(table_) + " may be read-only in part, or change by themselves");
  }

 private:
  std::optional<ErrorDetail> read(std::uint8_t unit, Registers& registers) const {
    return master_.read(unit, table_, first_, registers);
  }

  std::string value_at(const Registers& registers, std::size_t at) const {
    return format_value(std::span(registers).subspan(at, type_.register_count()), type_);
  }

  // Without an answer it is not known.
  static std::string refusal(const ErrorDetail& error_detail) {
    return (error_detail.kind == ErrorDetail::Kind::exception
                ? "does not take it: "
                : "does not say whether it took it: ") +
           to_string(error_detail);
  }

  // `after`: null where it is not known.
  void print(std::uint8_t unit, const Registers& before, const Registers* after) const {
    std::printf("unit %u\n", unit);
    for (std::size_t at = 0; at < before.size(); at += type_.register_count()) {
      const std::string is = after == nullptr ? "is not known" : "is " + value_at(*after, at);
      std::printf("%5zu  was %s, %s\n", first_ + at, value_at(before, at).c_str(), is.c_str());
    }
    std::fflush(stdout);
  }

  int complain(std::uint8_t unit, const std::string& what) const {
    std::fprintf(stderr, "etcm-bus: unit %u on %s: %s\n", unit, master_.link().name().c_str(),
                 what.c_str());
    return exit_trouble;
  }

  Master& master_;
  ValueType type_;
  std::uint8_t table_;  // by the function that reads it
  std::uint16_t first_;
  const Registers& wanted_;
};

int write(const WriteOptions& options) {
  const auto units = options.bus.units(everybody);
  const bool has_everybody = units.front() == everybody;
  if (has_everybody && !options.is_broadcast) {
    throw UsageError(
        "-a 0 writes to every unit of the bus, and none answers; give --broadcast "
        "where that is meant");
  }
  if (options.is_broadcast && !(has_everybody && units.size() == 1)) {
    throw UsageError("--broadcast goes to every unit; give it with -a 0");
  }
  const std::uint8_t table = options.type.function();
  if (table != port::read_holding_registers && table != port::read_coils) {
    throw UsageError("-t 1 and -t 3: inputs cannot be written; give -t 4, or -t 0 for coils");
  }
  const ValueType type = options.type.type();
  const std::uint16_t first = parse_first(options.first);
  const Registers wanted = wanted_by(options, type, first);
  const port::Duration timeout = options.bus.timeout();
  const auto link = options.bus.open();
  Master master(*link, timeout);
  if (has_everybody) {
    master.broadcast(table, first, wanted);
    std::printf("%zu %s from %u sent to every unit; read them to see who took them\n",
                wanted.size(), what(table), first);
    return exit_ok;
  }
  const Writer writer(master, options.type, first, wanted);
  int result = exit_ok;
  for (const std::uint8_t unit : units) {
    const int outcome = options.is_blind ? writer.write_blindly(unit) : writer.write(unit);
    if (outcome != exit_ok) result = outcome;
  }
  return result;
}

}  // namespace

void add_write_command(CLI::App& program, Run& run) {
  CLI::App* const command = program.add_subcommand(
      "write", "holding registers or coils, with what was there before and after");
  const auto options = std::make_shared<WriteOptions>();
  options->bus.add_to(*command, BusOptions::Digits::begin_values);
  options->type.add_to(*command, "4");
  add_first_option(*command, options->first);
  command->add_option("value", options->values, "what to write, one after the other")->required();
  command->add_flag("--broadcast", options->is_broadcast, "with -a 0: to every unit of the bus");
  command->add_flag("--blind", options->is_blind,
                    "neither read before nor after, for registers that cannot be read");
  command->callback([options, &run] { run = [options] { return write(*options); }; });
}

}  // namespace etcm::bus
