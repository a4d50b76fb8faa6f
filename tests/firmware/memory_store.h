// A store that keeps its copies in memory, and fails or takes long when it is told to.
#pragma once

#include <string>
#include <vector>

#include "etcm/port/store.h"

namespace etcm::firmware {

class MemoryStore final : public port::Store {
 public:
  std::span<const std::byte> load(port::Copy copy) override {
    return copy == port::Copy::last ? last : previous;
  }
  std::string_view set_aside(port::Copy copy) override {
    std::vector<std::byte>& bytes = copy == port::Copy::last ? last : previous;
    aside.push_back(std::move(bytes));
    bytes.clear();
    name_ = "aside-" + std::to_string(aside.size());
    return name_;
  }
  void start_save(std::span<const std::byte> bytes) override {
    ++saves;
    has_news_ = true;
    if (!why.empty()) return;
    previous = last;
    last.assign(bytes.begin(), bytes.end());
  }
  bool is_saving() const override { return has_news_ && is_slow; }
  bool take_result(port::DiskResult& result) override {
    if (!has_news_ || is_slow) return false;
    has_news_ = false;
    result = {.ok = why.empty(), .why = why};
    return true;
  }

  std::vector<std::byte> last;
  std::vector<std::byte> previous;
  std::vector<std::vector<std::byte>> aside;
  std::size_t saves = 0;
  std::string why;  // not empty: saving fails, for this reason
  bool is_slow = false;

 private:
  std::string name_;
  bool has_news_ = false;
};

}  // namespace etcm::firmware
