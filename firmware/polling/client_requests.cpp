#include "firmware/polling/client_requests.h"

namespace etcm::firmware {

port::Instant ClientRequests::start_at(const BusSchedule& schedule, port::Instant now) const {
  return is_waiting() ? schedule.client_start(now) : port::never;
}

bool ClientRequests::start(port::NodeBus& bus, const BusSchedule& schedule, std::uint32_t ticket,
                           port::Instant now) {
  port::ClientRequest wanted;
  while (clients_->next(wanted)) {
    const ModbusAddress address{wanted.address};
    const port::UnitRequest request{.address = wanted.address,
                                    .pdu = wanted.pdu,
                                    .timeout = timeout_of(schedule.settings(), address),
                                    .ticket = ticket};
    if (bus.request_free_at(request, now) > now) {
      clients_->refuse(port::ClientRefusal::no_answer);
      continue;
    }
    asked_at_ = now;
    bus.start_request(request, now);
    return true;
  }
  return false;
}

void ClientRequests::finish(const port::BusAnswer& answer, BusSchedule& schedule,
                            port::Instant now) {
  time_ += now - asked_at_;
  schedule.charge_client(schedule.cost_of(asked_at_, answer, now), now);
  switch (answer.result) {
    case port::BusResult::ok:
    case port::BusResult::exception:
      return clients_->answer(answer.pdu);
    case port::BusResult::timeout:
    case port::BusResult::bad_answer:
      return clients_->refuse(port::ClientRefusal::no_answer);
    case port::BusResult::link_lost:
      return clients_->refuse(port::ClientRefusal::no_path);
  }
}

void ClientRequests::refuse_all() {
  port::ClientRequest ignored;
  while (is_waiting() && clients_->next(ignored)) clients_->refuse(port::ClientRefusal::no_path);
}

}  // namespace etcm::firmware
