// Which sensors of one quantity disagree persistently with what the nodes around them predict.
//
// README.md has the method, its figures and what it cannot tell. Times are counted in samples.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "etcm/port/clock.h"
#include "firmware/readings/nearest_nodes.h"
#include "firmware/readings/reference.h"
#include "firmware/readings/sequential.h"
#include "firmware/readings/thin_plate.h"
#include "firmware/records/learned_sensor.h"

namespace etcm::firmware {

// The time between two samples of the site: what the thresholds are meant for.
inline constexpr port::Duration sample_interval = std::chrono::minutes(1);

// Samples with a prediction before a sensor is judged.
inline constexpr std::uint32_t learning_samples = 240;

// What comes and goes is the field rather than the sensor: with each of its alarms that ended its
// deviation counts once more, for so many of them.
inline constexpr std::uint8_t ended_alarms_max = 3;

// Of one sensor, as of the sample in which it was read last.
struct Agreement {
  bool disagrees = false;  // the alarm; stands until it agrees again
  bool is_judged = false;  // enough has been learned, and the nodes around suffice to judge it
  // What it should have read, the learned offset of its place included. None: they do not suffice.
  std::optional<double> expected;
  double deviation = 0;  // standard deviation of a sound reading from it
  double suspicion = 0;  // the greater cumulative sum; the alarm begins above 1 and ends at 0
};

// A sensor, by the row of its node.
struct PlacedSensor {
  std::uint32_t row = 0;
  std::uint64_t definition = 0;  // of what it measures (profile/fingerprint.h)
};

class DisagreementWatch {
 public:
  // For sites of so many rows, and so many sensors; all the memory it needs is taken here: 4 bytes
  // a row, and about 1.6 KB a sensor. Several watches may share `nodes`, which must outlive them.
  // Differences of up to `tolerance`, in the unit of the quantity, mean nothing: the resolution of
  // the sensors, or 0.
  DisagreementWatch(const NearestNodes& nodes, std::uint32_t vertices_max,
                    std::uint32_t sensors_max, double tolerance = 0);
  // Room for more sensors.
  void set_room(std::uint32_t sensors_max);

  // Another generation, which `nodes` has taken, and its sensors. One is forgotten where its row
  // has none any more, or one with another definition, or another node, or its node has moved by a
  // tenth of the way to the nearest one. Takes no memory for as many as there is room for. O(n).
  void take(const Snapshot& snapshot, std::span<const PlacedSensor> sensors);

  std::size_t sensor_count() const { return records_.size(); }
  bool has_sensor(std::uint32_t row) const {
    return row < place_of_.size() && place_of_[row] != no_place;
  }

  // What was learned of each sensor, without its quantity, in any order. Of one that was read a few
  // times only it is nothing yet.
  template <class Visit>
  void for_each_learned(Visit visit) const {
    for (const Record& record : records_) {
      if (record.reference.has_begun()) visit(learned_of(record));
    }
  }
  // Goes on with what was learned before. False, and nothing changes, where something has been
  // learned here since, it is another sensor or stands elsewhere, or the numbers make no sense.
  // REQUIRES: has_sensor().
  bool restore(std::uint32_t row, const LearnedSensor& learned);

  // One sample of the site, one value a row; without a sensor a row has none. A value that is not
  // finite, or beyond 1e100, is none; without one a row stays as it is, alarm included. Give a
  // reading once: one that is repeated because the node was not asked again is none. O(n), and one
  // ThinPlate::fit() for each row around which a value appears or disappears.
  void observe(std::span<const double> values);

  // Nothing is known of a row without a sensor.
  const Agreement& of(std::uint32_t row) const;

  // The sensor of a row is another one, or the field has changed for good: learn it anew.
  // REQUIRES: has_sensor().
  void forget(std::uint32_t row);

 private:
  static constexpr std::uint32_t no_place = 0xffffffff;
  static constexpr double no_evidence = std::numeric_limits<double>::quiet_NaN();

  struct Record {
    std::uint32_t row = 0;
    Serial serial{};
    std::uint64_t definition = 0;
    Point point;
    bool is_wanted = true;             // while rows are taken
    std::uint32_t silent_samples = 0;  // since it had a value
    double value = no_evidence;        // in this sample
    double change = no_evidence;       // of it since its reference; NaN: no evidence
    double slow_change = no_evidence;  // mean of the last of them
    Reference reference;
    double last_value = no_evidence;  // the one before, while believed
    bool is_noisy = false;            // so that a smoother surface predicts it better
    QuantileTracker step = QuantileTracker::median();          // from one value to the next
    QuantileTracker residual = QuantileTracker::median();      // its magnitude
    double slow_residual = 0;                                  // its mean over the last samples
    QuantileTracker wander = QuantileTracker::ninth_decile();  // the magnitude of that
    QuantileTracker roughness = QuantileTracker::median();     // around: ThinPlate::deviation()
    std::uint32_t sample_count = 0;                            // with a residual
    TwoSidedCusum cusum;
    std::uint8_t ended_alarms = 0;  // up to ended_alarms_max
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
    double roughness = 0;  // ThinPlate::deviation() of the changes around
    // And of their means over the last samples, less what noise alone would make of it.
    double slow_roughness = 0;
  };

  // The square of a value does not overflow.
  static bool is_value(double value) { return std::abs(value) <= 1e100; }
  static LearnedSensor learned_of(const Record& record);
  // A node at `point` stands where the node in this row stood.
  bool is_same_place(std::uint32_t row, const Point& stood, const Point& point) const;
  void remove(std::uint32_t place);
  // Null: there is no sensor.
  const Record* record_at(std::uint32_t row) const {
    return has_sensor(row) ? &records_[place_of_[row]] : nullptr;
  }
  void find_range();
  void find_noise();
  void judge(Record& record);
  double deviation_of(const Record& record, const Prediction& prediction) const;
  double wander_of(const Record& record) const;
  void begin_reference(Record& record);
  void learn(Record& record, double residual, const Prediction& prediction);
  std::optional<Prediction> predict(Record& record);
  double mean_change_around(const Record& record) const;
  double least_deviation() const;
  void raise_alarms();

  const NearestNodes* nodes_;
  double tolerance_;
  double range_ = 0;                     // of the field over the site
  double noise_ = 0;                     // standard deviation of that of a usual sensor
  double magnitude_ = 0;                 // of its greatest value
  std::vector<std::uint32_t> place_of_;  // by row: in records_
  std::vector<Record> records_;          // by sensor
  std::vector<double> sorted_;
};

}  // namespace etcm::firmware
