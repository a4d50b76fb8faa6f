// Understands what a person on this machine says, does it, and answers.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "etcm/port/commands.h"
#include "firmware/alarms/alarm_book.h"
#include "firmware/control/alarm_list.h"
#include "firmware/gateway/gateway.h"
#include "firmware/status/alarms_document.h"
#include "firmware/status/bus_meter.h"
#include "firmware/status/document_reader.h"
#include "firmware/status/features_document.h"
#include "firmware/status/metrics_document.h"
#include "firmware/status/status_document.h"
#include "firmware/status/status_sources.h"
#include "firmware/status/units_document.h"

namespace etcm::firmware {

class Control final : public port::CommandHandler {
 public:
  // All must outlive this; `sources` is of this gateway and has these alarms.
  Control(Gateway& gateway, AlarmBook& alarms, const StatusSources& sources, port::Log& log);

  // What is said is done at this instant.
  void advance(port::Instant now);
  port::Instant next_deadline() const { return meter_.next_deadline(); }

  void begin(std::size_t client, std::string_view line) override;
  std::size_t read(std::size_t client, std::span<char> out) override {
    return clients_[client].read(out);
  }
  void end(std::size_t) override {}

 private:
  struct Called {
    Serial missing;
    std::uint32_t missing_count = 0;
    Serial other;  // that is not missing
  };
  Called nodes_called(std::string_view name) const;
  void dismiss(std::string_view what, TextWriter& answer);
  void dismiss(Serial serial, TextWriter& answer);
  void acknowledge(std::string_view what, TextWriter& answer);
  // Null where there is none of this name.
  const Document* document(std::string_view name) const;

  Gateway& gateway_;
  AlarmBook& alarms_;
  const StatusSources sources_;
  port::Log& log_;
  BusMeter meter_;
  const AlarmsDocument alarms_document_;
  const AlarmsDocument history_document_;
  const AlarmList alarms_on_;
  const AlarmList alarms_all_;
  const StatusDocument status_;
  const MetricsDocument metrics_;
  const UnitsDocument units_;
  const FeaturesDocument features_;
  std::array<DocumentReader, port::command_clients_max> clients_;
  port::Instant now_{};
};

}  // namespace etcm::firmware
