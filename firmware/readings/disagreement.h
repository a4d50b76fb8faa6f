// Which sensors of one quantity disagree persistently with what the nodes around them predict.
//
// README.md has the method, its figures and what it cannot tell. Times are counted in samples; the
// thresholds are meant for one a minute.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "firmware/readings/nearest_nodes.h"
#include "firmware/readings/reference.h"
#include "firmware/readings/sequential.h"
#include "firmware/readings/thin_plate.h"

namespace etcm::firmware {

// Samples with a prediction before a sensor is judged.
inline constexpr std::uint32_t learning_samples = 240;

// Of one sensor, as of the sample in which it was read last.
struct Agreement {
  bool disagrees = false;  // the alarm; stands until it agrees again
  bool is_judged = false;  // enough has been learned, and the nodes around suffice to judge it
  // What it should have read, the learned offset of its place included. None: they do not suffice.
  std::optional<double> expected;
  double deviation = 0;  // standard deviation of a sound reading from it
  double suspicion = 0;  // the greater cumulative sum; the alarm begins above 1 and ends at 0
};

class DisagreementWatch {
 public:
  // For sites of so many rows; all the memory it needs is taken here, about 1.5 KB a row. Several
  // watches may share `nodes`, which must outlive them. Differences of up to `tolerance`, in the
  // unit of the quantity, mean nothing: the resolution of the sensors, or 0.
  DisagreementWatch(const NearestNodes& nodes, std::uint32_t vertices_max, double tolerance = 0);

  // Another generation, which `nodes` has taken. A row forgets what it knows where another node is
  // in it, or its node has moved by a tenth of the way to the nearest one. O(n).
  void take(const Snapshot& snapshot);

  // One sample of the site, one value a row. A value that is not finite, or beyond 1e100, is none;
  // without one a row stays as it is, alarm included. Give a reading once: one that is repeated
  // because the node was not asked again is none. O(n), and one ThinPlate::fit() for each row
  // around which a value appears or disappears.
  void observe(std::span<const double> values);

  // REQUIRES: row < vertices_max.
  const Agreement& of(std::uint32_t row) const { return records_[row].agreement; }

  // The sensor of a row is another one, or the field has changed for good: learn it anew.
  void forget(std::uint32_t row);

 private:
  struct Record {
    Serial serial{};
    Point point;
    bool is_node = false;
    Reference reference;
    MedianTracker residual;          // its magnitude
    MedianTracker roughness;         // of the readings around: ThinPlate::deviation()
    std::uint32_t sample_count = 0;  // with a residual
    TwoSidedCusum cusum;
    bool takes_back = false;        // see Reference::take_back()
    std::uint32_t disbelieved = 0;  // bit i: the sensor of around(row)[i] disagrees
    double strength = 0;            // of a candidate for the alarm in this sample
    std::uint32_t used = 0;         // bit i: the surface goes through around(row)[i]
    bool has_surface = false;
    bool is_surface_current = false;
    ThinPlate surface;
    Agreement agreement;
  };
  // What the nodes around say of the change since the references were taken.
  struct Prediction {
    double change = 0;
    double roughness = 0;       // ThinPlate::deviation() of the changes around
    double slow_roughness = 0;  // and of their means over the last samples
  };

  bool has_value(std::uint32_t row) const;
  void find_range();
  void judge(std::uint32_t row);
  double deviation_of(const Record& record, const Prediction& prediction) const;
  void begin_reference(Record& record, std::uint32_t row);
  void learn(Record& record, double residual, double roughness);
  std::optional<Prediction> predict(Record& record, std::uint32_t row);
  double mean_change_around(std::uint32_t row) const;
  double least_deviation() const;
  void raise_alarms();

  const NearestNodes* nodes_;
  double tolerance_;
  double range_ = 0;      // of the field over the site
  double magnitude_ = 0;  // of its greatest value
  std::vector<Record> records_;
  std::vector<double> values_;
  std::vector<double> change_;       // by row: of its value since its reference; NaN: no evidence
  std::vector<double> slow_change_;  // by row: mean of the last of them
  std::vector<double> sorted_;
};

}  // namespace etcm::firmware
