// What the gateway shows over HTTP: the page and its data, metrics, health.
//
// Everything is made while it is read (document.h). A reader of the mesh or of readings has one
// state of them to the end: it is kept for as long as somebody reads it. There are two such places;
// when slow readers hold both, others get the state that is in the newer one.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "etcm/port/web_site.h"
#include "firmware/status/alarms_document.h"
#include "firmware/status/bus_meter.h"
#include "firmware/status/csv_documents.h"
#include "firmware/status/document_reader.h"
#include "firmware/status/features_document.h"
#include "firmware/status/mesh_document.h"
#include "firmware/status/metrics_document.h"
#include "firmware/status/readings_document.h"
#include "firmware/status/status_document.h"
#include "firmware/status/status_sources.h"
#include "firmware/status/units_document.h"

namespace etcm::firmware {

class StatusPage final : public port::WebSite {
 public:
  // All the memory it ever needs is taken here.
  StatusPage(const StatusSources& sources, std::uint32_t readers_max);

  // Lets time pass: what readers get is of this instant.
  void advance(port::Instant now);
  port::Instant next_deadline() const { return meter_.next_deadline(); }

  port::WebAnswer begin(std::size_t reader, std::string_view path) override;
  std::size_t read(std::size_t reader, std::span<char> out) override {
    return readers_[reader].read(out);
  }
  void end(std::size_t reader) override;

 private:
  struct Reader : DocumentReader {
    std::size_t kept = no_kept;            // the place of the snapshots it reads
    std::shared_ptr<const SitePlan> plan;  // that it reads
  };
  struct Kept {
    Kept(const MeshConfig& config, const Poller& poller, std::uint64_t instance)
        : mesh(config),
          in_degrees(mesh, poller, instance, MeshDocument::Frame::degrees),
          in_plane(mesh, poller, instance, MeshDocument::Frame::plane),
          readings_document(mesh.snapshot, mesh.readings, instance) {}
    Kept(const Kept&) = delete;
    Kept& operator=(const Kept&) = delete;
    ShownMesh mesh;
    MeshDocument in_degrees;
    MeshDocument in_plane;
    ReadingsDocument readings_document;
    std::uint32_t readers = 0;
  };
  static constexpr std::size_t no_kept = ~std::size_t{0};

  port::WebAnswer show(Reader& reader, std::string_view text, std::uint16_t status);
  port::WebAnswer show(Reader& reader, const Document& document, const char* media_type);
  port::WebAnswer show_mesh(Reader& reader);
  port::WebAnswer show_geojson(Reader& reader);
  port::WebAnswer show_readings(Reader& reader);
  port::WebAnswer show_plan(Reader& reader);
  port::WebAnswer show_health(Reader& reader);
  Kept& keep_newest(Reader& reader);
  std::size_t newest_place();

  const StatusSources sources_;
  BusMeter meter_;
  StatusDocument status_;
  AgesDocument ages_;
  UnitsDocument units_;
  FeaturesDocument features_;
  NodesCsv nodes_csv_;
  UnitsCsv units_csv_;
  EventsCsv events_csv_;
  AlarmsDocument alarms_;
  AlarmsDocument ended_;
  AlarmsDocument history_;
  AlarmsCsv alarms_csv_;
  MetricsDocument metrics_;
  std::array<Kept, 2> kept_;
  std::vector<Reader> readers_;
  port::Instant now_{};
};

}  // namespace etcm::firmware
