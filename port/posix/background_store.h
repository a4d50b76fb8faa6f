// Store in a file (posix/state_file.h), saved by a thread of its own.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "etcm/port/log.h"
#include "etcm/port/store.h"
#include "posix/disk_failure.h"
#include "posix/state_file.h"
#include "posix/worker.h"

namespace etcm::port {

class BackgroundStore final : public Store {
 public:
  // Takes the memory for `size_max` bytes now. The log hears of copies that are not sound.
  BackgroundStore(const std::string& folder, std::size_t size_max, Log& log);

  std::span<const std::byte> load(Copy copy) override;
  std::string_view set_aside(Copy copy) override;
  void start_save(std::span<const std::byte> bytes) override;
  bool is_saving() const override { return worker_.is_busy(); }
  bool take_result(DiskResult& result) override;

  // Waits for a save under way; false when that takes longer than `at_most`. It is then left
  // behind.
  bool wait(Duration at_most) { return worker_.wait(at_most); }

  const std::string& folder() const { return folder_; }

 private:
  // What the thread uses, and keeps should it hang.
  struct Saving {
    explicit Saving(const std::string& folder) : file(folder) {}
    StateFile file;
    std::vector<std::byte> bytes;
    StateFile::Failure failure;
  };

  std::string folder_;
  Log& log_;
  std::shared_ptr<Saving> saving_;
  Worker worker_;
  bool is_result_due_ = false;
  std::vector<std::byte> loaded_;
  std::string aside_;
  DiskFailure words_;
};

}  // namespace etcm::port
