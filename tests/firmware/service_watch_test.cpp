// ServiceWatch: what the service manager hears, above all what "alive" takes.
#include "firmware/gateway/service_watch.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "fakes.h"

namespace etcm::firmware {
namespace {

using namespace std::chrono_literals;

class RecordingManager final : public port::ServiceManager {
 public:
  explicit RecordingManager(port::Duration timeout) : timeout_(timeout) {}
  void tell(port::ServiceEvent event) override {
    if (event == port::ServiceEvent::alive) {
      ++fed;
    } else {
      events.push_back(event);
    }
  }
  void tell_status(std::string_view line) override { statuses.emplace_back(line); }
  port::Duration watchdog_timeout() const override { return timeout_; }

  std::vector<port::ServiceEvent> events;
  std::vector<std::string> statuses;
  std::size_t fed = 0;

 private:
  port::Duration timeout_;
};

class ServiceWatchTest : public testing::Test {
 protected:
  void start(port::Duration timeout = 4s) {
    manager_ = std::make_unique<RecordingManager>(timeout);
    rig_.start();
    watch_ = std::make_unique<ServiceWatch>(*manager_, *rig_.gateway,
                                            WatchedServers{masters_, readers_}, refusal_, rig_.log);
    watch_->ready(rig_.clock.now());
  }
  // Returns how often the watchdog was fed. The gateway may stand still meanwhile.
  std::size_t run(port::Duration duration, bool gateway_turns = true) {
    const std::size_t before = manager_->fed;
    for (port::Duration passed{}; passed < duration; passed += 10ms) {
      if (gateway_turns) rig_.gateway->step(rig_.clock.now());
      watch_->step(rig_.clock.now());
      rig_.clock.pass(10ms);
    }
    return manager_->fed - before;
  }
  Rig rig_;
  port::ServiceCounters masters_;
  port::ServiceCounters readers_;
  std::string refusal_;
  std::unique_ptr<RecordingManager> manager_;
  std::unique_ptr<ServiceWatch> watch_;
};

TEST_F(ServiceWatchTest, IsFedTwiceInItsTimeWhileThereIsProgress) {
  rig_.put(1, 0, 0);
  start();
  EXPECT_EQ(manager_->events, std::vector{port::ServiceEvent::ready});
  EXPECT_EQ(run(20s), 10u);
  EXPECT_LE(watch_->next_deadline(), rig_.clock.now() + 2s);
}

TEST_F(ServiceWatchTest, IsFedWhileNoUnitAnswers) {
  start();
  EXPECT_EQ(run(20s), 10u);
}

TEST_F(ServiceWatchTest, IsFedWhileTheLinkIsDown) {
  rig_.put(1, 0, 0);
  start();
  run(1s);
  rig_.bus.link_up = false;
  EXPECT_GE(run(60s), 29u);
}

TEST_F(ServiceWatchTest, IsFedBetweenQuestionsFarApart) {
  rig_.settings.poll.interval = 1min;
  rig_.settings.poll.absent_interval = 1min;
  rig_.settings.poll.leave_after = 5min;
  rig_.put(1, 0, 0);
  start();
  EXPECT_EQ(run(10min), 300u);
}

TEST_F(ServiceWatchTest, IsFedWhileASlowAnswerMayStillCome) {
  rig_.settings.poll.timeout = 30s;
  rig_.settings.buses.front().timeout = 30s;
  start();
  EXPECT_EQ(run(2min), 60u);
}

TEST_F(ServiceWatchTest, IsNotFedWhereABusIsNeverAsked) {
  rig_.put(1, 0, 0);
  start();
  run(10s);
  // The loop turns, but nobody turns the poller.
  EXPECT_LE(run(20s, false), 2u);
  EXPECT_EQ(rig_.log.count("the watchdog is not fed: bus yard neither asks nor hears anything"),
            1u);
  EXPECT_GE(run(10s), 4u) << "it has recovered";
}

TEST_F(ServiceWatchTest, IsNotFedWhereAnAnswerIsNeitherTakenNorGivenUp) {
  start();
  run(10s);
  rig_.bus.is_stuck = true;
  EXPECT_LE(run(20s), 2u);
  EXPECT_EQ(rig_.log.count("the watchdog is not fed"), 1u);
}

TEST_F(ServiceWatchTest, IsNotFedWhereNobodyWatches) {
  start(0s);
  EXPECT_EQ(run(10s), 0u);
}

TEST_F(ServiceWatchTest, TellsHowThingsAreAndNotTooOften) {
  for (std::uint8_t unit = 1; unit <= 3; ++unit) rig_.put(unit, unit * unit, 7 * unit % 11);
  start();
  run(10s);
  ASSERT_FALSE(manager_->statuses.empty());
  EXPECT_EQ(
      manager_->statuses.front(),
      "generation 0: 0 nodes, 0 stale, 0 missing, 0 refused, 0 of 0 features, 0 Steiner vertices");
  EXPECT_EQ(manager_->statuses.back(),
            "generation " + std::to_string(rig_.gateway->generation()) +
                ": 3 nodes, 0 stale, 0 missing, 0 refused, 0 of 0 features, 0 Steiner vertices");
  const std::size_t before = manager_->statuses.size();
  for (int i = 0; i < 100; ++i) {
    rig_.put(1, i, -i);
    run(200ms);
  }
  EXPECT_LE(manager_->statuses.size() - before, 11u);
  EXPECT_GE(manager_->statuses.size() - before, 9u);
  const std::size_t quiet = manager_->statuses.size();
  run(20s);
  EXPECT_LE(manager_->statuses.size(), quiet + 1) << "no news";
}

TEST_F(ServiceWatchTest, TellsThatTheChangedConfigurationIsRefused) {
  start();
  run(5s);
  refusal_ = "the configuration was changed and is refused";
  run(5s);
  EXPECT_TRUE(
      manager_->statuses.back().ends_with("; the changed configuration is refused: see the log"))
      << manager_->statuses.back();
  refusal_.clear();
  run(5s);
  EXPECT_TRUE(manager_->statuses.back().ends_with("Steiner vertices"));
}

TEST_F(ServiceWatchTest, TellsWhatIsNotServed) {
  const auto ends = [&](const char* text) { return manager_->statuses.back().ends_with(text); };
  start();
  run(5s);
  EXPECT_TRUE(ends("Steiner vertices"));
  readers_.is_listening = false;
  run(5s);
  EXPECT_TRUE(ends("; no status page: see the log")) << manager_->statuses.back();
  masters_.is_listening = false;
  run(5s);
  EXPECT_TRUE(ends("; nobody can read the mesh: see the log")) << manager_->statuses.back();
  masters_.is_listening = readers_.is_listening = true;
  run(5s);
  EXPECT_TRUE(ends("Steiner vertices")) << manager_->statuses.back();
}

TEST_F(ServiceWatchTest, TellsOfReloadingAndStopping) {
  start();
  watch_->reloading();
  watch_->ready(rig_.clock.now());
  watch_->stopping();
  EXPECT_EQ(manager_->events,
            (std::vector{port::ServiceEvent::ready, port::ServiceEvent::reloading,
                         port::ServiceEvent::ready, port::ServiceEvent::stopping}));
}

}  // namespace
}  // namespace etcm::firmware
