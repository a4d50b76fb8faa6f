#include "conformity.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "coverage.h"
#include "etcm/files/decimal.h"
#include "etcm/predicates.h"

namespace etcm::cli {

namespace {

using Violation = std::optional<std::string>;

Violation check_nodes(const Claim& claim) {
  const auto& vertices = claim.image.vertices;
  if (vertices.size() < claim.grid.nodes.size()) {
    return "the mesh has " + std::to_string(vertices.size()) + " vertices, the input " +
           std::to_string(claim.grid.nodes.size()) + " nodes";
  }
  if (!claim.grid.nodes.empty() && claim.image.index_base != claim.graph.index_base) {
    return "the mesh counts from " + std::to_string(claim.image.index_base) + ", the input from " +
           std::to_string(claim.graph.index_base);
  }
  for (std::size_t i = 0; i < claim.grid.nodes.size(); ++i) {
    const Point expected = to_point(claim.grid.nodes[i]);
    if (vertices[i].point == expected) continue;
    return claim.vertex(i) + " stands at " + files::coordinate_text(vertices[i].point.x) + " " +
           files::coordinate_text(vertices[i].point.y) + ", but the input node at " +
           files::coordinate_text(expected.x) + " " + files::coordinate_text(expected.y);
  }
  return std::nullopt;
}

Violation check_distinct(const Claim& claim) {
  const auto& vertices = claim.image.vertices;
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return vertices[a].point < vertices[b].point;
  });
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (vertices[order[i]].point == vertices[order[i - 1]].point) {
      return claim.vertex(order[i - 1]) + " and " + claim.vertex(order[i]) +
             " stand at the same place";
    }
  }
  return std::nullopt;
}

// Follows each feature along the subsegments.
class FeatureChains {
 public:
  explicit FeatureChains(const Claim& claim)
      : claim_(claim),
        used_(claim.image.subsegments.size(), false),
        reached_(claim.image.vertices.size(), false) {
    const auto& subsegments = claim.image.subsegments;
    for (std::uint32_t i = 0; i < subsegments.size(); ++i) {
      ends_.push_back({subsegments[i].from, subsegments[i].to, i});
      ends_.push_back({subsegments[i].to, subsegments[i].from, i});
    }
    std::sort(ends_.begin(), ends_.end());
  }

  Violation check() {
    const auto& subsegments = claim_.image.subsegments;
    for (std::size_t i = 1; i < ends_.size(); ++i) {
      if (ends_[i][0] == ends_[i - 1][0] && ends_[i][1] == ends_[i - 1][1]) {
        return "subsegment " + claim_.edge(ends_[i][0], ends_[i][1]) + " is there twice";
      }
    }
    for (std::size_t feature = 0; feature < claim_.graph.features.size(); ++feature) {
      if (Violation violation = follow(feature)) return violation;
    }
    for (std::size_t i = 0; i < subsegments.size(); ++i) {
      if (!used_[i]) {
        return "subsegment " + claim_.edge(subsegments[i].from, subsegments[i].to) +
               " lies on no feature of the input";
      }
      if (!subsegments[i].is_edge) {
        return "subsegment " + claim_.edge(subsegments[i].from, subsegments[i].to) + " is no edge";
      }
    }
    for (std::size_t i = claim_.grid.nodes.size(); i < reached_.size(); ++i) {
      if (!reached_[i]) return "the added " + claim_.vertex(i) + " lies on no feature of the input";
    }
    return std::nullopt;
  }

 private:
  using End = std::array<std::uint32_t, 3>;  // at this vertex, to that one, index of the subsegment

  const Point& point(std::uint32_t vertex) const { return claim_.image.vertices[vertex].point; }

  // On the line from -> to, the lexicographic order is the order along it.
  static bool is_ahead(const Point& from, const Point& to, const Point& here, const Point& next) {
    return from < to ? here < next && next <= to : here > next && next >= to;
  }

