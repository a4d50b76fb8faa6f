#include "fakes.h"

#include <algorithm>
#include <stdexcept>

#include "etcm/config.h"
#include "firmware/protocol/register_pairs.h"
#include "firmware/publish/mesh_register_tables.h"

namespace etcm::firmware {

using namespace std::chrono_literals;

std::size_t RecordingLog::count(const std::string& part) const {
  return static_cast<std::size_t>(
      std::count_if(lines.begin(), lines.end(),
                    [&](const std::string& line) { return line.find(part) != std::string::npos; }));
}

void ScriptedBus::start_read(const port::RegisterRead& read, port::Instant now) {
  ++reads[read.address];
  timeouts[read.address] = read.timeout;
  const Request request{.address = read.address, .ticket = read.ticket, .is_write = false};
  const auto delay = delays.find(read.address);
  if (delay != delays.end() && delay->second < read.timeout) {
    waiting_.push_back({.request = request, .deadline = now + delay->second, .is_answered = true});
  } else if (delay == delays.end() && units_.contains(read.address)) {
    done_.push_back(request);
  } else {
    waiting_.push_back({.request = request, .deadline = now + read.timeout});
  }
}

void ScriptedBus::start_write(const port::RegisterWrite& write, port::Instant now) {
  ++writes[write.address];
  const Request request{.address = write.address, .ticket = write.ticket, .is_write = true};
  if (take_in(write)) {
    done_.push_back(request);
  } else {
    waiting_.push_back({.request = request, .deadline = now + write.timeout});
  }
}

void ScriptedBus::start_request(const port::UnitRequest& request, port::Instant now) {
  const Request asked{.address = request.address, .ticket = request.ticket, .is_write = true};
  repeated_.assign(request.pdu.begin(), request.pdu.end());
  if (units_.contains(request.address)) {
    done_.push_back(asked);
  } else {
    waiting_.push_back({.request = asked, .deadline = now + request.timeout});
  }
}

// Whether the unit says anything to it.
bool ScriptedBus::take_in(const port::RegisterWrite& write) {
  const auto found = units_.find(write.address);
  if (found == units_.end() || found->second.to_writes == port::BusResult::timeout) return false;
  if (found->second.to_writes != port::BusResult::ok) return true;
  if (write.first == assignment_register_first) {
    const auto serial = std::span(found->second.registers).subspan(2, 2);
    if (!std::equal(serial.begin(), serial.end(), write.values.begin() + 1)) return false;
    const ScriptedUnit moved = found->second;
    units_.erase(found);
    units_[static_cast<std::uint8_t>(write.values[0])] = moved;
  }
  written.push_back({.address = write.address,
                     .first = write.first,
                     .values = {write.values.begin(), write.values.end()}});
  return true;
}

void ScriptedBus::advance(port::Instant now) {
  if (is_stuck) return;
  now_ = now;
  std::erase_if(waiting_, [&](const Waiting& waiting) {
    if (waiting.deadline > now) return false;
    (waiting.is_answered ? done_ : timed_out_).push_back(waiting.request);
    return true;
  });
}

bool ScriptedBus::take_answer(port::BusAnswer& answer) {
  if (is_stuck) return false;
  if (!timed_out_.empty()) {
    answer = {.address = timed_out_.front().address,
              .ticket = timed_out_.front().ticket,
              .result = port::BusResult::timeout,
              .silence = silence_after_timeout,
              .registers = {}};
    silent_until_ = now_ + silence_after_timeout;
    timed_out_.pop_front();
    return true;
  }
  if (done_.empty()) return false;
  const Request request = done_.front();
  done_.pop_front();
  const auto found = units_.find(request.address);
  if (found == units_.end() && !request.is_write) {  // it has gone elsewhere meanwhile
    answer = {.address = request.address,
              .ticket = request.ticket,
              .result = port::BusResult::timeout,
              .registers = {}};
    return true;
  }
  const ScriptedUnit script = found == units_.end() ? ScriptedUnit{} : found->second;
  handed_ = script.registers;
  answer = {.address = request.address, .ticket = request.ticket, .registers = {}};
  if (request.is_write) {
    answer.result = script.to_writes;
    answer.exception = script.exception_to_writes;
    answer.pdu = repeated_;
  } else {
    answer.result = script.result;
    answer.exception = script.exception;
    answer.registers = handed_;
  }
  return true;
}

port::Instant ScriptedBus::next_deadline() const {
  port::Instant deadline = silent_until_ > now_ ? silent_until_ : port::never;
  for (const Waiting& waiting : waiting_) deadline = std::min(deadline, waiting.deadline);
  return deadline;
}

void ScriptedBus::set(std::uint8_t unit, const NodeReading& reading) {
  set_registers(unit, encode_node(reading, 7));
}

void ScriptedBus::set_registers(std::uint8_t unit, const NodeRegisters& registers) {
  units_[unit].registers = registers;
  units_[unit].result = port::BusResult::ok;
}

void ScriptedBus::set_result(std::uint8_t unit, port::BusResult result, std::uint8_t exception) {
  units_[unit].result = result;
  units_[unit].exception = exception;
}

void ScriptedBus::refuse_writes(std::uint8_t unit, port::BusResult how, std::uint8_t exception) {
  units_[unit].to_writes = how;
  units_[unit].exception_to_writes = exception;
}

std::uint32_t RecordingServer::header(const std::string& name) const {
  for (const auto& row : header_rows()) {
    if (name != row.name) continue;
    const auto& registers = images.back()->registers;
    return row.registers == 1 ? registers[row.offset] : load_u32(registers, row.offset);
  }
  throw std::logic_error("no header row is named " + name);
}

Rig::Rig(std::vector<FeatureSettings> features, std::uint32_t vertices_max) {
  settings.mesh = {.vertices_max = vertices_max, .features_max = 50};
  settings.poll = {.interval = 100ms,
                   .timeout = 50ms,
                   .absent_interval = 400ms,
                   .stale_after = 1s,
                   .leave_after = 3s};
  BusSettings yard;
  yard.name = "yard";
  yard.units = {{.first = 1, .last = 20}};
  yard.timeout = 50ms;
  yard.outstanding_max = 100;
  yard.scan_budget = 10ms;
  settings.buses.push_back(yard);
  settings.files = FileSettings{.folder = "", .name = "", .interval = 500ms};
  settings.features = std::move(features);
}

void Rig::start() { start_with({&bus}); }

void Rig::start_with(const std::vector<port::NodeBus*>& buses) {
  memory.resize(storage_bytes(settings.mesh));
  if (mesh.open(memory, settings.mesh) != Status::ok) throw std::logic_error("bad MeshConfig");
  for (std::size_t i = 0; i < buses.size(); ++i) {
    polled.push_back({.bus = buses[i], .settings = &settings.buses[i]});
  }
  gateway = std::make_unique<Gateway>(std::make_shared<const Settings>(settings), mesh,
                                      GatewayPorts{.buses = polled,
                                                   .server = server,
                                                   .files = &files,
                                                   .store = store,
                                                   .clock = clock,
                                                   .wall_clock = wall_clock,
                                                   .log = log,
                                                   .broker = broker,
                                                   .run = run_number,
                                                   .version = version});
}

void Rig::run(port::Duration duration, port::Duration step) {
  if (!gateway) start();
  for (port::Duration passed{}; passed < duration; passed += step) {
    // The answers of reads that a step starts arrive before the next one.
    if (broker != nullptr) broker->step(clock.now());
    gateway->step(clock.now());
    clock.pass(step);
  }
}

void Rig::update_settings(const std::vector<port::NodeBus*>& added) {
  const auto next = std::make_shared<const Settings>(settings);
  std::vector<PolledBus> more;
  for (port::NodeBus* const one : added) {
    const std::size_t number = next->buses.size() - added.size() + more.size();
    more.push_back({.bus = one, .settings = &next->buses[number]});
  }
  gateway->update_settings(next, more, clock.now());
}

void Rig::put(std::uint8_t unit, std::int32_t x, std::int32_t y, std::uint16_t status) {
  bus.set(unit, {.serial = Serial{1000u + unit}, .position = {x, y}, .status = status});
}

void Rig::put_square() {
  put(1, 0, 0);
  put(2, 100, 0);
  put(3, 100, 100);
  put(4, 0, 100);
}

TwoBuses::TwoBuses() {
  settings.buses.push_back(settings.buses[0]);
  settings.buses[1].name = "gate";
  start_with({&bus, &other});
}

void TwoBuses::put_other(std::uint8_t unit, std::int32_t x, std::int32_t y) {
  other.set(unit,
            {.serial = Serial{2000u + unit}, .position = {x, y}, .status = node_status::fix_valid});
}

FeatureSettings feature(std::uint32_t from, std::uint32_t to) {
  return {.from = Serial{from}, .to = Serial{to}, .name = {}, .source = "site.toml:1"};
}

}  // namespace etcm::firmware
