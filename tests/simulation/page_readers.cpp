#include "page_readers.h"

#include <algorithm>
#include <set>
#include <utility>

namespace etcm::simulation {

namespace {

constexpr std::array<std::string_view, 10> paths{
    "/healthz", "/status.json", "/mesh.geojson", "/units.json", "/alarms.json",
    "/metrics", "/mesh.json",   "/nodes.csv",    "/ages.json",  "/features.json"};
constexpr std::size_t piece_max = 4096;

}  // namespace

void PageReaders::begin(std::size_t number, inputs::Random& random) {
  Reader& reader = readers_[number];
  reader.path = paths[random.index(paths.size())];
  reader.text.clear();
  reader.status = page_.begin(number, reader.path).status;
}

bool PageReaders::read_piece(std::size_t number, std::size_t bytes) {
  std::array<char, piece_max> piece;
  const std::size_t size = page_.read(number, std::span(piece).first(bytes));
  readers_[number].text.append(piece.data(), size);
  return size > 0;
}

// Of one mesh: whoever is somebody's neighbour is there, and has that one.
std::string PageReaders::look_at_mesh(const nlohmann::json& document) {
  std::set<std::pair<int, int>> edges;
  for (const nlohmann::json& feature : document["features"]) {
    if (!feature.contains("id")) continue;
    const int id = feature["id"];
    for (const int neighbour : feature["properties"]["neighbours"]) edges.emplace(id, neighbour);
  }
  for (const auto& [from, to] : edges) {
    if (!edges.contains({to, from})) {
      return "/mesh.json has " + std::to_string(from) + " beside " + std::to_string(to) +
             ", and not the other way round";
    }
  }
  return {};
}

std::string PageReaders::end(std::size_t number) {
  page_.end(number);
  Reader& reader = readers_[number];
  const std::string path(reader.path);
  reader.path = {};
  if (reader.status != 200 && reader.status != 503) {
    return path + " answers " + std::to_string(reader.status);
  }
  if (path.find("json") != std::string::npos) {
    const nlohmann::json document = nlohmann::json::parse(reader.text, nullptr, false);
    if (document.is_discarded()) return path + " is no JSON";
    if (path == "/mesh.json") return look_at_mesh(document);
  }
  return reader.text.empty() ? path + " is empty" : std::string();
}

std::string PageReaders::read_whole(inputs::Random& random) {
  for (std::size_t number = 0; number < count_max; ++number) {
    if (!readers_[number].path.empty()) continue;
    begin(number, random);
    while (read_piece(number, piece_max)) {
    }
    return end(number);
  }
  return {};
}

void PageReaders::come(std::size_t count, inputs::Random& random) {
  for (std::size_t number = 0; number < count_max && count > 0; ++number) {
    if (!readers_[number].path.empty()) continue;
    begin(number, random);
    --count;
  }
}

bool PageReaders::is_there() const {
  return std::ranges::any_of(readers_, [](const Reader& reader) { return !reader.path.empty(); });
}

std::string PageReaders::read_on(inputs::Random& random) {
  std::string wrong;
  for (std::size_t number = 0; number < count_max; ++number) {
    if (readers_[number].path.empty() || random.below(30) != 0) continue;
    if (random.below(50) == 0) {
      page_.end(number);
      readers_[number].path = {};
      continue;
    }
    if (read_piece(number, 1 + random.index(piece_max / 4))) continue;
    std::string of_this = end(number);
    if (wrong.empty()) wrong = std::move(of_this);
  }
  return wrong;
}

}  // namespace etcm::simulation