  Violation follow(std::size_t feature) {
    const std::uint32_t from = claim_.graph.features[feature].from;
    const std::uint32_t to = claim_.graph.features[feature].to;
    std::uint32_t here = from;
    while (here != to) {
      auto end = std::lower_bound(ends_.begin(), ends_.end(), End{here, 0, 0});
      while (end != ends_.end() && (*end)[0] == here && !continues(*end, from, to)) ++end;
      if (end == ends_.end() || (*end)[0] != here) {
        return files::feature_name(claim_.graph, feature) + " breaks off at " +
               claim_.vertex(here) + ": no subsegment leads on along it";
      }
      if (used_[(*end)[2]]) {
        return files::feature_name(claim_.graph, feature) + " and another share subsegment " +
               claim_.edge(here, (*end)[1]);
      }
      used_[(*end)[2]] = true;
      here = (*end)[1];
      reached_[here] = true;
    }
    return std::nullopt;
  }

  bool continues(const End& end, std::uint32_t from, std::uint32_t to) const {
    return orient2d(point(from), point(to), point(end[1])) == 0 &&
           is_ahead(point(from), point(to), point(end[0]), point(end[1]));
  }

  const Claim& claim_;
  std::vector<End> ends_;
  std::vector<bool> used_;
  std::vector<bool> reached_;
};

// The .edge file must say what the others say.
Violation check_edges(const Claim& claim) {
  using Ends = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Ends> features;
  std::vector<Ends> all;
  const auto ends = [](std::uint32_t a, std::uint32_t b) {
    return Ends(std::min(a, b), std::max(a, b));
  };
  for (const auto& subsegment : claim.image.subsegments) {
    features.push_back(ends(subsegment.from, subsegment.to));
  }
  all = features;
  for (const auto& corner : claim.image.triangles) {
    for (std::size_t i = 0; i < 3; ++i) all.push_back(ends(corner[i], corner[(i + 1) % 3]));
  }
  std::sort(features.begin(), features.end());
  std::sort(all.begin(), all.end());
  // Without triangles the mesh is a path through its collinear vertices.
  const bool is_path = claim.image.triangles.empty();
  for (const auto& edge : claim.image.edges) {
    const Ends key(edge.from, edge.to);
    if (!is_path && !std::binary_search(all.begin(), all.end(), key)) {
      return claim.edge(edge.from, edge.to) + " belongs to no triangle and no feature";
    }
    if (std::binary_search(features.begin(), features.end(), key) != edge.is_constrained) {
      return claim.edge(edge.from, edge.to) + (edge.is_constrained
                                                   ? " is marked as part of a feature, but is none"
                                                   : " is part of a feature, but not marked");
    }
  }
  for (const Ends& key : all) {
    if (files::find_edge(claim.image, key.first, key.second) == claim.image.edges.size()) {
      return claim.edge(key.first, key.second) + " is missing from the list of edges";
    }
  }
  return std::nullopt;
}

}  // namespace

std::string Claim::vertex(std::size_t index) const {
  return "vertex " + std::to_string(static_cast<std::int64_t>(index) + image.index_base);
}

std::string Claim::triangle(std::size_t index) const {
  std::string text =
      "triangle " + std::to_string(static_cast<std::int64_t>(index) + image.index_base) + " (";
  for (std::size_t i = 0; i < 3; ++i) {
    if (i > 0) text += ' ';
    text += std::to_string(std::int64_t{image.triangles[index][i]} + image.index_base);
  }
  return text + ")";
}

std::string Claim::edge(std::size_t from, std::size_t to) const {
  return "edge " + std::to_string(static_cast<std::int64_t>(from) + image.index_base) + "-" +
         std::to_string(static_cast<std::int64_t>(to) + image.index_base);
}

std::optional<std::string> first_violation(const Claim& claim) {
  if (Violation violation = check_nodes(claim)) return violation;
  if (Violation violation = check_distinct(claim)) return violation;
  if (Violation violation = FeatureChains(claim).check()) return violation;
  if (Violation violation = check_edges(claim)) return violation;
  return first_triangle_violation(claim);
}

}  // namespace etcm::cli
