// Who else has to do with a gateway: another gateway of its fleet over a broker, programs that
// share its buses, masters, people who read its page or stand before its board. What they do, and
// what ails the broker, is drawn from a chance of their own: a site without them lives as before.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "board_world.h"
#include "bus_clients.h"
#include "fleet/broker_model.h"
#include "gateway_run.h"
#include "neighbour.h"
#include "site_world.h"
#include "sparkplug_host.h"

namespace etcm::simulation {

class Others {
 public:
  // Enters into the settings of the site what is needed for them.
  Others(SiteWorld& site, std::uint64_t seed, bool has_sparkplug, Instant now);

  // A run of the gateway begins.
  GatewayCompany company(Instant now);
  // It has ended.
  void leave();
  // The gateway stood still until now, or begins to be looked at anew.
  void look_anew(Instant now);

  void pass_to(Instant now);
  Instant next() const;
  // Does what is due by now, unless the site is at rest. What is wrong with what they see, or
  // nothing.
  std::string step(GatewayRun& run, Instant now);

  // Nothing ails them any more.
  void end_faults(Instant now);
  // What they know must be what is so.
  std::string look_at_rest(GatewayRun& run) const;
  const Neighbour& neighbour() const { return east_; }

  std::uint64_t births() const { return host_ ? host_->births() : 0; }  // for Sparkplug
  std::uint64_t requests() const;  // that units have answered to programs that share a bus

 private:
  void happen(GatewayRun& run, Instant now);
  void happen_at_host();
  void set_network(bool is_up);
  void happen_at_broker(std::uint64_t what, Instant now);
  test::ModelMessage rubbish();
  std::string look_at_board(GatewayRun& run, Instant now);

  SiteWorld& site_;
  inputs::Random random_;
  const test::MemberClock clock_;
  test::BrokerModel broker_;
  Neighbour east_;
  std::vector<std::unique_ptr<BusClients>> clients_;  // by bus; null: it is not shared
  std::unique_ptr<BoardWorld> board_;
  std::unique_ptr<SparkplugHost> host_;
  std::unique_ptr<test::ModelClient> link_;            // of the gateway that runs
  std::unique_ptr<test::ModelClient> sparkplug_link_;  // so too
  bool has_network_ = true;
  bool is_at_rest_ = false;
  Duration pause_{};
  Instant happens_at_{};
  Instant broker_forgets_at_ = port::never;
  Instant looked_at_{};
  std::string wrong_;
  std::uint32_t lamp_code_ = 0;  // that the board's lamp has to show; 0: any
  Instant lamp_since_{};
};

}  // namespace etcm::simulation
