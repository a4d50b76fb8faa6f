// An interrupt that reads while the main program writes, in C: two meshes in turn
// (docs/readers.md). It asks which device is nearest to a place, and always gets an answer of a
// whole mesh. For one core, where an interrupt is over before the main program goes on; so the
// writer never waits, and a Cortex-M0+ does without an instruction that adds atomically.
//
// On a board interrupt() hangs on a timer. Here the library calls it, in the midst of each change
// (etcm_keep_alive()), where an interrupt does most harm.
#include <stdatomic.h>
#include <stdbool.h>

// In an installed tree, or beside the one source.
#if __has_include("etcm/etcm.h")
#include "etcm/etcm.h"
#else
#include "etcm.h"
#endif
#include "out.h"

enum { devices_max = 100, vertices_max = ETCM_VERTICES_FOR(devices_max, 0) };
// The share of work of one change.
#define WORK_OF_A_CHANGE 20000u

static ETCM_STORAGE(storage_0, vertices_max, 0);
static ETCM_STORAGE(storage_1, vertices_max, 0);
static etcm_mesh_t meshes[2];
// The one that is read. The main program alone writes it.
static volatile unsigned char front;

// What the interrupt has found. Each device joins nearer to the origin than those before it, so the
// nearest is never farther than it was.
static uint32_t reads, wrong;
static int32_t nearest_yet = INT32_MAX;

static void interrupt(void* context) {
  (void)context;
  // A question calls the hook, too, of the mesh that it is asked of: here this function.
  static bool is_reading;
  if (is_reading) return;
  is_reading = true;
  const etcm_mesh_t* const mesh = &meshes[front];
  const etcm_point_t origin = {0, 0};
  const etcm_vertex_t nearest = etcm_nearest_node(mesh, origin);
  if (nearest != ETCM_NONE) {
    const int32_t x = etcm_position(mesh, nearest).x;
    reads += 1;
    if (x > nearest_yet) wrong += 1;
    nearest_yet = x;
  }
  is_reading = false;
}

// Both meshes get the change. It is limited once: what was refused before has left the mesh behind
// as it was, but its storage may be arranged otherwise, so in the other mesh the same may take a
// little more. Without a limit it succeeds there, for it has succeeded here.
static etcm_status_t join(etcm_position_t place) {
  const unsigned char before = front, after = (unsigned char)(1 - before);
  etcm_vertex_t vertex;
  const etcm_status_t status = etcm_join(&meshes[after], place, WORK_OF_A_CHANGE, &vertex);
  if (status != ETCM_OK) return status;
  // What a compiler writes of one mesh is written before the other is.
  atomic_signal_fence(memory_order_seq_cst);
  front = after;
  atomic_signal_fence(memory_order_seq_cst);
  return etcm_join(&meshes[before], place, ETCM_UNLIMITED, &vertex);
}

int main(void) {
  const etcm_config_t config = {.vertices_max = vertices_max, .features_max = 0};
  if (etcm_open(&meshes[0], storage_0, sizeof storage_0, &config) != ETCM_OK) return 1;
  if (etcm_open(&meshes[1], storage_1, sizeof storage_1, &config) != ETCM_OK) return 1;
  for (int side = 0; side < 2; ++side) etcm_keep_alive(&meshes[side], interrupt, NULL);

  uint32_t joined = 0;
  for (int32_t i = 0; i < devices_max; ++i) {
    const etcm_position_t place = {1000 - 10 * i, i * i % 7};
    if (join(place) == ETCM_OK) joined += 1;
  }
  out_number(joined);
  out(" devices, ");
  out(wrong == 0 ? "each read of a whole mesh\n" : "a read of half a change\n");
  const int is_one = etcm_hash(&meshes[0]) == etcm_hash(&meshes[1]);
  return joined == devices_max && wrong == 0 && reads > 0 && is_one ? 0 : 1;
}
