// The five criteria for one system on one graph.
#pragma once

#include <chrono>
#include <cstdint>

#include "compare/systems/system.h"

namespace etcm::compare {

// Goes through a pipe: no pointers.
struct Measurement {
  Verdict verdict = Verdict::not_ended;
  std::uint32_t added = 0;
  std::uint32_t added_after_pruning = 0;
  // The fastest of some repeats, which no other program on the machine has slowed down: the nodes
  // Processor time, the least of some repeats: the nodes alone, and what nodes and features
  // together take beyond that.
  double delaunay_us = 0;
  double features_us = 0;
  double edge_ratio = 0;    // AAR: mean of shortest over longest edge
  double radius_ratio = 0;  // mean of inradius over circumradius
  bool survives_exchange = false;
  bool survives_shuffle = false;
};

// Runs in a process of its own, so that a system that hangs or dies costs its row only.
Measurement measure(const System& system, const inputs::Graph& graph,
                    std::chrono::milliseconds limit);

// The AAR of the nodes' Delaunay mesh, which no system can spoil.
files::Quality delaunay_quality(const inputs::Graph& graph);

// Equation (3) of the paper; 0 where nothing was added.
double gain_per_point(double refined, double constrained, std::uint32_t added);

}  // namespace etcm::compare
