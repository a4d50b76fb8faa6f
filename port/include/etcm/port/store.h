// Keeps one piece of state over a restart and over a power failure.
//
// A disk may be slow, full, read-only or dead, so saving does not wait for it: start_save() hands
// the bytes over, take_result() tells later how that ended. Loading is for the start, and may wait.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "etcm/port/disk_result.h"

namespace etcm::port {

enum class Copy : std::uint8_t {
  last,      // what was saved last
  previous,  // what was saved before that
};

class Store {
 public:
  // What is kept, or empty where there is nothing sound. Valid until the next call.
  virtual std::span<const std::byte> load(Copy copy) = 0;

  // Moves a copy that the caller cannot use out of the way, where no save replaces it and a person
  // may look at it. Returns the name it has then, valid until the next call.
  virtual std::string_view set_aside(Copy copy) = 0;

  // Starts to replace what is kept by a copy of `bytes`. After a crash at any moment load() gives
  // the old bytes or the new ones; the old ones also stay where saving fails. REQUIRES: no save
  // under way. More bytes than the store was made for take memory.
  virtual void start_save(std::span<const std::byte> bytes) = 0;
  virtual bool is_saving() const = 0;

  // How the save that has ended went; false when there is nothing to tell. Each is told once.
  virtual bool take_result(DiskResult& result) = 0;

 protected:
  ~Store() = default;
};

}  // namespace etcm::port
