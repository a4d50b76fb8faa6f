#include "bench/corpus_table.h"

#include <chrono>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <optional>
#include <ostream>
#include <sstream>
#include <string>

#include "bench/cgal_peer.h"
#include "bench/limited.h"
#include "etcm/audit.h"
#include "inputs/owned_mesh.h"

namespace etcm::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds time_limit{10};
// A mesh that needs more than this is not one to use; the policy `paper` gets here on fans.
constexpr std::size_t corpus_steiner_room = 1'000'000;

struct Measured {
  std::size_t added;
  double milliseconds;
  Status status;
  Rule broken;
};

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Measured measure_ours(const inputs::Graph& graph, SplitPolicy policy) {
  inputs::OwnedMesh mesh(inputs::config_for(graph, corpus_steiner_room, policy));
  const auto start = Clock::now();
  const Status status = mesh->build(graph.nodes, graph.features);
  const double milliseconds = milliseconds_since(start);
  return {mesh->steiner_count(), milliseconds, status, audit(*mesh).broken};
}

std::optional<Measured> measure_peer([[maybe_unused]] const inputs::Graph& graph) {
#ifdef ETCM_WITH_CGAL
  return run_limited(time_limit, [&] {
    const auto start = Clock::now();
    const std::size_t vertices = cgal_conforming(graph);
    return Measured{vertices - graph.nodes.size(), milliseconds_since(start), Status::ok,
                    Rule::none};
  });
#else
  return std::nullopt;
#endif
}

bool is_good(const std::optional<Measured>& measured) {
  return measured && measured->status == Status::ok && measured->broken == Rule::none;
}

std::string count_cell(const std::optional<Measured>& measured) {
  if (!measured) return "does not end";
  if (measured->status != Status::ok) return to_string(measured->status);
  return std::to_string(measured->added);
}

std::string audit_cell(const std::optional<Measured>& measured) {
  if (!measured) return "-";
  return measured->broken == Rule::none ? "ok" : to_string(measured->broken);
}

std::string decimal(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string time_cell(const std::optional<Measured>& measured) {
  return measured ? decimal(measured->milliseconds, 2) : "-";
}

// Counts are compared with one added to both, so that an input that needs none has a place in the
// mean too.
double ratio(const Measured& ours, const Measured& peer) {
  return (static_cast<double>(ours.added) + 1) / (static_cast<double>(peer.added) + 1);
}

class Summary {
 public:
  void add(const std::string& name, double value) {
    log_sum_ += std::log(value);
    ++rows_;
    if (value > 1) ++above_one_;
    if (value > worst_) {
      worst_ = value;
      worst_name_ = name;
    }
  }
  void print(std::ostream& out) const {
    if (rows_ == 0) return;
    out << "Ratio of (added + 1), ours to CGAL's, over " << rows_ << " inputs: geometric mean "
        << decimal(std::exp(log_sum_ / rows_), 3) << ", worst " << decimal(worst_, 3) << " ("
        << worst_name_ << "), above 1 on " << above_one_ << ".\n";
  }

 private:
  double log_sum_ = 0;
  int rows_ = 0;
  int above_one_ = 0;
  double worst_ = 0;
  std::string worst_name_;
};

}  // namespace

bool print_corpus_table(const std::vector<inputs::CorpusEntry>& entries, std::ostream& out) {
  out << "| family | input | nodes | features | CGAL | default | policy `paper` | ratio | audit | "
         "CGAL ms | default ms | policy `paper` ms |\n"
         "|---|---|---:|---:|---:|---:|---:|---:|---|---:|---:|---:|\n";
  Summary summary;
  std::size_t failures = 0;
  for (const auto& [family, graph] : entries) {
    const auto peer = measure_peer(graph);
    const auto ours = run_limited(time_limit, [&] { return measure_ours(graph, split_default); });
    const auto paper = run_limited(time_limit, [&] { return measure_ours(graph, split_paper); });
    const bool comparable = peer && is_good(ours);
    if (comparable) summary.add(graph.name, ratio(*ours, *peer));
    if (!is_good(ours)) ++failures;
    const std::string audits = audit_cell(ours) == audit_cell(paper)
                                   ? audit_cell(ours)
                                   : audit_cell(ours) + ", policy `paper`: " + audit_cell(paper);
    out << "| " << family << " | " << graph.name << " | " << graph.nodes.size() << " | "
        << graph.features.size() << " | " << (peer ? std::to_string(peer->added) : "fails") << " | "
        << count_cell(ours) << " | " << count_cell(paper) << " | "
        << (comparable ? decimal(ratio(*ours, *peer), 3) : "-") << " | " << audits << " | "
        << time_cell(peer) << " | " << time_cell(ours) << " | " << time_cell(paper) << " |"
        << std::endl;
  }
  out << '\n';
  summary.print(out);
  out << "Default policy: " << entries.size() - failures << " of " << entries.size()
      << " inputs conforming and audited.\n";
  return failures == 0;
}

}  // namespace etcm::bench
