// Worker: what a job owns, and when it goes.
#include "posix/worker.h"

#include <gtest/gtest.h>

#include <future>
#include <memory>

#include "peer.h"

namespace etcm::port {
namespace {

TEST(WorkerTest, WhatItsJobOwnsGoesWithIt) {
  // A thread that ends later would keep it for some runs in a thousand.
  for (int run = 0; run < 1000; ++run) {
    auto owned = std::make_shared<int>(0);
    const std::weak_ptr<int> watched = owned;
    {
      Worker worker("etcm-test", [owned = std::move(owned)] { ++*owned; });
      worker.start();
      ASSERT_TRUE(worker.wait(patience));
      ASSERT_FALSE(watched.expired());
    }
    ASSERT_TRUE(watched.expired()) << run;
  }
}

TEST(WorkerTest, ARunUnderWayKeepsWhatItUses) {
  struct Owned {
    std::promise<void> begun;
    std::promise<bool> was_kept;
  };
  auto owned = std::make_shared<Owned>();
  const std::weak_ptr<Owned> watched = owned;
  std::future<void> begun = owned->begun.get_future();
  std::future<bool> was_kept = owned->was_kept.get_future();
  std::promise<void> go_on;
  {
    Worker worker("etcm-test",
                  [&watched, owned = std::move(owned), may_go_on = go_on.get_future().share()] {
                    owned->begun.set_value();
                    may_go_on.wait();
                    owned->was_kept.set_value(!watched.expired());
                  });
    worker.start();
    begun.wait();
  }
  go_on.set_value();
  EXPECT_TRUE(was_kept.get());
}

}  // namespace
}  // namespace etcm::port
