#include "simulation.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <utility>

#include "rubbish.h"
#include "site_world.h"

namespace etcm::test {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr port::Duration turn = milliseconds(200);
constexpr port::Duration faults_end = seconds(150);

class Simulation {
 public:
  Simulation(const Theme& theme, std::uint64_t seed)
      : theme_(theme), random_(seed), broker_(random_, habits()) {
    const std::uint32_t count = 3 + static_cast<std::uint32_t>(random_.below(4));
    for (std::uint32_t number = 0; number < count; ++number) {
      Place place;
      place.name = std::string("gw-") + static_cast<char>('a' + number);
      place.side = theme.splits ? random_.index(2) : 0;
      place.starts_at = now_ + milliseconds(random_.below(4000));
      places_.push_back(std::move(place));
    }
    if (theme.twins) {
      // The last one has the name of another.
      places_.back().name = places_.front().name;
      places_.back().starts_at += seconds(random_.below(60));
    }
    for (std::uint32_t i = 0; i < 4 + random_.below(12); ++i) world_.add_node(places_.size());
  }

  Outcome run() {
    while (now_ < begin_ + faults_end) {
      happen();
      pass();
    }
    end_faults();
    Outcome outcome;
    const Instant ended = now_;
    Instant faultless = now_;
    Instant agreed{};
    const auto& settings = model_settings("", 0);
    const Instant rest = now_ + settings.silent_after + settings.leave_after +
                         GatewayModel::remove_after + 4 * settings.period;
    while (now_ < rest) {
      pass();
      // A death is a fault until all have noticed it, and so are two of one name.
      const bool is_unnoticed = is_any_death_unnoticed() || is_any_twin_unnoticed();
      if (agreed == Instant{} && is_unnoticed) faultless = now_;
      if (agreed == Instant{} && differing().empty()) agreed = now_;
      if (agreed == Instant{}) note(differing());
    }
    faultless = std::min(faultless, agreed);
    outcome.agreed_after_s = std::chrono::duration<double>(agreed - faultless).count();
    const port::Duration late = 2 * settings.period;
    if (agreed == Instant{}) {
      outcome.wrong = "never agreed: " + differing();
    } else if (faultless - ended > settings.silent_after + settings.period) {
      outcome.wrong = "a death was noticed late";
    } else if (agreed - faultless > late) {
      outcome.wrong = "agreed only after " + std::to_string(outcome.agreed_after_s) + " s";
    }
    if (outcome.wrong.empty()) outcome.wrong = judge();
    for (Place& place : places_) {
      if (place.gateway) outcome.messages += place.gateway->member().status().sent_count;
    }
    outcome.nodes = static_cast<std::uint32_t>(truth().size());
    return outcome;
  }

 private:
  // Where a gateway stands, whether or not it runs.
  struct Place {
    std::string name;
    std::size_t side = 0;
    MemberClock clock;
    bool boots = true;  // before it starts again
    Disk disk;
    std::unique_ptr<GatewayModel> gateway;
    Instant starts_at{};
    Instant network_back{};
    Instant asleep_until{};
    std::optional<Instant> clock_stood_at{};  // since it has been asleep
    bool is_gone = false;                     // and does not come back
  };

  BrokerModel::Habits habits() {
    BrokerModel::Habits habits;
    habits.reorders = random_.below(4) != 0;
    return habits;
  }

  void note(const std::string& what) const {
    if (std::getenv("ETCM_FLEET_VERBOSE") == nullptr) return;
    std::printf("[%7.1f] %s\n",
                std::chrono::duration<double>(now_.time_since_epoch()).count() - 1000,
                what.c_str());
  }

  void pass() {
    now_ += turn;
    broker_.step(now_);
    for (std::uint32_t number = 0; number < places_.size(); ++number) {
      Place& place = places_[number];
      if (!place.gateway && !place.is_gone && now_ >= place.starts_at) start(number);
      if (!place.gateway || now_ < place.asleep_until) continue;
      if (place.clock_stood_at) {
        place.clock.stand_still(*std::exchange(place.clock_stood_at, std::nullopt), now_);
      }
      if (now_ >= place.network_back) place.gateway->client().set_network(true);
      place.gateway->step(world_.nodes(), now_);
      if (place.gateway->client().is_dead()) {
        note(place.name + " dies");
        place.gateway->client().close(random_.below(2) == 0, now_);
        place.gateway.reset();
      }
    }
  }

  void start(std::uint32_t number) {
    Place& place = places_[number];
    note(place.name + "#" + std::to_string(number) + " starts");
    if (theme_.clocks && std::exchange(place.boots, false)) place.clock.boot(random_, now_);
    place.gateway =
        std::make_unique<GatewayModel>(model_settings(place.name, random_.next()), number, broker_,
                                       random_, place.side, place.clock, place.disk, now_);
  }

  bool chance(std::uint64_t in) { return random_.below(in) == 0; }

