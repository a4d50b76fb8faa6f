// etcm-bus scan: which units answer, and their identities.
#include <unistd.h>

#include <cstdio>
#include <optional>

#include "command.h"
#include "node_answer.h"

namespace etcm::bus {

namespace {

struct ScanOptions {
  BusOptions bus{"1:247", "0.1"};
  std::string order = "ABCD";
  bool as_json = false;
};

struct Found {
  std::uint8_t address = 0;
  NodeAnswer node;
  port::Duration took{};
  Identification who;
};

std::string json_text(std::string_view text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += letter;
  }
  return quoted + '"';
}

std::string json_of(const Found& found) {
  const auto microseconds = found.took / std::chrono::microseconds(1);
  std::string text = "{\"unit\":" + std::to_string(found.address) +
                     ",\"answer_us\":" + std::to_string(microseconds) +
                     ",\"vendor\":" + json_text(found.who.vendor) +
                     ",\"product\":" + json_text(found.who.product) +
                     ",\"version\":" + json_text(found.who.version) +
                     ",\"server_id\":" + json_text(found.who.server_id) + ",\"node\":";
  if (found.node.is_node()) {
    const firmware::NodeReading& node = found.node.reading;
    text += "{\"serial\":" + std::to_string(node.serial.value) +
            ",\"x\":" + std::to_string(node.position.x) +
            ",\"y\":" + std::to_string(node.position.y) +
            ",\"status\":" + std::to_string(node.status) +
            ",\"boots\":" + std::to_string(node.boot_count) + "}";
  } else {
    text += "null";
  }
  return text + ",\"trouble\":" + json_text(trouble_text(found.node)) + "}";
}

// Asks again what came garbled: another unit's late answer does that, and two units with one
// address do it each time.
NodeAnswer ask_patiently(Master& master, std::uint8_t unit, firmware::WordOrder order) {
  constexpr int attempts_max = 3;
  NodeAnswer answer;
  for (int attempt = 0; attempt < attempts_max; ++attempt) {
    answer = ask_node(master, unit, order);
    if (!answer.error_detail || answer.error_detail->kind != ErrorDetail::Kind::garbled) break;
  }
  return answer;
}

// The line that moves while nothing is found; only where a person looks.
class Progress {
 public:
  Progress() : is_shown_(::isatty(STDERR_FILENO) == 1) {}
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(std::uint8_t unit, std::size_t asked, std::size_t all, std::size_t found) const {
    if (!is_shown_) return;
    std::fprintf(stderr, "\r\033[Kunit %u, %zu of %zu asked, %zu found", unit, asked, all, found);
    std::fflush(stderr);
  }
  void clear() const {
    if (is_shown_) std::fputs("\r\033[K", stderr);
  }

 private:
  bool is_shown_;
};

void print_row(const Found& found) {
  std::string serial = "-", place = "-", what = to_string(found.who);
  if (found.node.is_node()) {
    const firmware::NodeReading& node = found.node.reading;
    serial = std::to_string(node.serial.value);
    place = (node.status & firmware::node_status::fix_valid) != 0
                ? std::to_string(node.position.x) + ", " + std::to_string(node.position.y)
                : "no fix";
  } else {
    what += (what.empty() ? "" : "; ") + trouble_text(found.node);
  }
  const bool is_timed = !found.node.error_detail || found.took > port::Duration{};
  const std::string took = is_timed ? milliseconds_text(found.took) : "-";
  std::printf("%4u  %10s  %-20s  %10s  %s\n", found.address, serial.c_str(), place.c_str(),
              took.c_str(), what.c_str());
  std::fflush(stdout);
}

int scan(const ScanOptions& options) {
  const auto units = options.bus.units();
  const auto order = parse_word_order(options.order);
  if (!order) throw UsageError("-w " + options.order + ": give ABCD, BADC, CDAB or DCBA");
  const port::Duration timeout = options.bus.timeout();
  const auto link = options.bus.open();
  Master master(*link, timeout);
  std::size_t found_count = 0, node_count = 0, garbled_count = 0, asked_count = 0;
  std::string json;
  bool is_interrupted = false;
  std::optional<LinkError> lost;
  {
    const Progress progress;
    try {
      for (const std::uint8_t unit : units) {
        progress.show(unit, asked_count, units.size(), found_count);
        Found found{.address = unit,
                    .node = ask_patiently(master, unit, *order),
                    .took = master.took(),
                    .who = {}};
        ++asked_count;
        if (found.node.error_detail && found.node.error_detail->is_absence()) continue;
        const bool is_garbled =
            found.node.error_detail && found.node.error_detail->kind == ErrorDetail::Kind::garbled;
        ++(is_garbled ? garbled_count : found_count);
        if (found.node.is_node()) ++node_count;
        if (!is_garbled) found.who = master.identify(unit);
        if (options.as_json) {
          json += (json.empty() ? "" : ",\n ") + json_of(found);
          continue;
        }
        progress.clear();
        if (found_count + garbled_count == 1) {
          std::printf("unit      serial  x, y                  answers in  who\n");
        }
        print_row(found);
      }
    } catch (const Interrupted&) {
      is_interrupted = true;
    } catch (const LinkError& error) {
      lost = error;
    }
  }
  if (options.as_json) std::printf("[%s]\n", json.c_str());
  std::fprintf(stderr, "%zu of %zu units asked on %s: %zu answer, %zu of them position nodes\n",
               asked_count, units.size(), link->name().c_str(), found_count, node_count);
  if (found_count > node_count) {
    std::fprintf(stderr,
                 "devices of other makers are read by a profile: etcm-bus probe --profile NAME -a "
                 "UNIT\n");
  }
  if (is_interrupted) return exit_interrupted;
  if (lost) throw *lost;
  if (found_count > 0) return exit_ok;
  if (garbled_count > 0) {
    std::fprintf(stderr,
                 "etcm-bus: bytes come but no whole answer: another speed (-b) or parity (-P), or "
                 "noise on the line\n");
  } else {
    std::fprintf(stderr, "etcm-bus: nobody answers: %s\n", link->advice());
  }
  return exit_trouble;
}

}  // namespace

void add_scan_command(CLI::App& program, Run& run) {
  CLI::App* const command = program.add_subcommand("scan", "which units answer, and who they are");
  const auto options = std::make_shared<ScanOptions>();
  options->bus.add_to(*command);
  command->add_option("-w,--word-order", options->order, "of position nodes")
      ->capture_default_str();
  command->add_flag("--json", options->as_json, "an array on the standard output");
  command->callback([options, &run] { run = [options] { return scan(*options); }; });
}

}  // namespace etcm::bus
