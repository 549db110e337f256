/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/cli/sweep_shards.h"

#include "engine/base/memory.h"
#include "engine/output/buffer.h"
#include "parser/cli/streams.h"

static strut_status add_shard(strut_buffer *b, const char *directory, strut_shard shard,
                              strut_arena *arena, bool json) {
  strut_error error = {0};
  strut_slots *slots = NULL;
  strut_slots_plan plan;
  char *path = strut_shard_path(directory, shard, arena);
  if (!path) return strut_print_out_of_memory();
  strut_status status = strut_slots_read(path, &slots, &plan, &error);
  if (status != STRUT_OK) {
    strut_print_error(&error);
    return status;
  }
  long long missing = strut_slots_missing(slots), failed = strut_slots_failed(slots);
  strut_buffer_add(b,
                   json ? "{\"shard\": %lld, \"points\": %lld, \"done\": %lld, \"missing\": %lld, "
                          "\"failed\": %lld}"
                        : "shard %lld: %lld points: %lld done, %lld missing, %lld of the done "
                          "failed\n",
                   (long long)shard.index, (long long)plan.count, (long long)plan.count - missing,
                   missing, failed);
  strut_slots_close(slots);
  return STRUT_OK;
}

strut_status strut_sweep_print_shards(const char *directory, const strut_shards_found *found,
                                      strut_arena *arena, bool json) {
  strut_buffer b = {0};
  strut_status status = STRUT_OK;
  if (json) strut_buffer_add(&b, "{\"shard_count\": %lld, \"shards\": [", (long long)found->count);
  for (int64_t i = 0; i < found->count && status == STRUT_OK; i++) {
    if (json && i) strut_buffer_add(&b, ", ");
    if (found->there[i])
      status = add_shard(&b, directory, (strut_shard){i, found->count}, arena, json);
    else
      strut_buffer_add(&b, json ? "{\"shard\": %lld, \"done\": 0}" : "shard %lld: not begun\n",
                       (long long)i);
  }
  if (json) strut_buffer_add(&b, "]}\n");
  char *text = strut_buffer_take(&b);
  if (status == STRUT_OK) status = text ? strut_print(text) : strut_print_out_of_memory();
  strut_release(text);
  return status;
}
