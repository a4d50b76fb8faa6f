// What people call nodes, features and the site, by the settings of now.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/config/settings.h"
#include "firmware/polling/poller.h"

namespace etcm::firmware {

// A name of a node in its book; none: nobody has named it.
using NameIndex = StrongId<struct NameTag>;

// Of a node that another gateway hears.
struct ToldName {
  Serial serial;
  std::string name;
};

// It is never changed once it is made, so that whoever shows a state of the mesh keeps its names.
class NameBook {
 public:
  NameBook() = default;
  // `told` in the order of their serials: it counts where the settings say nothing. O(n log n), and
  // takes its memory.
  NameBook(const Settings& settings, const Poller& poller, std::vector<ToldName> told = {});

  // The name that its serial has, or else that of the unit where it answers, which may be none.
  // O(log n).
  NameIndex find(Serial serial, UnitIndex unit) const;
  // Empty where there is none, here and below.
  std::string_view text(NameIndex name) const {
    return name.is_none() ? std::string_view() : std::string_view(nodes_[name.value]);
  }
  // `number` counts from 1 as configured.
  std::string_view feature(std::uint32_t number) const {
    return number - 1 < features_.size() ? std::string_view(features_[number - 1])
                                         : std::string_view();
  }
  std::string_view site() const { return site_; }
  // What the gateway that hears it calls it, whatever the settings say. O(log n).
  std::string_view told(Serial serial) const { return text(find(told_, serial.value)); }

 private:
  struct Entry {
    std::uint32_t key;  // a serial, or a unit index
    NameIndex name;
  };
  static NameIndex find(const std::vector<Entry>& entries, std::uint32_t key);

  std::string site_;
  std::vector<std::string> nodes_;
  std::vector<std::string> features_;
  std::vector<Entry> by_serial_;  // sorted, as the next
  std::vector<Entry> by_unit_;
  std::vector<Entry> told_;
};

// How a line for people names a node: "node 7 'pump house'", or "node 7".
struct CalledNode {
  Serial serial;
  std::string_view name;
};
template <class Text>
Text& operator<<(Text& text, const CalledNode& node) {
  text << "node " << node.serial.value;
  if (!node.name.empty()) text << " '" << node.name << "'";
  return text;
}

// The same of a feature: "feature 3 'fence'". `number` counts from 1 as configured.
struct CalledFeature {
  std::uint32_t number;
  std::string_view name;
};
template <class Text>
Text& operator<<(Text& text, const CalledFeature& feature) {
  text << "feature " << feature.number;
  if (!feature.name.empty()) text << " '" << feature.name << "'";
  return text;
}

}  // namespace etcm::firmware
