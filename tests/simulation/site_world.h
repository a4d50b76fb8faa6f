// What stands in the field and outlives every gateway: buses with their devices, and a disk.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "converter_world.h"
#include "disk_world.h"
#include "rtu_world.h"
#include "site_file.h"
#include "support/scratch_folder.h"

namespace etcm::simulation {

struct BusWorld {
  std::vector<Device*> devices;  // also those that have been replaced
  std::unique_ptr<RtuWorld> line;
  std::unique_ptr<ConverterWorld> converter;
  Instant undisturbed_since{};

  bool is_out_of_order() const {
    return line ? line->is_cut || line->has_noise : converter->hangs || converter->is_cut();
  }
  // Before this moment, in which the next question may have followed the answer.
  Instant asked_at(std::uint8_t unit, Instant now) const {
    const Instant last = line ? line->asked_at[unit] : converter->asked_at[unit];
    if (last < now) return last;
    return line ? line->asked_before[unit] : converter->asked_before[unit];
  }
  void pass_to(Instant now) {
    if (line) line->pass_to(now);
    if (converter) converter->pass_to(now);
  }
  Instant next() const { return line ? line->next() : converter->next(); }
};

// A unit that does not answer holds a serial line for so long: its time, and the silence behind it.
inline constexpr Duration held_on_a_line_max = std::chrono::milliseconds(1500);
// So late an answer may come at the most where nothing numbers them.
inline constexpr Duration late_answer_max = std::chrono::seconds(5);
// Questions that a standstill of the gateway falls into count for as long as they can take at all,
// a hundred times over, before units that are silent behind a converter are asked again.
inline constexpr Duration standstill_cost_max = std::chrono::seconds(1600);

class SiteWorld {
 public:
  SiteWorld(inputs::Random& random, bool with_other_makes, Instant now);

  void pass_to(Instant now);
  Instant next() const;

  // Once nothing is wrong with a unit, it is asked again and known to be there. Questions in vain
  // have a hundredth of the time of a line that is busy, and each may take a second; behind a
  // converter the first of them five, where a unit has taken so long before it was well.
  Duration found_again_within(std::size_t bus) const;

  // So old is the position of a unit at the most with which nothing is wrong, however ill others of
  // its bus are: it is asked once in an interval, and once more where another one spoils its
  // answer; and each other one may hold the line once. Behind a converter one that had to wait too
  // long for a dead one counts as failing itself, and is found again as such are.
  Duration age_max(const Device& device) const {
    const std::size_t bus = device.bus;
    if (!buses[bus].line) return found_again_within(bus);
    // Who can be asked in one way alone is not asked the same while a spoilt answer to it may come.
    const Duration owed = device.make == Make::ours ? Duration{} : late_answer_max;
    return 2 * (1 + spoilt_by_others(device)) * running.interval + owed +
           whole.buses[bus].unit_count() * held_on_a_line_max + others_cost(bus);
  }
  // Where others ask, answers that come too late for them may spoil this one's time and again, and
  // who has failed several times is asked less often.
  int spoilt_by_others(const Device& device) const {
    return whole.buses[device.bus].is_shared ? device.spoilt : 0;
  }

  // What other programs that share the bus may cost a unit: once their share of the time, and what
  // they had not used before; where they have asked in vain what would be asked of it, nobody asks
  // it the same for so long; and once what a third one answers them too late spoils its answer.
  Duration others_cost(std::size_t bus) const {
    return whole.buses[bus].is_shared ? std::chrono::seconds(15) + running.interval * 3 / 2
                                      : Duration{};
  }

  Position free_place();
  Device& add(std::size_t bus, std::uint8_t unit, Instant now);
  // Another one in its place, or beside it at the same unit.
  Device& replace(Device& device, Instant now);
  Device& add_twin(Device& device, Instant now);
  void remove_twins(Instant now);
  // Another one answers at the same unit.
  bool is_doubled(const Device& device) const;
  // Null: there is none.
  Device* find(std::uint32_t serial) const;

  // The gateway asks it, by the settings that hold.
  bool is_asked(const Device& device) const { return running.asks(device.bus, device.unit); }

  // Where a device is in the mesh that says to be there, and what it must have said to be there in
  // the mesh; none: nothing does it. Ours count in units of the mesh.
  Position in_mesh(const Device& device, Position said) const;
  std::optional<Position> said_for(const Device& device, Position in_mesh) const;

  // Where a gateway finds its settings.
  std::string path() const { return folder_of_file_.path("gateway.toml"); }
  void write_file() const { write_file(file.text()); }
  void write_file(const std::string& text) const {
    static_cast<void>(folder_of_file_.write("gateway.toml", text));
  }
  void draw_times(SiteFile& of);
  void draw_plane(SiteFile& of);
  void draw_features(SiteFile& of);

  inputs::Random& random;
  inputs::Random for_later;  // what came later: lives are what they were before
  bool has_other_makes = false;
  bool is_small = false;  // there is no room for all
  SiteFile whole;         // with all that there is
  SiteFile file;          // as it stands on the disk
  SiteFile running;       // what of it must hold by now
  std::vector<std::unique_ptr<Device>> devices;
  std::vector<BusWorld> buses;
  DiskWorld disk;
  DiskWorld disk_of_alarms;  // another folder of it
  FolderWorld folder;
  Instant faults_ended_at{};
  // Others have its unit too.
  std::vector<Device*> twins;

 private:
  void open_bus(std::size_t number, std::uint8_t units, Make first_make);

  test::ScratchFolder folder_of_file_;
  static constexpr std::uint32_t first_serial = 1001;
  std::uint32_t next_serial_ = first_serial;
  std::vector<Position> places_;
};

}  // namespace etcm::simulation
