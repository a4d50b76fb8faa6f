#include "firmware/persist/state_saver.h"

#include <algorithm>
#include <limits>

namespace etcm::firmware {

namespace {

constexpr DiskMessages state_messages{
    .failed = "state is not saved: ",
    .unresponsive =
        "state: the disk of `folder` of [state] does not answer, look at it: a restart "
        "would find an earlier state; goes on without",
    .works_again = "state is saved again"};

// Generations between two saves, and some that were under way.
std::uint32_t generations_per(port::Duration interval, port::Duration pause) {
  return static_cast<std::uint32_t>(interval / pause) + 8;
}

}  // namespace

StateSaver::StateSaver(const Settings& settings, port::Duration pause, port::Store& store,
                       port::Log& log)
    : folder_(settings.state->folder),
      store_(store),
      log_(log),
      disk_(state_messages, settings.state->interval, log),
      writer_(saved_state_size_max(settings)),
      generations_between_(generations_per(settings.state->interval, pause)) {
  for (const BusSettings& bus : settings.buses) bus_names_.emplace_back(saved_bus_name(bus.name));
}

std::optional<SavedState> StateSaver::load() {
  for (const port::Copy copy : {port::Copy::last, port::Copy::previous}) {
    const std::span<const std::byte> bytes = store_.load(copy);
    if (bytes.empty()) continue;
    SavedState state;
    const std::string fault = judge(bytes, state);
    const bool is_last = copy == port::Copy::last;
    if (fault.empty()) {
      if (!is_last) log_.write(port::Level::warning, "state: takes the copy before the last");
      return state;
    }
    log_.write(port::Level::warning, std::string("state: ") +
                                         (is_last ? "the last" : "the previous") +
                                         " copy is not used, " + fault + "; it is kept as " +
                                         folder_ + "/" + std::string(store_.set_aside(copy)));
  }
  return std::nullopt;
}

// What is wrong with a state here; empty where nothing is.
std::string StateSaver::judge(std::span<const std::byte> bytes, SavedState& state) const {
  if (std::string fault = decode_state(bytes, state); !fault.empty()) return fault;
  const bool is_of_this_one =
      state.buses.empty() ||
      std::find_first_of(state.buses.begin(), state.buses.end(), bus_names_.begin(),
                         bus_names_.end()) != state.buses.end();
  if (is_of_this_one) return "";
  return "it is of another configuration, without any bus of this one (it has " +
         state.buses.front() + ")";
}

void StateSaver::step(port::Instant now) {
  if (disk_.hear(store_, now) != DiskWriter::Heard::written) return;
  saved_content_ = saving_content_;
  saved_next_ = saving_next_;
}

StateWriter& StateSaver::begin(std::uint32_t generation, std::uint64_t mesh_hash,
                               std::int64_t time_of_day_s) {
  constexpr std::uint32_t last = std::numeric_limits<std::uint32_t>::max();
  // Saves come one interval apart, and one may fail or be under way while the power does.
  const std::uint32_t ahead = is_ending_ ? 1 : 2 * generations_between_;
  written_generation_ = generation;
  written_next_ = generation < last - ahead ? generation + ahead : last;
  writer_.begin(generation, written_next_, mesh_hash, time_of_day_s);
  if (is_ending_) writer_.set_last();
  return writer_;
}

void StateSaver::save(port::Instant now) {
  const std::span<const std::byte> bytes = writer_.finish();
  disk_.skip(now);
  const bool is_promise_kept = written_generation_ + generations_between_ < saved_next_;
  if (writer_.content() == saved_content_ && is_promise_kept && !is_ending_) return;
  if (is_ending_ && writer_.content() == saved_content_ && written_next_ == saved_next_) return;
  saving_content_ = writer_.content();
  saving_next_ = written_next_;
  disk_.start(now);
  store_.start_save(bytes);
}

void StateSaver::finish() {
  is_ending_ = true;
  disk_.mark_urgent();
}

}  // namespace etcm::firmware
