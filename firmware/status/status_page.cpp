#include "firmware/status/status_page.h"

#include <algorithm>

#include "firmware/publish/snapshot_taker.h"
#include "firmware/status/health.h"
#include "firmware/status/page_files.h"

namespace etcm::firmware {

namespace {

constexpr const char* json_media_type = "application/json";

// Two runs of the gateway count the same generations and sequences, of different content.
std::uint64_t version_of(std::uint64_t instance, std::uint32_t generation,
                         std::uint32_t value_sequence) {
  const std::uint64_t both = std::uint64_t{generation} << 32 | value_sequence;
  const std::uint64_t mixed = (instance ^ both) * 0x9e3779b97f4a7c15u;
  return (mixed ^ mixed >> 32) | 1;
}

}  // namespace

StatusPage::StatusPage(const StatusSources& sources, std::uint32_t readers_max)
    : sources_(sources),
      meter_(sources.gateway.poller()),
      status_(sources_, meter_),
      ages_(sources_),
      units_(sources_),
      features_(sources_),
      nodes_csv_(sources_),
      units_csv_(sources_),
      events_csv_(sources_),
      alarms_(sources_.alarms, sources_.wall_clock, AlarmsShown::open, &sources_.gateway),
      ended_(sources_.alarms, sources_.wall_clock, AlarmsShown::ended_of_late, &sources_.gateway),
      history_(sources_.alarms, sources_.wall_clock, AlarmsShown::all, &sources_.gateway),
      alarms_csv_(sources_.alarms, sources_.wall_clock),
      metrics_(sources_, meter_),
      kept_{Kept(sources.gateway.settings().mesh, sources.gateway.poller(), instance_of(sources)),
            Kept(sources.gateway.settings().mesh, sources.gateway.poller(), instance_of(sources))},
      readers_(readers_max),
      now_(sources.started_at) {
  for (Kept& kept : kept_) {
    reserve(kept.mesh.snapshot, sources.gateway.settings(),
            static_cast<std::uint32_t>(sources.gateway.nodes().records().size()));
    reserve(kept.mesh.readings, sources.gateway.settings());
  }
}

void StatusPage::advance(port::Instant now) {
  now_ = now;
  meter_.advance(now);
}

port::WebAnswer StatusPage::begin(std::size_t number, std::string_view path) {
  Reader& reader = readers_[number];
  reader.begin(now_);
  reader.kept = no_kept;
  if (path == "/mesh.geojson") return show_geojson(reader);
  if (path == "/mesh.json") return show_mesh(reader);
  if (path == "/readings.json") return show_readings(reader);
  if (path == "/status.json") return show(reader, status_, json_media_type);
  if (path == "/ages.json") return show(reader, ages_, json_media_type);
  if (path == "/units.json") return show(reader, units_, json_media_type);
  if (path == "/features.json") return show(reader, features_, json_media_type);
  if (path == "/nodes.csv") return show(reader, nodes_csv_, csv_media_type);
  if (path == "/units.csv") return show(reader, units_csv_, csv_media_type);
  if (path == "/events.csv") return show(reader, events_csv_, csv_media_type);
  if (path == "/alarms.json") return show(reader, alarms_, json_media_type);
  if (path == "/ended.json") return show(reader, ended_, json_media_type);
  if (path == "/history.json") return show(reader, history_, json_media_type);
  if (path == "/alarms.csv") return show(reader, alarms_csv_, csv_media_type);
  if (path == "/metrics") return show(reader, metrics_, metrics_media_type);
  if (path == "/plan") return show_plan(reader);
  if (path == "/healthz") return show_health(reader);
  const auto files = page_files();
  const auto file = std::find_if(files.begin(), files.end(),
                                 [&](const PageFile& known) { return known.path == path; });
  if (file == files.end()) {
    return show(reader, "there is no such page; the status page is /\n",
                port::web_status::not_found);
  }
  reader.show(file->content);
  return {.media_type = file->media_type, .version = file->version};
}

void StatusPage::end(std::size_t number) {
  Reader& reader = readers_[number];
  if (reader.kept != no_kept) --kept_[reader.kept].readers;
  reader.kept = no_kept;
  reader.plan.reset();
}

port::WebAnswer StatusPage::show(Reader& reader, std::string_view text, std::uint16_t status) {
  reader.show(text);
  return {.status = status};
}

port::WebAnswer StatusPage::show(Reader& reader, const Document& document, const char* media_type) {
  reader.show(document);
  return {.media_type = media_type};
}

port::WebAnswer StatusPage::show_mesh(Reader& reader) {
  const Kept& kept = keep_newest(reader);
  port::WebAnswer answer = show(reader, kept.in_plane, json_media_type);
  answer.version = version_of(instance_of(sources_), kept.mesh.snapshot.generation, 0);
  return answer;
}

port::WebAnswer StatusPage::show_geojson(Reader& reader) {
  const Kept& kept = keep_newest(reader);
  port::WebAnswer answer = show(reader, kept.in_degrees, "application/geo+json");
  answer.version = version_of(instance_of(sources_), kept.mesh.snapshot.generation,
                              kept.mesh.readings.value_sequence);
  return answer;
}

port::WebAnswer StatusPage::show_readings(Reader& reader) {
  return show(reader, keep_newest(reader).readings_document, json_media_type);
}

port::WebAnswer StatusPage::show_health(Reader& reader) {
  TextWriter reason = reader.writer();
  if (is_healthy(sources_, now_, reason)) return show(reader, "ok\n", port::web_status::ok);
  reason << "\n";
  return show(reader, reason.text(), port::web_status::unavailable);
}

// A reload may bring another while it is read.
port::WebAnswer StatusPage::show_plan(Reader& reader) {
  reader.plan = sources_.gateway.settings().site.plan;
  if (reader.plan == nullptr) {
    return show(reader, "the site has no plan; name one by 'plan' in [site]\n",
                port::web_status::not_found);
  }
  reader.show(reader.plan->bytes);
  return {.media_type = reader.plan->media_type, .version = reader.plan->version};
}

StatusPage::Kept& StatusPage::keep_newest(Reader& reader) {
  reader.kept = newest_place();
  Kept& kept = kept_[reader.kept];
  ++kept.readers;
  return kept;
}

// The place with the newest state that a new reader can have. Each generation has a sequence of its
// own.
std::size_t StatusPage::newest_place() {
  const Snapshot& mesh = sources_.gateway.snapshot();
  const ReadingSnapshot& readings = sources_.gateway.readings();
  const std::size_t newer =
      kept_[0].mesh.readings.sequence >= kept_[1].mesh.readings.sequence ? 0 : 1;
  if (kept_[newer].mesh.readings.sequence == readings.sequence) return newer;
  for (std::size_t place : {1 - newer, newer}) {
    Kept& kept = kept_[place];
    if (kept.readers > 0) continue;
    if (kept.mesh.snapshot.generation != mesh.generation) {
      kept.mesh.snapshot = mesh;
      kept.mesh.domain.label(kept.mesh.snapshot);
    }
    kept.mesh.readings = readings;
    kept.mesh.plane = sources_.gateway.settings().site.plane();
    return place;
  }
  return newer;
}

}  // namespace etcm::firmware
