// The systems side by side: what is common to them is in rival.h, what is theirs in a file each.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "compare/systems/attempt.h"

namespace etcm::compare {

struct System {
  std::string_view key;    // on the command line and in CSV
  std::string_view label;  // for people
  Attempt (*run)(const inputs::Graph& graph, Depth depth);
  bool conforms = true;  // false: the constrained mesh, which is the baseline of equation (3)
};

// All of them, in the order of the paper, then ours, then the outside peers.
std::span<const System> all_systems() noexcept;
// What a system of the paper would be if what the paper leaves open were read otherwise; and the
// library's policy `paper`.
std::span<const System> other_readings() noexcept;

// The key of the constrained Delaunay mesh, of ours, and of ETCM word for word.
inline constexpr std::string_view constrained_key = "constrained";
inline constexpr std::string_view ours_key = "default";
inline constexpr std::string_view etcm_key = "etcm";

// Those with these keys, in the order of all_systems(), then of other_readings(); all_systems()
// where there is no key. Throws std::invalid_argument naming what is no key.
std::vector<System> systems_named(std::span<const std::string> keys);

// All keys, with a comma between.
std::string known_keys();

// tsai.cpp: Tsai 1993, [15] of the paper; one crossing at a time.
Attempt run_tsai(const inputs::Graph& graph, Depth depth);
Attempt run_tsai_one(const inputs::Graph& graph, Depth depth);
// lu.cpp: Lu, Wu, Zhou 1997, [13]; what else was tried for it.
Attempt run_lu(const inputs::Graph& graph, Depth depth);
Attempt run_lu_half(const inputs::Graph& graph, Depth depth);
Attempt run_lu_each(const inputs::Graph& graph, Depth depth);
Attempt run_lu_spacing(const inputs::Graph& graph, Depth depth);
Attempt run_lu_gap(const inputs::Graph& graph, Depth depth);
Attempt run_lu_gap_middle(const inputs::Graph& graph, Depth depth);
Attempt run_lu_foot(const inputs::Graph& graph, Depth depth);
Attempt run_lu_crossing(const inputs::Graph& graph, Depth depth);
Attempt run_lu_far(const inputs::Graph& graph, Depth depth);
// sapidis_perucchio.cpp: Sapidis and Perucchio 1991, [14]; diametral.cpp: until all diametral
// circles are empty.
Attempt run_sapidis_perucchio(const inputs::Graph& graph, Depth depth);
Attempt run_diametral(const inputs::Graph& graph, Depth depth);
// wei.cpp: Wei, Xiao, Zhou 2001, [17], "Mei" in the paper's text; never finishing in the overlap.
Attempt run_wei(const inputs::Graph& graph, Depth depth);
Attempt run_wei_first_circle(const inputs::Graph& graph, Depth depth);
// etcm_literal.cpp: the paper's own; with broken features on a stack.
Attempt run_etcm(const inputs::Graph& graph, Depth depth);
Attempt run_etcm_stack(const inputs::Graph& graph, Depth depth);
// ours.cpp: this library as its users get it; its build with the policy `paper`.
Attempt run_default(const inputs::Graph& graph, Depth depth);
Attempt run_paper_policy(const inputs::Graph& graph, Depth depth);
// cgal_peers.cpp: CGAL's conforming and its constrained Delaunay triangulation, kernel EPICK.
Attempt run_cgal_conforming(const inputs::Graph& graph, Depth depth);
Attempt run_cgal_constrained(const inputs::Graph& graph, Depth depth);

}  // namespace etcm::compare