  // --- faults
  void happen() {
    if (chance(8)) note(world_.change(places_.size()));
    if (chance(200)) edit_site_file(places_[random_.index(places_.size())]);
    const std::uint32_t any = static_cast<std::uint32_t>(random_.index(places_.size()));
    Place& place = places_[any];
    if (theme_.deaths && chance(120) && place.gateway) kill(place);
    if (theme_.cuts && chance(100) && place.gateway) {
      note(place.name + " is cut off");
      place.gateway->client().set_network(false);
      place.network_back = now_ + milliseconds(500 + random_.below(40000));
    }
    if (theme_.splits && chance(broker_.is_bridged() ? 150 : 80)) {
      note(broker_.is_bridged() ? "split" : "whole");
      broker_.set_bridge(!broker_.is_bridged(), now_);
    }
    if (theme_.forgets && chance(60)) broker_.remember();
    if (theme_.forgets && chance(160)) {
      constexpr std::array all{Memory::all, Memory::some, Memory::none, Memory::older};
      const Memory memory = all[random_.index(all.size())];
      note("the broker starts again, memory " + std::to_string(static_cast<int>(memory)));
      broker_.restart(theme_.splits ? random_.index(2) : 0, memory, now_);
    }
    if (theme_.doubles && chance(12)) broker_.redeliver(now_);
    if (theme_.rubbish && chance(15)) throw_rubbish();
    if (theme_.clocks && chance(60)) place.clock.jump(random_);
    if (theme_.clocks && chance(150) && place.gateway && now_ >= place.asleep_until) sleep(place);
  }

  // As a machine that sleeps, or a program that waits for its disk. The broker takes it for gone.
  void sleep(Place& place) {
    note(place.name + " sleeps");
    place.asleep_until = now_ + milliseconds(1000 + random_.below(60000));
    if (chance(2)) place.clock_stood_at = now_;
    if (place.asleep_until - now_ > seconds(5)) place.gateway->client().close(false, now_);
  }

  // Also of one that does not run.
  void edit_site_file(Place& place) {
    place.disk.site_file = chance(4) ? 0 : static_cast<std::uint32_t>(1 + random_.below(5));
    note(place.name + " has site file " + std::to_string(place.disk.site_file));
    if (place.gateway && now_ >= place.asleep_until) place.gateway->read_site_file(true, now_);
  }

  void kill(Place& place) {
    note(place.name + " is to die");
    place.gateway->client().die_after(static_cast<std::uint32_t>(random_.below(12)));
    place.starts_at = now_ + milliseconds(2000 + random_.below(chance(3) ? 100000 : 20000));
    if (theme_.clocks) place.boots = place.boots || chance(2);
    if (chance(6)) {
      place.disk.saved.reset();
      place.disk.table.clear();
    }
  }

  void throw_rubbish() {
    const std::size_t side = theme_.splits ? random_.index(2) : 0;
    ModelMessage message = rubbish(broker_.retained(side), random_);
    note("rubbish at " + message.topic);
    broker_.inject(side, std::move(message), now_);
  }

  void end_faults() {
    note("faults end");
    if (!broker_.is_bridged()) broker_.set_bridge(true, now_);
    for (Place& place : places_) {
      place.asleep_until = now_;
      if (place.gateway) {
        place.gateway->client().set_network(true);
        place.gateway->client().die_after(0xffffffff);
        continue;
      }
      const bool never_was = !place.disk.saved;
      if (chance(2) || never_was) {
        place.starts_at = now_;
      } else {
        place.is_gone = true;
      }
    }
  }

  bool is_any_death_unnoticed() const {
    for (const Place& place : places_) {
      if (!place.gateway) continue;
      for (const firmware::PeerReport& peer : place.gateway->member().peers()) {
        const bool lives = std::any_of(places_.begin(), places_.end(), [&](const Place& other) {
          return other.gateway && other.name == peer.name;
        });
        if (peer.state == firmware::PeerState::online && !lives) return true;
      }
    }
    return false;
  }

  // Not one speaks, or the end of one is still to be told as if it were the end of the other.
  bool is_any_twin_unnoticed() const {
    if (!theme_.twins || (!places_.front().gateway && !places_.back().gateway)) return false;
    const bool does_last_speak = speaks(static_cast<std::uint32_t>(places_.size() - 1));
    return speaks(0) == does_last_speak || broker_.has_will();
  }

  // --- what should be
  bool speaks(std::uint32_t number) const {
    const Place& place = places_[number];
    return place.gateway && !place.gateway->is_read_only();
  }

  std::map<Serial, WorldNode> truth() const {
    std::map<Serial, WorldNode> nodes;
    for (const auto& [serial, node] : world_.nodes()) {
      WorldNode heard = node;
      heard.hearers = 0;
      for (std::uint32_t number = 0; number < places_.size(); ++number) {
        if (speaks(number)) heard.hearers |= node.hearers & 1u << number;
      }
      if (heard.hearers != 0 && !node.is_leaving) nodes[serial] = heard;
    }
    return nodes;
  }

  // The first two that know different sets; empty: there are none.
  std::string differing() const {
    const GatewayModel* first = nullptr;
    for (const Place& place : places_) {
      if (!place.gateway || place.gateway->is_read_only()) continue;
      if (first == nullptr) first = place.gateway.get();
      if (place.gateway->set_text() != first->set_text()) {
        return first->settings().gateway + ":\n" + first->set_text() + place.name + ":\n" +
               place.gateway->set_text();
      }
    }
    return "";
  }

