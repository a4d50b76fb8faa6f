#include "c/policy.h"

#include <new>

#include "c/same.h"
#include "etcm/split_site.h"
#include "etcm/surroundings.h"

using namespace etcm;
using namespace etcm::c;

static_assert(ETCM_PARAMETER_END == parameter_end);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, from, from);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, to, to);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, head, head);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, tail, tail);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, feasible_head, feasible_head);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, feasible_tail, feasible_tail);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, head_right, head_right);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, head_left, head_left);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, tail_right, tail_right);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, tail_left, tail_left);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, head_is_node, head_is_node);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, tail_is_node, tail_is_node);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, is_lone, is_lone);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, mesh, mesh);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, head_triangle, head_triangle);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, tail_triangle, tail_triangle);
ETCM_SAME_MEMBER(SplitSite, etcm_split_site_t, context, library);
ETCM_SAME_MEMBER(Surroundings::Beside, etcm_beside_t, vertex, vertex);
ETCM_SAME_MEMBER(Surroundings::Beside, etcm_beside_t, is_node, is_node);
ETCM_SAME_MEMBER(Surroundings::Beside, etcm_beside_t, point, point);
ETCM_SAME_MEMBER(Surroundings::Beside, etcm_beside_t, along, along);
ETCM_SAME_MEMBER(Surroundings::Beside, etcm_beside_t, aside, aside);
static_assert(sizeof(Surroundings) <= sizeof(etcm_surroundings_t) &&
              std::alignment_of_v<Surroundings> <= std::alignment_of_v<etcm_surroundings_t>);
static_assert(ETCM_END_HEAD == static_cast<int>(Surroundings::End::head) &&
              ETCM_END_TAIL == static_cast<int>(Surroundings::End::tail));

namespace {

const SplitSite& site_of(const etcm_split_site_t* site) noexcept {
  return *reinterpret_cast<const SplitSite*>(site);
}

// What the library calls for each policy of C's.
Parameter ask(const SplitSite& site) noexcept {
  const auto& policy = *static_cast<const etcm_split_policy_t*>(site.context);
  return plain(policy.choose)(reinterpret_cast<const etcm_split_site_t*>(&site), policy.context);
}

Surroundings& around(etcm_surroundings_t* surroundings) noexcept {
  return *reinterpret_cast<Surroundings*>(surroundings);
}
const Surroundings& around(const etcm_surroundings_t* surroundings) noexcept {
  return *reinterpret_cast<const Surroundings*>(surroundings);
}

}  // namespace

void etcm::c::set_policy(MeshConfig& config, const etcm_split_policy_t& policy) noexcept {
  // Of its own rules the library knows how far they look, which spares canonicalize() work.
  if (policy.choose == etcm_split_default) {
    config.policy = split_default;
  } else if (policy.choose == etcm_split_paper) {
    config.policy = split_paper;
  } else {
    config.policy = policy.choose == nullptr ? nullptr : ask;
  }
  config.policy_context = const_cast<etcm_split_policy_t*>(&policy);
}

const etcm_split_policy_t* etcm::c::policy_of(const MeshConfig& config) noexcept {
  return static_cast<const etcm_split_policy_t*>(config.policy_context);
}

etcm_parameter_t etcm_split_default(const etcm_split_site_t* site, void*) {
  return split_default(site_of(site));
}

etcm_parameter_t etcm_split_paper(const etcm_split_site_t* site, void*) {
  return split_paper(site_of(site));
}

etcm_point_t etcm_split_site_at(const etcm_split_site_t* site, etcm_parameter_t t) {
  return as<etcm_point_t>(site_of(site).at(t));
}

double etcm_product(double a, double b) { return product(a, b); }
double etcm_root(double square) { return root(square); }

void etcm_surroundings_open(etcm_surroundings_t* surroundings, const etcm_split_site_t* site) {
  ::new (surroundings) Surroundings(site_of(site));
}

double etcm_surroundings_per_squared_length(const etcm_surroundings_t* surroundings) {
  return around(surroundings).per_squared_length();
}

void etcm_surroundings_start(etcm_surroundings_t* surroundings, etcm_end_t end) {
  around(surroundings).start(static_cast<Surroundings::End>(end));
}

bool etcm_surroundings_next(etcm_surroundings_t* surroundings, etcm_beside_t* beside) {
  Surroundings::Beside seen;
  if (!around(surroundings).next(seen)) return false;
  *beside = as<etcm_beside_t>(seen);
  return true;
}

etcm_vertex_t etcm_surroundings_shared_node(const etcm_surroundings_t* surroundings,
                                            etcm_end_t end) {
  return number(around(surroundings).shared_node(static_cast<Surroundings::End>(end)));
}

bool etcm_surroundings_is_on_segment_from(const etcm_surroundings_t* surroundings,
                                          etcm_vertex_t node, etcm_vertex_t vertex) {
  return around(surroundings).is_on_segment_from(VertexId{node}, VertexId{vertex});
}

unsigned etcm_surroundings_encroachments(etcm_surroundings_t* surroundings, etcm_parameter_t t,
                                         unsigned enough) {
  return around(surroundings).encroachments(t, enough);
}

unsigned etcm_surroundings_encroachments_at_least(const etcm_surroundings_t* surroundings,
                                                  etcm_parameter_t t) {
  return around(surroundings).encroachments_at_least(t);
}
