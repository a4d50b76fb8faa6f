// A device of a profile that a test writes down: its registers, and what a sweep of them says.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/profile/profile_reader.h"
#include "support/scratch_folder.h"

namespace etcm::firmware {

struct ReadProfiles {
  std::vector<Profile> profiles;
  std::vector<std::string>
      mistakes;  // each begins with "FILE:LINE: " or "FILE: ", FILE being p.toml

  std::string all_mistakes() const {
    std::string text;
    for (const std::string& mistake : mistakes) text += mistake + "\n";
    return text;
  }
};

inline ReadProfiles read_profile_text(const std::string& toml) {
  const test::ScratchFolder folder;
  ReadProfiles read;
  read.profiles = read_profiles(folder.write("p.toml", toml), read.mistakes);
  const std::string prefix = folder.path("");
  for (std::string& mistake : read.mistakes) {
    if (mistake.starts_with(prefix)) mistake.erase(0, prefix.size());
  }
  return read;
}

// The only profile of the text, which has no mistakes.
inline Profile sound_profile(const std::string& toml) {
  const toml::table parsed = toml::parse(toml);
  const std::string file = "p.toml";
  std::vector<std::string> mistakes;
  std::vector<Profile> profiles;
  TomlTable table(file, parsed, "", mistakes);
  table.each("profile", [&](TomlTable& each) { profiles.push_back(read_profile(each)); });
  if (!mistakes.empty()) throw std::runtime_error(toml + "\n" + mistakes.front());
  return profiles.at(0);
}

// Of a negative one two's complement.
inline std::uint16_t word(int value) { return static_cast<std::uint16_t>(value); }

class Device {
 public:
  explicit Device(Profile profile) : profile_(std::move(profile)), blocks_(blocks_of(profile_)) {}

  // What stands nowhere else is 0.
  void set(std::uint16_t first, const std::vector<std::uint16_t>& words) {
    for (std::size_t i = 0; i < words.size(); ++i) {
      registers_[static_cast<std::uint16_t>(first + i)] = words[i];
    }
  }

  const Profile& profile() const { return profile_; }
  const std::vector<RegisterSpan>& blocks() const { return blocks_; }
  DevicePosition position() { return position_of(profile_, sweep()); }
  FieldValue reading(std::size_t i = 0) { return reading_of(profile_.readings.at(i), sweep()); }
  std::optional<std::uint32_t> serial() { return serial_of(profile_, sweep()); }

 private:
  Sweep sweep() {
    read_.clear();
    for (const RegisterSpan block : blocks_) {
      for (unsigned at = block.first; at < block.end(); ++at) {
        read_.push_back(registers_[static_cast<std::uint16_t>(at)]);
      }
    }
    return {blocks_, read_};
  }

  Profile profile_;
  std::vector<RegisterSpan> blocks_;
  std::map<std::uint16_t, std::uint16_t> registers_;
  std::vector<std::uint16_t> read_;
};

// One with a single reading, such as "register = 0, type = \"i16\"".
inline Device device_of(const std::string& value) {
  return Device(sound_profile(
      "[[profile]]\nname = \"p\"\n[[profile.reading]]\nname = \"r\"\nvalue = { " + value + " }\n"));
}

// What that reading is with these registers from 0 on.
inline FieldValue decoded(const std::string& value, const std::vector<std::uint16_t>& words) {
  Device device = device_of(value);
  device.set(0, words);
  return device.reading();
}

}  // namespace etcm::firmware
