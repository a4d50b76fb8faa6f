#include "posix/worker.h"

#include <pthread.h>

#include <condition_variable>
#include <csignal>
#include <mutex>
#include <thread>
#include <utility>

namespace etcm::port {

struct Worker::Shared {
  std::function<void()> job;
  std::mutex mutex;
  std::condition_variable changed;
  bool is_busy = false;
  bool is_ended = false;
};

Worker::Worker(const char* name, std::function<void()> job) : shared_(std::make_shared<Shared>()) {
  shared_->job = std::move(job);
  // Signals are for the event loop; the thread inherits this mask.
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread([shared = shared_] {
    std::unique_lock lock(shared->mutex);
    for (;;) {
      shared->changed.wait(lock, [&] { return shared->is_busy || shared->is_ended; });
      if (!shared->is_busy) return;
      lock.unlock();
      shared->job();
      lock.lock();
      shared->is_busy = false;
      shared->changed.notify_all();
    }
  });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  pthread_setname_np(thread.native_handle(), name);
  // A thread that hangs in the disk cannot be joined, so none is.
  thread.detach();
}

Worker::~Worker() {
  // Goes without the mutex, and now: when the thread itself ends is up to the scheduler.
  std::function<void()> unused;
  const std::lock_guard lock(shared_->mutex);
  if (!shared_->is_busy) unused.swap(shared_->job);
  shared_->is_ended = true;
  shared_->changed.notify_all();
}

void Worker::start() {
  const std::lock_guard lock(shared_->mutex);
  shared_->is_busy = true;
  shared_->changed.notify_all();
}

bool Worker::is_busy() const {
  const std::lock_guard lock(shared_->mutex);
  return shared_->is_busy;
}

bool Worker::wait(Duration at_most) {
  std::unique_lock lock(shared_->mutex);
  return shared_->changed.wait_for(lock, at_most, [&] { return !shared_->is_busy; });
}

}  // namespace etcm::port
