#include "posix/background_store.h"

#include <algorithm>

namespace etcm::port {

BackgroundStore::BackgroundStore(const std::string& folder, std::size_t size_max, Log& log)
    : folder_(folder),
      log_(log),
      saving_(std::make_shared<Saving>(folder)),
      worker_("etcm-disk",
              [saving = saving_] { saving->failure = saving->file.save(saving->bytes); }) {
  // Written to, so that a full memory shows now and not at the first save.
  saving_->bytes.resize(size_max);
}

std::span<const std::byte> BackgroundStore::load(Copy copy) {
  std::string why;
  switch (saving_->file.load(copy, loaded_, why)) {
    case StateFile::Found::nothing:
    case StateFile::Found::sound:
      break;
    case StateFile::Found::broken:
    case StateFile::Found::unreadable: {
      const std::string name = copy == Copy::last ? "/state" : "/state.previous";
      log_.write(Level::warning,
                 folder_ + name + ": " + why + "; it is kept as " + std::string(set_aside(copy)));
      break;
    }
  }
  return loaded_;
}

std::string_view BackgroundStore::set_aside(Copy copy) {
  aside_ = saving_->file.set_aside(copy);
  return aside_;
}

void BackgroundStore::start_save(std::span<const std::byte> bytes) {
  saving_->bytes.resize(bytes.size());
  std::copy(bytes.begin(), bytes.end(), saving_->bytes.begin());
  is_result_due_ = true;
  worker_.start();
}

bool BackgroundStore::take_result(DiskResult& result) {
  if (!is_result_due_ || worker_.is_busy()) return false;
  is_result_due_ = false;
  const StateFile::Failure& failure = saving_->failure;
  result = {.ok = failure.action == nullptr, .why = {}};
  if (result.ok) return true;
  result.why = words_.describe(folder_, failure.action, failure.error, "state");
  return true;
}

}  // namespace etcm::port
