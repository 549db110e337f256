/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The whole way from text to a checked scene. See read_scene.h; the parts are in reader.h. */
#include "parser/read_scene.h"

#include <string.h>

#include "engine/base/c_locale.h"
#include "parser/reader.h"

/* A text of the scene, in its own memory; "" where there is none. */
static const char *keep_text(strut_reader *reader, int key) {
  const strut_slot *slot = strut_slot_of(&reader->top, key);
  if (slot->state != STRUT_GIVEN) return "";
  return strut_keep_text(reader, slot->value->text);
}

static void read_head(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  scene->name = keep_text(reader, STRUT_KEY_SCENE_NAME);
  scene->description = keep_text(reader, STRUT_KEY_SCENE_DESCRIPTION);
  scene->source = keep_text(reader, STRUT_KEY_SCENE_SOURCE);
  const strut_slot *model = strut_slot_of(&reader->top, STRUT_KEY_SCENE_MASS_MODEL);
  const strut_slot *bars = strut_slot_of(&reader->top, STRUT_KEY_SCENE_BARS);
  strut_slot *gravity = strut_slot_of(&reader->top, STRUT_KEY_SCENE_GRAVITY);
  if (model->state == STRUT_GIVEN) scene->mass_model = (strut_mass_model)model->word;
  if (bars->state == STRUT_GIVEN) scene->bar_model = (strut_bar_model)bars->word;
  if (gravity->state == STRUT_GIVEN &&
      !strut_read_pair(reader, gravity->value, "gravity", (strut_owner){"the scene", NULL},
                       STRUT_DIM_ACCELERATION, scene->gravity))
    gravity->state = STRUT_BROKEN;
}

static void read_sections(strut_reader *reader, const strut_override *overrides, size_t count) {
  strut_read_parameters(reader, overrides, count);
  read_head(reader);
  strut_read_groups(reader);
  strut_read_nodes(reader);
  strut_read_members(reader);
  strut_read_signals(reader);
  strut_read_drives(reader);
  strut_read_ground(reader);
  strut_read_configurations(reader);
  strut_read_search(reader);
  strut_read_initial(reader);
  strut_read_experiment(reader);
  strut_keep_signals(reader);
  strut_keep_parameters(reader);
  strut_report_unused_groups(reader);
  if (!reader->failed) strut_report_idle_overrides(reader);
}

/* The mappings of which there is one: before they are read, and where they are not there. */
static void prepare(strut_reader *reader) {
  reader->ground.room = STRUT_ROOM_GROUND;
  reader->initial.room = STRUT_ROOM_INITIAL;
  reader->settle.room = STRUT_ROOM_SETTLE;
  reader->search.room = STRUT_ROOM_EQUILIBRIA;
  reader->solver.room = STRUT_ROOM_SOLVER;
  reader->run.room = STRUT_ROOM_RUN;
  reader->measure.room = STRUT_ROOM_MEASURE;
  reader->steady.room = STRUT_ROOM_STEADY;
  reader->output.room = STRUT_ROOM_OUTPUT;
}

/* Does the file say anything about a run? */
static bool speaks_of_a_run(strut_reader *reader) {
  const strut_slot *solver = strut_slot_of(&reader->top, STRUT_KEY_SCENE_SOLVER);
  const char *step = strut_key_at(STRUT_KEY_SOLVER_STEP)->name;
  return strut_slot_of(&reader->top, STRUT_KEY_SCENE_RUN)->key != NULL ||
         (solver->state == STRUT_GIVEN && strut_tree_find(solver->value, step, NULL));
}

/* Everything that can be said once there is a tree. */
static void read_tree(strut_reader *reader, const strut_override *overrides, size_t count) {
  strut_owner owner = {"the scene", NULL};
  strut_findings findings = {0};
  strut_read_fields(reader, STRUT_ROOM_SCENE, reader->document.root, owner, &reader->top);
  if (!reader->top.map || reader->document.root->kind != STRUT_TREE_MAP) return;
  strut_require(reader, &reader->top, owner, strut_root_place(reader));
  if (reader->purpose == STRUT_FOR_ANY)
    reader->purpose = speaks_of_a_run(reader) ? STRUT_FOR_RUN : STRUT_FOR_STATICS;
  if (reader->top.broken || reader->holes) reader->ends_unknown = true;
  read_sections(reader, overrides, count);
  if (reader->out_of_memory) return;
  if (strut_scene_check(reader->scene, reader->purpose, &findings) == STRUT_NO_MEMORY)
    reader->out_of_memory = true;
  strut_place_findings(reader, &findings);
  strut_findings_free(&findings);
}

static void free_reader(strut_reader *reader) {
  strut_name_map *const maps[] = {&reader->node_names,     &reader->member_names,
                                  &reader->group_names,    &reader->parameter_names,
                                  &reader->signal_names,   &reader->configuration_names,
                                  &reader->actuator_names, &reader->load_names};
  for (size_t i = 0; i < sizeof maps / sizeof maps[0]; i++) strut_name_map_free(maps[i]);
  strut_release(reader->signals);
  strut_release(reader->signal_state);
  strut_arena_free(&reader->scratch);
  strut_document_free(&reader->document);
}

strut_status strut_scene_read(strut_scene *scene, const char *file, const char *text, size_t length,
                              const strut_override *overrides, size_t override_count,
                              strut_purpose purpose, strut_diagnostics *diagnostics) {
  strut_reader *reader = strut_allocate(1, sizeof *reader);
  strut_scene_init(scene);
  strut_diagnostics_source(diagnostics, file, text, length);
  if (!reader) {
    strut_scene_free(scene);
    return STRUT_NO_MEMORY;
  }
  reader->scene = scene;
  reader->diagnostics = diagnostics;
  reader->purpose = purpose;
  prepare(reader);
  strut_c_locale locale = strut_c_locale_enter();
  strut_status status = strut_document_read(&reader->document, diagnostics);
  reader->holes = status == STRUT_BAD_SCENE;
  if (status != STRUT_NO_MEMORY && reader->document.root)
    read_tree(reader, overrides, override_count);
  strut_c_locale_leave(locale);
  if (!status && reader->failed) status = STRUT_BAD_SCENE;
  if (reader->out_of_memory) status = STRUT_NO_MEMORY;
  free_reader(reader);
  strut_release(reader);
  if (status) strut_scene_free(scene);
  return status;
}
