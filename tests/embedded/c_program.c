// A C program on the library, the same lines on every machine: nodes join, features follow them as
// they move, and all is read back. Leaves with 1 where the mesh is ever not what it should be.
#include "console_c.h"
#include "etcm/c/analysis.h"
#include "etcm/etcm.h"

enum { vertices_max = 300, features_max = 60, node_count = 80, change_count = 200 };

static ETCM_STORAGE(storage, vertices_max, features_max);
static etcm_mesh_t mesh;
static etcm_vertex_t nodes[node_count];
static uint32_t numbers[ETCM_HANDLES_WORDS(vertices_max, features_max)];
static etcm_handles_t handles;
static etcm_connectivity_scratch_t scratch[vertices_max + 1];
static bool is_sound = true;

static void demand(bool fact, const char* what) {
  if (fact) return;
  is_sound = false;
  etcm_put("broken: ");
  etcm_put(what);
  etcm_put("\n");
}

static void demand_ok(etcm_status_t status) { demand(status == ETCM_OK, etcm_explain(status)); }

static uint32_t state = 12345;

// Below `most`, from a generator of its own (Lehmer's).
static int32_t drawn(int32_t most) {
  state = (uint32_t)((uint64_t)state * 48271u % 2147483647u);
  return (int32_t)(state % (uint32_t)most);
}

static void put_line(const char* title) {
  etcm_put(title);
  etcm_put(" steiner ");
  etcm_put_number(etcm_steiner_count(&mesh));
  etcm_put(" features ");
  etcm_put_number(etcm_feature_count(&mesh));
  etcm_put(" mesh ");
  etcm_put_hex(etcm_hash(&mesh));
  etcm_put("\n");
  etcm_audit_t audit;
  etcm_audit(&mesh, &audit);
  demand(audit.broken == ETCM_RULE_NONE, etcm_rule_name(audit.broken));
}

// A rule of C's: what the library would do, and how often it was asked.
static etcm_parameter_t counted(const etcm_split_site_t* site, void* context) {
  ++*(uint32_t*)context;
  return etcm_split_default(site, NULL);
}

static bool sum_ids(void* context, const etcm_edge_t* edge) {
  *(uint64_t*)context += (uint64_t)edge->from * edge->to + edge->constrained;
  return true;
}

static void live(void) {
  for (int i = 0; i < node_count; ++i) {
    const etcm_position_t place = {drawn(20000), drawn(20000)};
    demand_ok(etcm_join(&mesh, place, ETCM_UNLIMITED, &nodes[i]));
  }
  put_line("joined:");
  uint32_t done = 0, refused = 0;
  for (int i = 0; i < change_count; ++i) {
    const etcm_vertex_t node = nodes[drawn(node_count)], other = nodes[drawn(node_count)];
    const etcm_position_t place = {drawn(20000), drawn(20000)};
    etcm_feature_t feature;
    const etcm_status_t status = i % 3 == 0
                                     ? etcm_move(&mesh, node, place, 200000)
                                     : etcm_add_feature(&mesh, node, other, 200000, &feature);
    if (status == ETCM_OK) {
      ++done;
    } else {
      ++refused;
    }
  }
  etcm_put_number(done);
  etcm_put(" changes, refused ");
  etcm_put_number(refused);
  etcm_put("\n");
  put_line("changed:");
  demand_ok(etcm_canonicalize(&mesh, ETCM_UNLIMITED));
  put_line("as build() makes it:");
}

static void ask(void) {
  uint64_t sum = 0;
  demand(etcm_edges_of(&mesh, sum_ids, &sum), "all edges");
  etcm_put("edges ");
  etcm_put_number(sum);
  etcm_connectivity_t network;
  demand_ok(etcm_connectivity(&mesh, 2500, scratch, sizeof scratch / sizeof *scratch, &network));
  etcm_put(" parts ");
  etcm_put_number(network.parts);
  const etcm_position_t middle = {10000, 10000};
  const etcm_vertex_t nearest = etcm_nearest_node(&mesh, etcm_to_point(middle));
  etcm_put(" nearest ");
  etcm_put_number(nearest);
  etcm_put("\n");
  etcm_outcome_t outcome;
  etcm_dry_run_join(&mesh, middle, ETCM_UNLIMITED, &outcome);
  etcm_node_handle_t handle;
  demand_ok(etcm_handles_open(&handles, &mesh, numbers, sizeof numbers / sizeof *numbers, 0));
  const uint32_t before = etcm_steiner_count(&mesh);
  demand_ok(etcm_handles_join(&handles, middle, ETCM_UNLIMITED, &handle));
  demand(outcome.status == ETCM_OK &&
             (int32_t)etcm_steiner_count(&mesh) - (int32_t)before == outcome.steiner,
         "a dry run tells what will be");
  demand_ok(etcm_handles_leave(&handles, handle, ETCM_UNLIMITED));
  demand(etcm_handles_leave(&handles, handle, ETCM_UNLIMITED) == ETCM_STALE_HANDLE, "stale");
}

// The macros take what is no constant too, of any type, without a warning.
static void measure(void) {
  const int nodes = node_count, features = 5;
  const uint32_t vertices = ETCM_VERTICES_FOR(nodes, features),
                 segments = ETCM_SEGMENTS_FOR(features);
  etcm_config_t config;
  etcm_capacity_for(node_count, 5, &config);
  demand(config.vertices_max == vertices && config.features_max == segments, "capacities");
  demand(ETCM_STORAGE_BYTES(nodes, features) == etcm_storage_bytes(node_count, 5), "storage");
}

int main(void) {
  measure();
  etcm_config_t config = {.vertices_max = vertices_max, .features_max = features_max};
  demand_ok(etcm_open(&mesh, storage, sizeof storage, &config));
  live();
  ask();
  uint32_t asked = 0;
  const etcm_split_policy_t policy = {counted, &asked};
  config.policy = &policy;
  demand_ok(etcm_open(&mesh, storage, sizeof storage, &config));
  state = 12345;
  live();
  demand(asked > etcm_steiner_count(&mesh), "the policy is asked");
  etcm_put(is_sound ? "sound\n" : "not sound\n");
  return is_sound ? 0 : 1;
}
