#include "report.h"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdio>

#include "etcm/files/decimal.h"
#include "lower_bound.h"

namespace etcm::cli {

namespace {

std::string fixed(double value, int digits) {
  std::array<char, 64> buffer;
  std::snprintf(buffer.data(), buffer.size(), "%.*f", digits, value);
  return buffer.data();
}

std::string hex16(std::uint64_t value) {
  std::array<char, 17> buffer;
  std::snprintf(buffer.data(), buffer.size(), "%016" PRIx64, value);
  return buffer.data();
}

// The memory a MeshStorage needs that holds this mesh and nothing more.
std::size_t bytes_of(const files::MeshImage& image) {
  const auto segments = std::count_if(
      image.subsegments.begin(), image.subsegments.end(),
      [&](const auto& subsegment) { return !image.vertices[subsegment.to].is_steiner; });
  return storage_bytes(static_cast<std::uint32_t>(image.vertices.size()),
                       static_cast<std::uint32_t>(segments));
}

}  // namespace

std::string json_number(double value) {
  std::string text;
  files::TextSink(text) << value;
  return text;
}

std::string json_object(const Members& members) {
  std::string text = "{";
  const char* separator = "";
  for (const auto& [name, value] : members) {
    text += separator + ("\"" + name) + "\":" + value;
    separator = ",";
  }
  return text + "}\n";
}

Members describe_mesh(const Meshed& meshed, const files::MeshImage& image, std::uint64_t least,
                      const std::string& policy) {
  const Mesh& mesh = **meshed.mesh;
  const files::Quality quality = files::quality_of(image);
  const std::size_t bytes = bytes_of(image);
  const auto vertices = static_cast<double>(std::max<std::size_t>(1, image.vertices.size()));
  return {{"nodes", std::to_string(mesh.node_count())},
          {"features", std::to_string(mesh.feature_count())},
          {"steiner", std::to_string(mesh.steiner_count())},
          {"least_steiner", std::to_string(least)},
          {"triangles", std::to_string(image.triangles.size())},
          {"unresolved", std::to_string(mesh.unresolved())},
          {"dt_us", fixed(meshed.delaunay_us, 1)},
          {"conform_us", fixed(meshed.conform_us, 1)},
          {"optimise_us", fixed(meshed.optimise_us, 1)},
          {"bytes", std::to_string(bytes)},
          {"bytes_per_vertex", fixed(static_cast<double>(bytes) / vertices, 2)},
          {"mean_edge_ratio", json_number(quality.mean_edge_ratio)},
          {"mean_radius_ratio", json_number(quality.mean_radius_ratio)},
          {"mesh_hash", "\"" + hex16(mesh.hash()) + "\""},
          {"policy", "\"" + policy + "\""}};
}

std::string summary(const Meshed& meshed, const files::MeshImage& image, std::uint64_t least) {
  const Mesh& mesh = **meshed.mesh;
  const files::Quality quality = files::quality_of(image);
  const auto counted = [](std::size_t count, const char* one, const char* many) {
    return std::to_string(count) + " " + (count == 1 ? one : many);
  };
  return counted(mesh.node_count(), "node", "nodes") + ", " +
         counted(mesh.feature_count(), "feature", "features") + ": " +
         counted(mesh.steiner_count(), "Steiner vertex", "Steiner vertices") + " (" +
         describe_bound(least, mesh.steiner_count()) + "), " +
         counted(image.triangles.size(), "triangle", "triangles") + " in " +
         fixed((meshed.delaunay_us + meshed.conform_us + meshed.optimise_us) / 1000, 2) +
         " ms (Delaunay " + fixed(meshed.delaunay_us / 1000, 2) + ", conforming " +
         fixed(meshed.conform_us / 1000, 2) +
         (meshed.optimise_us != 0 ? ", looking for fewer " + fixed(meshed.optimise_us / 1000, 2)
                                  : "") +
         "); mean edge ratio " + fixed(quality.mean_edge_ratio, 3) + ", hash " +
         hex16(mesh.hash()) + "\n";
}

}  // namespace etcm::cli
