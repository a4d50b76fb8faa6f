// What others ask of the units of a bus between the gateway's own questions.
//
// They have the time that no unit waits for, and of the rest a share (bus_schedule.h); one request
// is under way at a time. None is sent whose answer could not be told from one that is still under
// way to the gateway or to another of them: as long as the unit owes that, it does not answer.
#pragma once

#include "etcm/port/line_clients.h"
#include "etcm/port/node_bus.h"
#include "firmware/polling/bus_schedule.h"

namespace etcm::firmware {

class ClientRequests {
 public:
  // Null: the bus can have no clients. It must outlive this.
  explicit ClientRequests(port::LineClients* clients) : clients_(clients) {}

  const port::LineClients* clients() const { return clients_; }

  // Whether they want the bus, and one of them would be next.
  bool is_waiting() const { return clients_ != nullptr && clients_->is_waiting(); }
  // From when on the next may be sent; `never` where there is none.
  port::Instant start_at(const BusSchedule& schedule, port::Instant now) const;

  // Sends the first that may be sent, with `ticket`; false where there is none.
  // REQUIRES: the bus is ready.
  bool start(port::NodeBus& bus, const BusSchedule& schedule, std::uint32_t ticket,
             port::Instant now);
  // What became of it.
  void finish(const port::BusAnswer& answer, BusSchedule& schedule, port::Instant now);

  // The bus has no connection: there is nobody to ask.
  void refuse_all();

  // That their requests were under way, in all.
  port::Duration time() const { return time_; }

 private:
  port::LineClients* clients_;
  port::Instant asked_at_{};
  port::Duration time_{};
};

}  // namespace etcm::firmware
