// The configured features, by their ends, and which of them are in the mesh.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "etcm/mesh.h"
#include "firmware/config/settings.h"
#include "firmware/records/name_book.h"

namespace etcm::firmware {

// A feature that is in the way of another.
struct Blocker {
  std::uint32_t number = 0;        // from 0
  std::optional<Position> near{};  // where they cross, to the unit; none: they overlap
  friend constexpr bool operator==(const Blocker&, const Blocker&) = default;
};

// How a line for people names a feature with its place in the settings: "feature 3 'north fence'
// (site.geojson:31)", or by its ends "feature 3 (1001-1004, site.toml:31)". `number` counts from 1.
struct PlacedFeature {
  std::uint32_t number;
  const FeatureSettings& settings;
};
template <class Text>
Text& operator<<(Text& text, const PlacedFeature& feature) {
  const FeatureSettings& settings = feature.settings;
  text << CalledFeature{feature.number, settings.name} << " (";
  if (settings.name.empty()) {
    text << to_string(settings.from) << "-" << to_string(settings.to) << ", ";
  }
  return text << settings.source << ")";
}

struct FeatureRecord {
  FeatureSettings settings;
  FeatureId id;                      // none: not in the mesh
  Status rejection = Status::ok;     // why the mesh rejected it; it waits for the mesh to make room
  std::optional<Blocker> blocker{};  // none: it was something else
  std::uint32_t rejected_epoch = 0;
  port::Instant rejected_since{};

  bool is_active() const { return !id.is_none(); }
};

class FeatureTable {
 public:
  // `feature_ids_max`: ids the mesh gives out are below this.
  FeatureTable(std::span<const FeatureSettings> features, std::uint32_t feature_ids_max);

  std::span<FeatureRecord> records() { return records_; }
  std::span<const FeatureRecord> records() const { return records_; }

  // The numbers (from 0) of the features that end here.
  std::span<const std::uint32_t> ending_at(const FeatureEnd& end) const;

  // The feature with this id; its number counts from 0. REQUIRES: the id is active.
  std::uint32_t number_of(FeatureId id) const { return number_by_id_[id.value]; }

  void activate(std::uint32_t number, FeatureId id);
  // It waits for its ends, neither in the mesh nor rejected.
  void deactivate(std::uint32_t number);
  void reject(std::uint32_t number, Status why, const std::optional<Blocker>& blocker,
              std::uint32_t epoch, port::Instant now);

  std::uint32_t active_count() const { return active_count_; }
  std::uint32_t rejected_count() const { return rejected_count_; }

  // As PlacedFeature.
  std::string name(std::uint32_t number) const;

 private:
  struct End {
    std::uint64_t key;
    std::uint32_t first;  // into numbers_
    std::uint32_t count;
  };

  void clear_rejection(FeatureRecord& record);

  std::vector<FeatureRecord> records_;
  std::vector<std::uint32_t> numbers_;  // grouped by end
  std::vector<End> ends_;               // sorted by key
  std::vector<std::uint32_t> number_by_id_;
  std::uint32_t active_count_ = 0;
  std::uint32_t rejected_count_ = 0;
};

}  // namespace etcm::firmware
