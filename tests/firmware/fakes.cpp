#include "fakes.h"

#include <algorithm>
#include <stdexcept>

#include "etcm/config.h"
#include "mesh_map.h"
#include "words.h"

namespace etcm::firmware {

using namespace std::chrono_literals;

std::size_t RecordingLog::count(const std::string& part) const {
  return static_cast<std::size_t>(
      std::count_if(lines.begin(), lines.end(),
                    [&](const std::string& line) { return line.find(part) != std::string::npos; }));
}

void ScriptedBus::start_read(const port::RegisterRead& read, port::Instant now) {
  ++reads[read.unit];
  if (units_.contains(read.unit)) {
    done_.push_back(read.unit);
  } else {
    waiting_.push_back({.unit = read.unit, .deadline = now + read.timeout});
  }
}

void ScriptedBus::advance(port::Instant now) {
  std::erase_if(waiting_, [&](const Waiting& waiting) {
    if (waiting.deadline > now) return false;
    timed_out_.push_back(waiting.unit);
    return true;
  });
}

bool ScriptedBus::take_answer(port::BusAnswer& answer) {
  if (!timed_out_.empty()) {
    answer = {.unit = timed_out_.front(), .result = port::BusResult::timeout, .registers = {}};
    timed_out_.pop_front();
    return true;
  }
  if (done_.empty()) return false;
  const std::uint8_t unit = done_.front();
  done_.pop_front();
  const Unit& script = units_[unit];
  handed_ = script.registers;
  answer = {
      .unit = unit, .result = script.result, .exception = script.exception, .registers = handed_};
  return true;
}

port::Instant ScriptedBus::next_deadline() const {
  port::Instant deadline = port::never;
  for (const Waiting& waiting : waiting_) deadline = std::min(deadline, waiting.deadline);
  return deadline;
}

void ScriptedBus::set(std::uint8_t unit, const NodeReading& reading) {
  set_registers(unit, encode_node(reading, 7));
}

void ScriptedBus::set_registers(std::uint8_t unit, const NodeRegisters& registers) {
  units_[unit] = {.registers = registers};
}

void ScriptedBus::set_result(std::uint8_t unit, port::BusResult result, std::uint8_t exception) {
  units_[unit].result = result;
  units_[unit].exception = exception;
}

std::uint32_t RecordingServer::header(const std::string& name) const {
  for (const MapRow& row : header_rows()) {
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
  settings.buses.push_back(yard);
  settings.files = FileSettings{.folder = "", .name = "", .interval = 500ms};
  settings.features = std::move(features);
}

void Rig::start() {
  memory.resize(storage_bytes(settings.mesh));
  if (mesh.open(memory, settings.mesh) != Status::ok) throw std::logic_error("bad MeshConfig");
  polled = {{.bus = &bus, .settings = &settings.buses.front()}};
  gateway = std::make_unique<Gateway>(
      settings, mesh,
      GatewayPorts{.buses = polled, .server = server, .files = &files, .clock = clock, .log = log});
}

void Rig::run(port::Duration duration) {
  if (!gateway) start();
  for (port::Duration passed{}; passed < duration; passed += 10ms) {
    // The answers of reads that a step starts arrive before the next one.
    gateway->step(clock.now());
    clock.pass(10ms);
  }
}

void Rig::put(std::uint8_t unit, std::int32_t x, std::int32_t y, std::uint16_t status) {
  bus.set(unit, {.serial = 1000u + unit, .position = {x, y}, .status = status});
}

FeatureSettings feature(std::uint32_t from, std::uint32_t to) {
  return {.from = from, .to = to, .place = "site.toml:1"};
}

}  // namespace etcm::firmware
