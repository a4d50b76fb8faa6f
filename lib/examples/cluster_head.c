// A cluster head in C: the mesh of the devices that it hears, in memory that is fixed when it is
// compiled. No message takes longer than its share of work, and a reset forgets nothing.
#include <string.h>

// In an installed tree, or beside the one source.
#if __has_include("etcm/etcm.h")
#include "etcm/etcm.h"
#else
#include "etcm.h"
#endif
#include "messages.h"
#include "out.h"

enum {
  devices_max = 16,
  roads_max = 10,
  vertices_max = ETCM_VERTICES_FOR(devices_max, roads_max),
  segments_max = ETCM_SEGMENTS_FOR(roads_max),
  shares_max = roads_max + 8,  // one for each group of roads, and some to look for them
  neighbours_max = 8
};

// The work that a message may take, in units of the library: 95 ms at the most on a Cortex-M4 of
// 168 MHz with two cycles an instruction. docs/cost.md has what to set for other watchdogs and
// machines: a Cortex-M0+ of 16 MHz takes 3.5 s for as many.
#define WORK_OF_A_MESSAGE 20000u

// All that must outlive a reset: in memory that is not cleared then (a section such as .noinit,
// which the linker script has to know), or written to flash and read back.
static struct {
  ETCM_STORAGE(mesh, vertices_max, segments_max);
  etcm_vertex_t vertex_of[devices_max];  // ETCM_INFINITE: the device has not joined
} kept;

static etcm_mesh_t mesh;

static void say(const message_t* message, etcm_status_t status) {
  static const char* const words[] = {"joins", "moves", "leaves", "road"};
  out("device ");
  out_number(message->device);
  out(" ");
  out(words[message->kind]);
  out(": ");
  out(etcm_status_name(status));
  out("\n");
}

// What is refused changes nothing: the message is answered with why, and all goes on.
static etcm_status_t hear(const message_t* message) {
  const etcm_position_t place = {message->x, message->y};
  const etcm_vertex_t vertex = kept.vertex_of[message->device];
  etcm_vertex_t joined;
  etcm_feature_t feature;
  etcm_status_t status = ETCM_OK;
  switch (message->kind) {
    case joins:
      status = etcm_join(&mesh, place, WORK_OF_A_MESSAGE, &joined);
      if (status == ETCM_OK) kept.vertex_of[message->device] = joined;
      break;
    case moves:
      status = etcm_move(&mesh, vertex, place, WORK_OF_A_MESSAGE);
      break;
    case leaves:
      status = etcm_leave(&mesh, vertex, WORK_OF_A_MESSAGE);
      if (status == ETCM_OK) kept.vertex_of[message->device] = ETCM_INFINITE;
      break;
    default:
      status = etcm_add_feature(&mesh, vertex, kept.vertex_of[message->other], WORK_OF_A_MESSAGE,
                                &feature);
  }
  return status;
}

// Between messages: takes back what history has left, a share of work at a time. Where one group of
// roads needs more than a share it stays as it is, conforming all the same.
// A board kicks its watchdog before each share.
static void tidy_up(void) {
  etcm_feature_t last = ETCM_NONE;
  for (int share = 0; share < shares_max; ++share) {
    if (etcm_canonicalize(&mesh, WORK_OF_A_MESSAGE) != ETCM_WORK_LIMIT) return;
    etcm_error_detail_t detail;
    etcm_error_detail(&mesh, &detail);
    // No feature is named while groups are still looked for.
    if (detail.feature != ETCM_NONE && detail.feature == last) return;
    last = detail.feature;
  }
}

static void tell_neighbours(etcm_vertex_t vertex) {
  // What finds no room is not told: to hear of all there may be, it takes vertices_max - 1 entries.
  etcm_neighbour_t around[neighbours_max];
  const uint32_t count = etcm_neighbours(&mesh, vertex, around, neighbours_max);
  out("neighbours of vertex ");
  out_number(vertex);
  out(":");
  for (uint32_t i = 0; i < count && i < neighbours_max; ++i) {
    out(" ");
    out_number(around[i].vertex);
    if (around[i].constrained) out("=");
  }
  out("\n");
}

static void tell(void) {
  out_number(etcm_node_count(&mesh));
  out(" devices, ");
  out_number(etcm_feature_count(&mesh));
  out(" roads, ");
  out_number(etcm_steiner_count(&mesh));
  out(" Steiner vertices\n");
}

// At each start: takes up what has been kept. Where that is no mesh, as at the first start or after
// a reset in the midst of a change, it begins with an empty one, and the devices join anew.
static etcm_status_t wake_up(void) {
  const etcm_config_t config = {.vertices_max = vertices_max, .features_max = segments_max};
  const etcm_status_t status = etcm_attach(&mesh, kept.mesh, sizeof kept.mesh, NULL);
  if (status == ETCM_OK) return status;
  for (int i = 0; i < devices_max; ++i) kept.vertex_of[i] = ETCM_INFINITE;
  const etcm_status_t opened = etcm_open(&mesh, kept.mesh, sizeof kept.mesh, &config);
  return opened == ETCM_OK ? status : opened;
}

static void say_start(etcm_status_t status) {
  out("start: ");
  out(etcm_status_name(status));
  out(status == ETCM_OK ? ", the mesh is there\n" : ", an empty mesh\n");
}

int main(void) {
  say_start(wake_up());
  for (size_t i = 0; i < sizeof messages / sizeof *messages; ++i) {
    say(&messages[i], hear(&messages[i]));
    tidy_up();
    // From here until the next change a reset finds the mesh whole.
    etcm_seal(&mesh);
  }
  tell();
  tell_neighbours(kept.vertex_of[4]);

  // A reset: all is gone but what was kept.
  const uint64_t before = etcm_hash(&mesh);
  memset(&mesh, 0, sizeof mesh);
  say_start(wake_up());
  tell_neighbours(kept.vertex_of[4]);
  return etcm_hash(&mesh) == before ? 0 : 1;
}
