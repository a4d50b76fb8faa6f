// etcm-bus poll: position nodes, asked again and again.
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "command.h"
#include "node_answer.h"

namespace etcm::bus {

namespace {

struct PollOptions {
  BusOptions bus{"1", "0.2"};
  std::string order = "ABCD";
  std::uint32_t interval_ms = 1000;
  std::uint32_t rounds = 0;  // 0: until it is interrupted
};

struct Row {
  std::uint8_t address = 0;
  std::uint32_t asked_count = 0;
  std::uint32_t error_count = 0;
  bool has_answered = false;
  firmware::NodeReading reading;  // the last sound one
  port::Instant answered_at{};
  port::Duration took{};
  port::Duration took_max{};
  std::string error_detail;  // of the last question; empty when that was answered well
};

void ask(Master& master, Row& row, firmware::WordOrder order) {
  ++row.asked_count;
  const NodeAnswer answer = ask_node(master, row.address, order);
  row.error_detail = trouble_text(answer);
  if (!answer.is_node()) {
    ++row.error_count;
    return;
  }
  row.has_answered = true;
  row.reading = answer.reading;
  row.answered_at = port::SteadyClock().now();
  row.took = master.took();
  row.took_max = std::max(row.took_max, row.took);
}

std::string table_of(const std::vector<Row>& rows, port::Instant now, const char* line_end) {
  std::string text =
      std::string(
          "unit      serial           x           y     age      answer     slowest   "
          "asked  errors  state") +
      line_end;
  for (const Row& row : rows) {
    std::array<char, 160> line;
    int size = 0;
    if (row.has_answered) {
      const auto tenths = (now - row.answered_at) / std::chrono::milliseconds(100);
      size = std::snprintf(
          line.data(), line.size(), "%4u  %10u  %10d  %10d  %4lld.%lld s  %10s  %10s", row.address,
          row.reading.serial.value, row.reading.position.x, row.reading.position.y,
          static_cast<long long>(tenths / 10), static_cast<long long>(tenths % 10),
          milliseconds_text(row.took).c_str(), milliseconds_text(row.took_max).c_str());
    } else {
      size = std::snprintf(line.data(), line.size(), "%4u  %10s  %10s  %10s  %8s  %10s  %10s",
                           row.address, "-", "-", "-", "-", "-", "-");
    }
    text.append(line.data(), static_cast<std::size_t>(size));
    size =
        std::snprintf(line.data(), line.size(), "  %6u  %6u  ", row.asked_count, row.error_count);
    text.append(line.data(), static_cast<std::size_t>(size));
    text +=
        (row.error_detail.empty() ? status_text(row.reading.status) : row.error_detail) + line_end;
  }
  return text;
}

int poll(const PollOptions& options) {
  const auto units = options.bus.units();
  const auto order = parse_word_order(options.order);
  if (!order) throw UsageError("-w " + options.order + ": give ABCD, BADC, CDAB or DCBA");
  const port::Duration timeout = options.bus.timeout();
  // Null while it is lost. The first time it must be there.
  std::unique_ptr<Link> link = options.bus.open();
  const std::string name = link->name();
  const port::SteadyClock clock;
  // A person sees the table change in place; a file gets it once a round.
  const bool is_live = ::isatty(STDOUT_FILENO) == 1;
  const auto show = [&](const std::vector<Row>& rows) {
    if (is_live) std::fputs("\033[H", stdout);
    std::fputs(table_of(rows, clock.now(), is_live ? "\033[K\n" : "\n").c_str(), stdout);
    if (is_live) std::fputs("\033[J", stdout);
    std::fflush(stdout);
  };

  std::vector<Row> rows(units.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i].address = units[i];
  if (is_live) std::fputs("\033[2J", stdout);
  const auto is_last = [&](std::uint32_t round) {
    return round + 1 == options.rounds || options.bus.is_once();
  };
  std::string told;
  Waiter waiter;
  try {
    for (std::uint32_t round = 0; options.rounds == 0 || round < options.rounds; ++round) {
      const port::Instant next_round = clock.now() + std::chrono::milliseconds(options.interval_ms);
      try {
        if (!link) link = options.bus.open();
        Master master(*link, timeout);
        for (Row& row : rows) {
          ask(master, row, *order);
          if (is_live) show(rows);
        }
        if (!is_live) show(rows);
        if (is_last(round)) break;
        link->pause(next_round - clock.now());
      } catch (const LinkError& error) {
        link.reset();
        if (std::exchange(told, error.what()) != error.what()) {
          std::fprintf(stderr, "etcm-bus: %s; trying again\n", error.what());
        }
        for (Row& row : rows) row.error_detail = "no connection";
        show(rows);
        if (is_last(round)) break;
        waiter.wait_until(next_round);
      }
    }
  } catch (const Interrupted&) {
    // The usual way to end it: what was seen stays on the screen.
  }
  const bool has_any =
      std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.has_answered; });
  if (has_any) return exit_ok;
  std::fprintf(stderr,
               "etcm-bus: no position node answered on %s; etcm-bus scan shows who is there\n",
               name.c_str());
  return exit_trouble;
}

}  // namespace

void add_poll_command(CLI::App& program, Run& run) {
  CLI::App* const command =
      program.add_subcommand("poll", "position nodes in a table, asked again and again");
  const auto options = std::make_shared<PollOptions>();
  options->bus.add_to(*command);
  command->add_option("-w,--word-order", options->order, "ABCD, BADC, CDAB or DCBA")
      ->capture_default_str();
  command->add_option("-l,--interval", options->interval_ms, "milliseconds from round to round")
      ->check(CLI::Range(10, 3600000))
      ->capture_default_str();
  command->add_option("-n,--rounds", options->rounds, "end after so many; 0: when interrupted")
      ->capture_default_str();
  command->callback([options, &run] { run = [options] { return poll(*options); }; });
}

}  // namespace etcm::bus
