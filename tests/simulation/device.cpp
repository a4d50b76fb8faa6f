#include "device.h"

#include <algorithm>
#include <array>

namespace etcm::simulation {

using namespace std::chrono_literals;

namespace {

// Who asks about what was so long ago gets no answer here.
constexpr Duration remembered = 10min;

constexpr std::uint8_t write_one = 6, write_many = 16;
constexpr std::uint8_t illegal_function = 1, illegal_address = 2, device_busy = 6;
constexpr std::uint16_t assignment_first = 100, assignment_count = 4, assignment_commit = 0x4554;
constexpr std::uint8_t device_failure = 4;
constexpr std::uint16_t configuration_first = 200, configuration_end = 443;
constexpr std::uint16_t fix_valid = 1, leaving = 1 << 5;
// Where the first block begins, how many registers each has, so that the answers look alike, and a
// good fix.
constexpr std::uint16_t first_block = 1, block_count = 5, fix_in_the_plane = 2;

std::uint16_t high(std::uint32_t value) { return static_cast<std::uint16_t>(value >> 16); }
std::uint16_t low(std::uint32_t value) { return static_cast<std::uint16_t>(value); }

std::uint16_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

std::vector<std::uint8_t> exception(std::uint8_t function, std::uint8_t code) {
  return {static_cast<std::uint8_t>(function | 0x80), code};
}

}  // namespace

bool begins_a_sweep(std::span<const std::uint8_t> pdu) {
  return pdu.size() == 5 && (pdu[0] == read_holding || pdu[0] == read_input) &&
         word(pdu, 1) < second_block;
}

const char* profile_name(Make make) { return make == Make::checked ? "checked" : "in-blocks"; }

std::string profile_of(Make make) {
  std::string text = std::string("[[profile]]\nname = \"") + profile_name(make) +
                     "\"\nfunction = 4\n"
                     "serial = { register = 2, type = \"u32\" }\n"
                     "valid = { register = 1, mask = 3, equals = [2, 3] }\n"
                     "x = { register = 4, type = \"i32\", order = \"CDAB\" }\n"
                     "y = { register = 20, type = \"i32\", order = \"CDAB\" }\n";
  // Slower than any step it makes: each place that counts was told twice.
  if (make == Make::checked) text += "speed_max = \"0.001\"\n";
  return text +
         "[[profile.reading]]\nname = \"level\"\nunit = \"m\"\n"
         "value = { register = 22, type = \"i16\", scale = \"0.001\" }\n"
         "[[profile.reading]]\nname = \"volume\"\n"
         "value = { register = 23, type = \"u32\" }\n";
}

Device::Device(std::uint32_t number, std::size_t on_bus, std::uint8_t at_unit, Make what,
               Position place, Instant now)
    : serial(number), bus(on_bus), unit(at_unit), make(what), undisturbed_since(now) {
  places_.push_back({now, place});
}

void Device::move(Position place, Instant now) {
  places_.push_back({now, place});
  // Nothing counts that it says once.
  if (make == Make::checked) answers = 0;
  sequence_ = static_cast<std::uint16_t>(sequence_ + 1);
  while (places_.size() > 2 && places_[1].since + remembered < now) places_.pop_front();
}

void Device::fall_ill(Ailment what, Instant now, inputs::Random& random) {
  ailment = what;
  disturb(now);
  lateness_ = 250ms + random.below(4500) * 1ms;
}

template <class Test>
bool Device::has_stayed(Instant from, Test test) const {
  for (std::size_t i = places_.size(); i-- > 0;) {
    if (test(places_[i].position)) return true;
    if (places_[i].since <= from) return false;
  }
  return false;
}

bool Device::held(Position place, Instant from) const {
  return has_stayed(from, [&](Position stay) { return stay == place; });
}

bool Device::held_apart(Position place, Instant from) const {
  return has_stayed(from, [&](Position stay) { return stay.x == place.x; }) &&
         has_stayed(from, [&](Position stay) { return stay.y == place.y; });
}

bool Device::has_registers(std::uint8_t function, std::uint16_t first, std::uint16_t count) const {
  if (make == Make::ours) return first + count <= position_registers;
  if (function != read_input) return false;
  return (first >= first_block && first + count <= first_block + block_count) ||
         (first >= second_block && first + count <= second_block + block_count);
}

std::vector<std::uint16_t> Device::blocks() const {
  const auto x = static_cast<std::uint32_t>(place().x), y = static_cast<std::uint32_t>(place().y);
  std::vector<std::uint16_t> all(second_block + block_count);
  const std::uint16_t fix = ailment == Ailment::lost ? std::uint16_t{0} : fix_in_the_plane;
  std::ranges::copy(std::array{fix, high(serial), low(serial), low(x), high(x)},
                    all.begin() + first_block);
  std::ranges::copy(std::array{low(y), high(y), low(x + y), high(serial), sequence_},
                    all.begin() + second_block);
  return all;
}

std::vector<std::uint16_t> Device::our_registers(Instant now, inputs::Random& random) const {
  const auto x = static_cast<std::uint32_t>(place().x), y = static_cast<std::uint32_t>(place().y);
  std::uint16_t status = 0;
  if (ailment != Ailment::lost) status |= fix_valid;
  if (is_leaving) status |= leaving;
  std::vector<std::uint16_t> all{0x4554, 0x010c,  high(serial), low(serial), sequence_, high(x),
                                 low(x), high(y), low(y),       status,      boots_,    sequence_};
  if (ailment == Ailment::torn && random.below(2) == 0) {
    // The new sequence stands there already, the rest is old or new.
    all[4] = static_cast<std::uint16_t>(sequence_ + 1);
    if (places_.size() > 1 && random.below(2) == 0) {
      all[6] = low(static_cast<std::uint32_t>(places_[places_.size() - 2].position.x));
    }
  }
  if (ailment == Ailment::forgetful) {
    all[10] = static_cast<std::uint16_t>(now.time_since_epoch() / 7s);
  }
  return all;
}

// The list is whole when its head is written.
void Device::configure(std::span<const std::uint8_t> pdu) {
  constexpr std::size_t head = 3;
  const std::uint16_t first = word(pdu, 1), count = word(pdu, 3);
  configuration_.resize(configuration_end - configuration_first);
  for (std::size_t i = 0; i < count; ++i) {
    configuration_[first - configuration_first + i] = word(pdu, 6 + 2 * i);
  }
  if (first != configuration_first || count < head) return;
  told =
      Told{.generation = std::uint32_t{configuration_[0]} << 16 | configuration_[1], .serials = {}};
  for (std::size_t i = 0; i < configuration_[2]; ++i) {
    const std::size_t at = head + 2 * i;
    if (at + 1 >= configuration_.size()) break;
    told->serials.insert(std::uint32_t{configuration_[at]} << 16 | configuration_[at + 1]);
  }
}

void Device::boot(Instant now) {
  ++boots_;
  told.reset();
  configuration_.clear();
  disturb(now);
}

std::vector<std::uint8_t> Device::take(std::span<const std::uint8_t> pdu) {
  const std::uint16_t first = word(pdu, 1), count = word(pdu, 3);
  const std::vector<std::uint8_t> taken(pdu.begin(), pdu.begin() + 5);
  if (first >= configuration_first && first + count <= configuration_end && pdu[5] == 2 * count) {
    configure(pdu);
    return taken;
  }
  if (first != assignment_first || count != assignment_count || pdu[5] != 2 * assignment_count) {
    return exception(pdu[0], illegal_address);
  }
  const std::uint16_t other = word(pdu, 6);
  // It is for another one, or for nobody.
  if (word(pdu, 8) != high(serial) || word(pdu, 10) != low(serial)) return {};
  if (word(pdu, 12) != assignment_commit || other < 1 || other > newcomers_unit) return {};
  if (keeps_unit) return exception(pdu[0], device_failure);
  unit = static_cast<std::uint8_t>(other);
  return taken;
}

std::optional<Device::Answer> Device::hear(std::span<const std::uint8_t> pdu, Instant now,
                                           Duration timeout, inputs::Random& random) {
  if (!is_plugged_in || is_replaced || now < silent_until || ailment == Ailment::dead ||
      pdu.empty())
    return std::nullopt;
  if (ailment == Ailment::forgetful && (now.time_since_epoch() / 7s) % 2 == 0) return std::nullopt;
  Answer answer{.pdu = exception(pdu[0], illegal_function), .after = 5ms, .is_sound = false};
  switch (ailment) {
    case Ailment::slow:
      answer.after = timeout - 20ms - random.below(20) * 1ms;
      break;
    case Ailment::late:
      answer.after = lateness_;
      break;
    case Ailment::erratic:
      if (random.below(3) == 0) return std::nullopt;
      answer.after = random.below(4700) * 1ms;
      break;
    default:
      break;
  }
  // So that of several each is heard now and then.
  if (unit == newcomers_unit) answer.after += random.below(100) * 1ms;
  if (ailment == Ailment::busy) {
    answer.pdu = exception(pdu[0], device_busy);
    return answer;
  }
  if ((pdu[0] == read_input || pdu[0] == read_holding) && pdu.size() == 5) {
    const std::uint16_t first = word(pdu, 1), count = word(pdu, 3);
    if (count == 0 || !has_registers(pdu[0], first, count)) {
      answer.pdu = exception(pdu[0], illegal_address);
      return answer;
    }
    const auto all = make == Make::ours ? our_registers(now, random) : blocks();
    answer.pdu = {pdu[0], static_cast<std::uint8_t>(2 * count)};
    for (std::uint16_t i = first; i < first + count; ++i) {
      answer.pdu.push_back(static_cast<std::uint8_t>(all[i] >> 8));
      answer.pdu.push_back(static_cast<std::uint8_t>(all[i]));
    }
    const bool is_last = make == Make::ours ? first <= 4 : first >= second_block;
    answer.is_sound = answer.after <= timeout && ailment != Ailment::torn && is_last;
  } else if (make == Make::ours && pdu[0] == write_many && pdu.size() >= 6 &&
             pdu.size() == 6u + pdu[5]) {
    answer.pdu = take(pdu);
    if (answer.pdu.empty()) return std::nullopt;
  } else if (make == Make::ours && pdu[0] == write_one && pdu.size() == 5) {
    answer.pdu = exception(pdu[0], illegal_address);
  }
  return answer;
}

}  // namespace etcm::simulation