  std::string judge() {
    if (std::string text = differing(); !text.empty()) return "they differ: " + text;
    if (std::string text = judge_twins(); !text.empty()) return text;
    if (std::string text = judge_truth(); !text.empty()) return text;
    const std::uint64_t batch = batch_hash();
    for (std::uint32_t number = 0; number < places_.size(); ++number) {
      if (!speaks(number)) continue;
      GatewayModel& gateway = *places_[number].gateway;
      const std::string& name = gateway.settings().gateway;
      if (gateway.events_text() != gateway.visited_text()) {
        return name + " was told\n" + gateway.events_text() + "and knows\n" +
               gateway.visited_text();
      }
      if (gateway.mesh_hash() != batch) return name + " has another mesh";
      if (!gateway.member().agreement().is_whole()) return name + " sees no agreement";
      const firmware::FleetStatus status = gateway.member().status();
      if (!status.is_settled) return name + " has not settled";
    }
    return judge_broker();
  }

  // Where nothing else happens all of them know who was there before.
  bool is_order_of_twins_known() const {
    return !theme_.deaths && !theme_.cuts && !theme_.splits && !theme_.forgets;
  }

  // One of them speaks, and where one was there before the other it is that one.
  std::string judge_twins() const {
    if (!theme_.twins) return "";
    const GatewayModel* const first = places_.front().gateway.get();
    const GatewayModel* const second = places_.back().gateway.get();
    if (first == nullptr || second == nullptr) {
      const GatewayModel* const only = first == nullptr ? second : first;
      return only != nullptr && only->is_read_only() ? "the only one of its name is silent" : "";
    }
    const bool is_first_silent = first->is_read_only();
    if (is_first_silent == second->is_read_only()) {
      return is_first_silent ? "both of one name are silent" : "both of one name speak";
    }
    if (!is_order_of_twins_known()) return "";
    const port::Duration later = places_.back().starts_at - places_.front().starts_at;
    const bool has_first_begun = later > 2 * model_settings("", 0).settle + seconds(2);
    return is_first_silent && has_first_begun ? "who was there first is silent" : "";
  }

  std::string judge_truth() const {
    const auto nodes = truth();
    for (std::uint32_t number = 0; number < places_.size(); ++number) {
      if (!speaks(number)) continue;
      const GatewayModel& gateway = *places_[number].gateway;
      FleetMember& member = places_[number].gateway->member();
      std::size_t count = 0;
      std::string wrong;
      member.for_each_node([&](const FleetRecord& record, bool is_stale) {
        ++count;
        const auto at = nodes.find(record.node.serial);
        if (at == nodes.end()) {
          wrong = "a node that is not there";
        } else if (record.node.position != at->second.position) {
          wrong = "a node that is elsewhere";
        } else if (!is_hearer(record.owner, at->second.hearers)) {
          wrong = "a node of an owner who does not hear it";
        } else if (is_stale) {
          wrong = "a node that is not stale";
        }
      });
      if (wrong.empty() && count != nodes.size()) wrong = "too few nodes";
      if (!wrong.empty()) {
        std::string text = gateway.settings().gateway + " knows " + wrong + ":\n" +
                           gateway.set_text() + "really:\n";
        for (const auto& [serial, node] : nodes) {
          text += std::to_string(serial.value) + " at " + std::to_string(node.position.x) +
                  " heard by " + std::to_string(node.hearers) + "\n";
        }
        return text;
      }
    }
    return "";
  }

  bool is_hearer(const std::string& name, std::uint32_t hearers) const {
    for (std::uint32_t number = 0; number < places_.size(); ++number) {
      if ((hearers >> number & 1) != 0 && places_[number].name == name) return true;
    }
    return false;
  }

  // Nobody is left behind on the broker: each living member's set there is its own.
  std::string judge_broker() const {
    for (const Place& place : places_) {
      if (!place.gateway || place.gateway->is_read_only()) continue;
      for (const firmware::PeerReport& peer : place.gateway->member().peers()) {
        if (peer.state == firmware::PeerState::online && !peer.is_complete) {
          return place.name + " misses something of " + peer.name;
        }
      }
    }
    return "";
  }

  std::uint64_t batch_hash() const {
    std::vector<Position> nodes = model_anchors();
    for (const auto& [serial, node] : truth()) nodes.push_back(node.position);
    inputs::OwnedMesh mesh(model_mesh());
    return mesh->build(nodes, model_features()) == Status::ok ? mesh->hash() : 1;
  }

  Theme theme_;
  Random random_;
  BrokerModel broker_;
  const Instant begin_ = Instant{} + seconds(1000);
  Instant now_ = begin_;
  std::vector<Place> places_;
  SiteWorld world_{random_};
};

}  // namespace

Outcome simulate(const Theme& theme, std::uint64_t seed) { return Simulation(theme, seed).run(); }

}  // namespace etcm::test
