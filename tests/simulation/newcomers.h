// Nodes that have no unit of their own yet, on buses that give them one: they come, one or several
// at a time, lose theirs again, will not take one, or are taken away.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "site_world.h"

namespace etcm::simulation {

class Newcomers {
 public:
  // Enters into the settings of the site what is needed for them. What they do is drawn from a
  // chance of their own.
  Newcomers(SiteWorld& site, std::uint64_t seed, Instant now);

  // Does what is due by now, and sees who has another unit than before. What is wrong with that, or
  // nothing: where somebody answers, nobody else may be put.
  std::string step(Instant now);
  Instant next() const { return is_at_rest_ ? parted_at_ : happens_at_; }

  // All take what they are given from now on. Of two at one unit one is set back by hand, for from
  // afar nobody can part them; also a minute later, where a unit was given whose node was silent
  // just then.
  void end_faults(Instant now);
  // All for whom there is a unit must have it.
  std::string look_at_rest() const;

  // So long it takes until all who wait have been heard one by one, beside what it takes anyway.
  Duration heard_within() const;
  bool has_waiting() const;
  std::uint64_t given() const { return given_; }  // units, to nodes

 private:
  void happen(Instant now);
  void part();
  // Who answers at the unit of this one, and has for a while.
  const Device* answers_beside(const Device& device, Instant now) const;
  void come(std::size_t bus, Instant now);
  void take_away(Device& device, Instant now);
  // Those that have none, or were given one.
  std::vector<Device*> all() const;
  std::size_t count_on(std::size_t bus) const;
  // Whoever answers there is to be told from others first.
  void disturb(std::size_t bus, std::uint8_t unit, Instant now);

  SiteWorld& site_;
  inputs::Random random_;
  std::vector<std::uint8_t> units_;  // of the site's devices, when they were seen last
  Duration pause_{};
  Instant happens_at_{};
  bool is_at_rest_ = false;
  Instant parted_at_ = port::never;
  std::uint64_t given_ = 0;
};

}  // namespace etcm::simulation
