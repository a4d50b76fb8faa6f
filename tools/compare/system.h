// The systems side by side: what is common to them is in rival.h, what is theirs in a file each.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "compare/attempt.h"

namespace etcm::compare {

struct System {
  std::string_view key;    // on the command line and in CSV
  std::string_view label;  // for people
  Attempt (*run)(const inputs::Graph& graph, Depth depth);
  bool conforms = true;  // false: the constrained mesh, which is the baseline of equation (3)
};

// All of them, in the order of the paper, then ours, then the outside peers.
std::span<const System> all_systems() noexcept;

// The key of the constrained Delaunay mesh, and of ours.
inline constexpr std::string_view constrained_key = "constrained";
inline constexpr std::string_view ours_key = "default";

// Those with these keys, in the order of all_systems(); all where there is no key. Throws
// std::invalid_argument naming what is no key.
std::vector<System> systems_named(std::span<const std::string> keys);

// tsai.cpp: Tsai 1993, [15] of the paper.
Attempt run_tsai(const inputs::Graph& graph, Depth depth);
// lu.cpp: Lu, Wu, Zhou 1997, [13], reconstructed.
Attempt run_lu(const inputs::Graph& graph, Depth depth);
// sapidis_perucchio.cpp: Sapidis and Perucchio 1991, [14].
Attempt run_sapidis_perucchio(const inputs::Graph& graph, Depth depth);
// wei.cpp: Wei, Xiao, Zhou 2001, [17]; "Mei" in the paper's text.
Attempt run_wei(const inputs::Graph& graph, Depth depth);
// etcm_paper.cpp: the paper's own.
Attempt run_etcm(const inputs::Graph& graph, Depth depth);
// ours.cpp: this library as its users get it.
Attempt run_default(const inputs::Graph& graph, Depth depth);
// cgal_peers.cpp: CGAL's conforming and its constrained Delaunay triangulation, kernel EPICK.
Attempt run_cgal_conforming(const inputs::Graph& graph, Depth depth);
Attempt run_cgal_constrained(const inputs::Graph& graph, Depth depth);

}  // namespace etcm::compare
