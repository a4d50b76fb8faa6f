#include "firmware/status/status_page.h"

#include <algorithm>
#include <cstring>

#include "firmware/publish/snapshot_taker.h"
#include "firmware/status/health.h"
#include "firmware/status/page_files.h"

namespace etcm::firmware {

namespace {

constexpr const char* json_media_type = "application/json";

// Two runs of the gateway count the same generations, of different meshes.
std::uint64_t version_of(std::uint64_t instance, std::uint32_t generation) {
  const std::uint64_t mixed = (instance ^ generation) * 0x9e3779b97f4a7c15u;
  return (mixed ^ mixed >> 32) | 1;
}

}  // namespace

StatusPage::StatusPage(const StatusSources& sources, std::uint32_t readers_max)
    : sources_(sources),
      meter_(sources.gateway.poller()),
      status_(sources_, meter_),
      ages_(sources_),
      metrics_(sources_, meter_),
      kept_{Kept(sources.gateway.poller(), instance_of(sources)),
            Kept(sources.gateway.poller(), instance_of(sources))},
      readers_(readers_max),
      now_(sources.started_at) {
  for (Kept& kept : kept_) {
    reserve(kept.snapshot, sources.gateway.settings(),
            static_cast<std::uint32_t>(sources.gateway.nodes().records().size()));
  }
}

void StatusPage::advance(port::Instant now) {
  now_ = now;
  meter_.advance(now);
}

port::WebAnswer StatusPage::begin(std::size_t number, std::string_view path) {
  Reader& reader = readers_[number];
  reader.document = nullptr;
  reader.cursor = {};
  reader.asked_at = now_;
  reader.kept = no_kept;
  if (path == "/mesh.geojson") return show_mesh(reader, MeshDocument::Frame::degrees);
  if (path == "/mesh.json") return show_mesh(reader, MeshDocument::Frame::plane);
  if (path == "/status.json") return show(reader, status_, json_media_type);
  if (path == "/ages.json") return show(reader, ages_, json_media_type);
  if (path == "/metrics") return show(reader, metrics_, metrics_media_type);
  if (path == "/healthz") return show_health(reader);
  const auto files = page_files();
  const auto file = std::find_if(files.begin(), files.end(),
                                 [&](const PageFile& known) { return known.path == path; });
  if (file == files.end()) {
    return show(reader, "there is no such page; the status page is /\n",
                port::web_status::not_found);
  }
  reader.rest = file->content;
  return {.media_type = file->media_type, .version = file->version};
}

std::size_t StatusPage::read(std::size_t number, std::span<char> out) {
  Reader& reader = readers_[number];
  std::size_t size = 0;
  while (size < out.size()) {
    if (reader.rest.empty()) {
      if (reader.document == nullptr) break;
      TextWriter piece(reader.piece);
      if (!reader.document->write_next(reader.cursor, reader.asked_at, piece)) break;
      reader.rest = piece.text();
    }
    const std::size_t count = std::min(reader.rest.size(), out.size() - size);
    std::memcpy(out.data() + size, reader.rest.data(), count);
    reader.rest.remove_prefix(count);
    size += count;
  }
  return size;
}

void StatusPage::end(std::size_t number) {
  Reader& reader = readers_[number];
  if (reader.kept != no_kept) --kept_[reader.kept].readers;
  reader.kept = no_kept;
}

port::WebAnswer StatusPage::show(Reader& reader, std::string_view text, std::uint16_t status) {
  reader.rest = text;
  return {.status = status};
}

port::WebAnswer StatusPage::show(Reader& reader, const Document& document, const char* media_type) {
  reader.document = &document;
  reader.rest = {};
  return {.media_type = media_type};
}

port::WebAnswer StatusPage::show_mesh(Reader& reader, MeshDocument::Frame frame) {
  reader.kept = keep_newest();
  Kept& kept = kept_[reader.kept];
  ++kept.readers;
  const bool is_geojson = frame == MeshDocument::Frame::degrees;
  port::WebAnswer answer = is_geojson ? show(reader, kept.in_degrees, "application/geo+json")
                                      : show(reader, kept.in_plane, json_media_type);
  answer.version = version_of(instance_of(sources_), kept.snapshot.generation);
  return answer;
}

port::WebAnswer StatusPage::show_health(Reader& reader) {
  TextWriter reason(reader.piece);
  if (is_healthy(sources_, now_, reason)) return show(reader, "ok\n", port::web_status::ok);
  reason << "\n";
  return show(reader, reason.text(), port::web_status::unavailable);
}

// The place with the newest generation that a new reader can have.
std::size_t StatusPage::keep_newest() {
  const Snapshot& newest = sources_.gateway.snapshot();
  const std::size_t newer = kept_[0].snapshot.generation >= kept_[1].snapshot.generation ? 0 : 1;
  if (kept_[newer].snapshot.generation == newest.generation) return newer;
  for (std::size_t place : {1 - newer, newer}) {
    if (kept_[place].readers > 0) continue;
    kept_[place].snapshot = newest;
    kept_[place].plane = sources_.gateway.settings().site.plane();
    return place;
  }
  return newer;
}

}  // namespace etcm::firmware
