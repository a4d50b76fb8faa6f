#include "others.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

namespace etcm::simulation {

using namespace std::chrono_literals;

namespace {

constexpr std::uint64_t of_their_own = 0x9e3779b97f4a7c15;
// The line of the watchdog changes twice a second; what is done in one turn may take its time.
constexpr Duration fed_within = 600ms;
// A code that has begun, and the next one to its end.
constexpr Duration shown_within = 6s;
// A unit is waited for its time, and once more where its answer may still be under way; behind a
// converter whose queue is full of requests that were given up, for each of these a second more.
constexpr Duration request_max = 15s + 16s;

}  // namespace

Others::Others(SiteWorld& site, std::uint64_t seed, bool has_sparkplug, Instant now)
    : site_(site),
      random_(seed ^ of_their_own),
      broker_(random_, {}),
      east_(broker_, random_, now),
      clients_(site.buses.size()) {
  // There is one, and what it has lost nobody gives back to it.
  broker_.set_bridge(false, now);
  pause_ = std::array{5s, 30s, 300s}[random_.index(3)];
  happens_at_ = now + pause_;
  site.whole.has_broker = true;
  site.whole.is_site_shared = !site.is_small && random_.below(4) != 0;
  for (std::size_t i = 0; i < site.buses.size(); ++i) {
    BusText& text = site.whole.buses[i];
    text.is_shared = random_.below(2) == 0;
    if (!text.is_shared) continue;
    BusWorld& bus = site.buses[i];
    clients_[i] =
        std::make_unique<BusClients>(bus.devices, text.units, inputs::Random(random_.next()));
    if (bus.line) bus.line->clients = clients_[i].get();
    if (bus.converter) bus.converter->clients = clients_[i].get();
  }
  if (random_.below(6) == 0) board_ = std::make_unique<BoardWorld>();
  if (has_sparkplug) {
    site.whole.has_sparkplug = true;
    site.whole.has_write_back = !site.whole.is_site_shared || random_.below(2) == 0;
    // Nothing that comes from elsewhere is written to a device.
    if (site.whole.has_write_back) site.whole.is_site_shared = false;
    host_ = std::make_unique<SparkplugHost>(broker_, random_, clock_);
  }
  site.file = site.whole;
}

GatewayCompany Others::company(Instant now) {
  look_anew(now);
  link_ = std::make_unique<test::ModelClient>(broker_, random_, std::size_t{0}, clock_);
  link_->set_network(has_network_);
  if (host_) {
    sparkplug_link_ = std::make_unique<test::ModelClient>(broker_, random_, std::size_t{0}, clock_,
                                                          "yard:west:sparkplug");
    sparkplug_link_->set_network(has_network_);
  }
  GatewayCompany company{
      .broker = link_.get(), .sparkplug = sparkplug_link_.get(), .board = board_.get()};
  for (const auto& client : clients_) company.clients.push_back(client.get());
  return company;
}

void Others::leave() {
  link_.reset();
  sparkplug_link_.reset();
  for (const auto& client : clients_) {
    if (client) client->forget_all();
  }
}

void Others::look_anew(Instant now) {
  looked_at_ = lamp_since_ = now;
  if (board_) board_->fed_at = now;
  if (host_) host_->look_anew();
}

void Others::pass_to(Instant now) {
  broker_.step(now);
  east_.step(now);
  if (host_) host_->step(now);
  for (const auto& client : clients_) {
    if (client) client->pass_to(now);
  }
}

Instant Others::next() const {
  const Instant next =
      std::min({broker_.next(), east_.next(), link_->next_deadline(), broker_forgets_at_,
                host_ ? std::min(host_->next(), sparkplug_link_->next_deadline()) : port::never});
  return is_at_rest_ ? next : std::min(next, happens_at_);
}

std::string Others::step(GatewayRun& run, Instant now) {
  if (!is_at_rest_ && happens_at_ <= now) {
    happen(run, now);
    happens_at_ = now + 100ms + random_.below(2 * static_cast<std::uint64_t>(pause_ / 1ms)) * 1ms;
  }
  if (broker_forgets_at_ <= now) {
    broker_.restart(0, test::Memory::none, now);
    broker_forgets_at_ = port::never;
  }
  std::string wrong = std::exchange(wrong_, {});
  if (run.readers().is_there() && wrong.empty()) wrong = run.readers().read_on(random_);
  for (const auto& client : clients_) {
    if (!client || !wrong.empty()) continue;
    wrong = client->wrong();
    if (client->under_way_for(now) > request_max && now - looked_at_ > request_max) {
      wrong = "another program has waited for an answer for long";
    }
  }
  if (wrong.empty() && board_) wrong = look_at_board(run, now);
  if (wrong.empty() && host_) wrong = host_->look(run, sparkplug_link_->is_connected(), now);
  return wrong;
}

std::string Others::look_at_board(GatewayRun& run, Instant now) {
  if (now - board_->fed_at > fed_within) {
    return "the watchdog was fed " +
           std::to_string(std::chrono::duration<double>(now - board_->fed_at).count()) + " s ago";
  }
  // As the guide has it: five flashes without a node, one where all is well.
  const bool is_well = run.gateway().state() == 0;
  const std::uint32_t code = run.gateway().node_count() == 0 ? 5u : is_well ? 1u : 0u;
  if (std::exchange(lamp_code_, code) != code) lamp_since_ = now;
  const bool is_shown = code == 0 || now - lamp_since_ < shown_within || board_->code == code;
  return is_shown ? std::string()
                  : "the lamp flashes " + std::to_string(board_->code) + " times, not " +
                        std::to_string(code);
}

void Others::happen(GatewayRun& run, Instant now) {
  const std::uint64_t what = random_.below(20);
  switch (what) {
    case 0:
    case 1:
    case 2:
      for (const auto& client : clients_) {
        if (client && random_.below(2) == 0) client->ask(1 + random_.index(8));
      }
      break;
    case 3:
      for (const auto& client : clients_) {
        if (client) client->is_flooding = random_.below(3) == 0;
      }
      break;
    case 4:
      run.readers().come(1 + random_.index(PageReaders::count_max), random_);
      break;
    case 5:
      if (!run.masters().begin_reading()) wrong_ = "registers that a master reads have changed";
      break;
    case 6:
      if (board_) board_->is_pressed = !board_->is_pressed;
      break;
    case 7:
      if (board_) board_->is_alerted = !board_->is_alerted;
      break;
    case 8:
    case 9:
      east_.change(now);
      break;
    case 10:
      if (east_.is_dead()) {
        east_.start(now);
      } else {
        east_.die(now);
        if (random_.below(4) == 0) east_.lose_disk();
      }
      break;
    default:
      happen_at_broker(what, now);
  }
}

void Others::happen_at_broker(std::uint64_t what, Instant now) {
  switch (what) {
    case 11:
      broker_.restart(0, static_cast<test::Memory>(random_.below(4)), now);
      break;
    case 12:
      broker_.remember();
      break;
    case 13:
      broker_.redeliver(now);
      break;
    case 14:
      broker_.inject(0, rubbish(), now);
      break;
    case 15:
      set_network(!has_network_);
      break;
    case 16:
      east_.set_network(random_.below(2) == 0);
      if (host_) happen_at_host();
      break;
    default:
      // What was cut is mended sooner or later.
      set_network(true);
      east_.set_network(true);
      if (host_) host_->set_network(true);
      east_.start(now);
  }
}

void Others::happen_at_host() {
  switch (random_.below(3)) {
    case 0:
      host_->set_network(false);
      break;
    case 1:
      host_->ask_for_births();
      break;
    default:
      host_->talk_rubbish(random_);
  }
}

void Others::set_network(bool is_up) {
  has_network_ = is_up;
  link_->set_network(is_up);
  if (sparkplug_link_) sparkplug_link_->set_network(is_up);
}

// What no gateway says. Nothing of it may be believed, so none is a message with another number.
test::ModelMessage Others::rubbish() {
  // What is said to Home Assistant is only said again each hour.
  auto retained = broker_.retained(0);
  std::erase_if(retained, [](const auto& told) { return !told.first.starts_with("etcm/"); });
  test::ModelMessage message{.topic = "etcm/v1/yard/stranger/node/00000007",
                             .payload = "{}",
                             .is_retained = random_.below(3) != 0};
  if (!retained.empty() && random_.below(4) != 0) {
    auto at = retained.begin();
    std::advance(at, static_cast<std::ptrdiff_t>(random_.index(retained.size())));
    message.topic = at->first;
    message.payload = at->second.substr(0, random_.index(at->second.size()));
  }
  if (random_.below(4) == 0) message.payload = std::string(1 + random_.index(3000), '[');
  if (random_.below(4) == 0) message.payload = R"({"serial":99999999999999999999,"x":1e999})";
  return message;
}

void Others::end_faults(Instant now) {
  is_at_rest_ = true;
  // The last that happens, when all has been told: it has lost all.
  if (random_.below(2) == 0) broker_forgets_at_ = now + 2min;
  set_network(true);
  east_.set_network(true);
  if (host_) host_->set_network(true);
  east_.start(now);
  if (board_) board_->is_alerted = board_->is_pressed = false;
  for (const auto& client : clients_) {
    if (client) client->is_flooding = false;
  }
}

std::string Others::look_at_rest(GatewayRun& run) const {
  if (host_) {
    const std::string wrong = host_->look_at_rest(site_, run);
    if (!wrong.empty()) return wrong;
  }
  // A table that is full says so, and does not tell of all.
  if (site_.is_small) return {};
  std::size_t own = 0;
  for (const auto& device : site_.devices) {
    if (device->is_replaced) continue;
    ++own;
    const std::string name = "at rest, node " + std::to_string(device->serial);
    const auto known = east_.learned().find(device->serial);
    if (known == east_.learned().end()) return name + " is not known at the other gateway";
    if (known->second.is_stale) return name + " is stale at the other gateway";
    const firmware::NodeRecord* const node =
        run.gateway().nodes().find(firmware::Serial{device->serial});
    const Position place = node->is_placed() ? node->placed : node->position;
    if (known->second.position != place) return name + " is elsewhere at the other gateway";
    const std::string topic =
        "homeassistant/device/etcm_yard_" + std::to_string(device->serial) + "/";
    const bool is_announced = std::ranges::any_of(broker_.retained(0), [&](const auto& message) {
      return message.first.starts_with(topic) && nlohmann::json::accept(message.second);
    });
    if (!is_announced) return name + " is not announced to Home Assistant";
  }
  if (east_.learned().size() != own) {
    return "at rest, the other gateway knows " + std::to_string(east_.learned().size()) +
           " nodes of this one, which has " + std::to_string(own);
  }
  const auto agreement = east_.agreement();
  if (!agreement || agreement->online != 2 || !agreement->is_whole()) {
    return "at rest, the two gateways do not agree";
  }
  if (!site_.whole.is_site_shared) return {};
  const auto records = run.gateway().nodes().records();
  const auto foreign = std::ranges::count_if(
      records, [](const auto& node) { return node.is_known() && node.is_foreign(); });
  if (static_cast<std::size_t>(foreign) != east_.nodes().size()) {
    return "at rest, " + std::to_string(foreign) + " nodes are the other gateway's, which has " +
           std::to_string(east_.nodes().size());
  }
  for (const auto& [serial, place] : east_.nodes()) {
    const firmware::NodeRecord* const node = run.gateway().nodes().find(firmware::Serial{serial});
    const std::string name = "at rest, node " + std::to_string(serial) + " of the other gateway";
    if (node == nullptr) return name + " is not known";
    if (node->stale) return name + " is stale";
    if (node->is_quarantined() && run.gateway().settings().work_max > 0) continue;
    if (!node->is_placed() || node->placed != place) return name + " is not where it is";
  }
  return {};
}

std::uint64_t Others::requests() const {
  std::uint64_t requests = 0;
  for (const auto& client : clients_) {
    if (client) requests += client->counters().answered;
  }
  return requests;
}

}  // namespace etcm::simulation
