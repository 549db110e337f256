/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The whole way from text to a checked scene. See read_scene.h; the parts are in reader.h. */
#include "parser/read/read_scene.h"

#include <string.h>

#include "engine/base/c_locale.h"
#include "parser/read/reader.h"

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

/* Stops behind the section in which the diagnostics became full. */
static void read_sections(strut_reader *reader, const strut_setting *settings, size_t count) {
  static void (*const sections[])(strut_reader *) = {
      read_head,          strut_read_groups,  strut_read_nodes,     strut_read_members,
      strut_read_signals, strut_read_drives,  strut_read_ground,    strut_read_configurations,
      strut_read_search,  strut_read_initial, strut_read_experiment};
  strut_read_parameters(reader, settings, count);
  for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
    if (strut_diagnostics_full(reader->diagnostics)) return;
    sections[i](reader);
  }
  if (strut_diagnostics_full(reader->diagnostics)) return;
  strut_keep_signals(reader);
  strut_keep_parameters(reader);
  strut_report_unused_groups(reader);
  if (!reader->failed) strut_report_idle_settings(reader);
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

void strut_reader_target(strut_reader *reader, strut_setup *setup) {
  reader->setup = setup;
  reader->scene = &setup->scene;
  reader->experiment = &setup->experiment;
}

/* Does the file say anything about a run? */
static bool speaks_of_a_run(strut_reader *reader) {
  const strut_slot *solver = strut_slot_of(&reader->top, STRUT_KEY_SCENE_SOLVER);
  const char *step = strut_key_at(STRUT_KEY_SOLVER_STEP)->name;
  return strut_slot_of(&reader->top, STRUT_KEY_SCENE_RUN)->key != NULL ||
         (solver->state == STRUT_GIVEN && strut_tree_find(solver->value, step, NULL));
}

/* A study in the place of a model would be wrong in every line. */
static bool is_study(const strut_tree *root) {
  return root->kind == STRUT_TREE_MAP && strut_tree_find(root, "study", NULL) &&
         !strut_tree_find(root, "nodes", NULL);
}

/* Everything that can be said once there is a tree. */
static void read_tree(strut_reader *reader, const strut_setting *settings, size_t count) {
  strut_owner owner = {"the scene", NULL};
  strut_findings findings = {0};
  if (is_study(reader->document.root)) {
    strut_report_error(reader, strut_root_place(reader),
                       "this is a study, expected a model; 'strut sweep' runs studies");
    return;
  }
  strut_read_fields(reader, STRUT_ROOM_SCENE, reader->document.root, owner, &reader->top);
  if (!reader->top.map || reader->document.root->kind != STRUT_TREE_MAP) return;
  strut_require(reader, &reader->top, owner, strut_root_place(reader));
  if (reader->purpose == STRUT_FOR_ANY)
    reader->purpose = speaks_of_a_run(reader) ? STRUT_FOR_RUN : STRUT_FOR_STATICS;
  if (reader->top.broken || reader->holes) reader->ends_unknown = true;
  read_sections(reader, settings, count);
  if (reader->out_of_memory || strut_diagnostics_full(reader->diagnostics)) return;
  if (strut_setup_check(reader->setup, reader->purpose, &findings) == STRUT_NO_MEMORY)
    reader->out_of_memory = true;
  strut_place_findings(reader, &findings);
  reader->diagnostics->unstored += findings.unstored;
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

/* From a tree that belongs to somebody else, or from the text where there is none yet. */
static strut_status read_from(const strut_document *document, const strut_setting *settings,
                              size_t count, strut_purpose purpose, strut_diagnostics *diagnostics,
                              strut_setup *setup) {
  strut_reader *reader = strut_allocate(1, sizeof *reader);
  strut_status status = STRUT_OK;
  strut_setup_init(setup);
  if (!reader) {
    strut_setup_free(setup);
    return STRUT_NO_MEMORY;
  }
  strut_reader_target(reader, setup);
  reader->diagnostics = diagnostics;
  reader->purpose = purpose;
  prepare(reader);
  strut_c_locale locale = strut_c_locale_enter();
  if (document)
    reader->document.root = document->root;
  else
    status = strut_document_read(&reader->document, diagnostics);
  reader->holes = status == STRUT_BAD_SCENE;
  if (status != STRUT_NO_MEMORY && reader->document.root) read_tree(reader, settings, count);
  strut_c_locale_leave(locale);
  if (!status && reader->failed) status = STRUT_BAD_SCENE;
  if (reader->out_of_memory) status = STRUT_NO_MEMORY;
  free_reader(reader);
  strut_release(reader);
  if (status) strut_setup_free(setup);
  return status;
}

strut_status strut_setup_read(strut_setup *setup, const char *file, const char *text, size_t length,
                              const strut_override *overrides, size_t override_count,
                              strut_purpose purpose, strut_diagnostics *diagnostics) {
  strut_setting *settings = strut_allocate(override_count, sizeof *settings);
  strut_setup_init(setup);
  strut_diagnostics_source(diagnostics, file, text, length);
  if (!settings) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < override_count; i++)
    settings[i] = (strut_setting){.name = overrides[i].name, .text = overrides[i].value};
  strut_status status = read_from(NULL, settings, override_count, purpose, diagnostics, setup);
  strut_release(settings);
  return status;
}

struct strut_scene_source {
  strut_document document;
  strut_arena arena;
  const char *file, *text;
  size_t length, count;
  strut_declared *declared; /* (count) */
};

static strut_status keep_declared(strut_reader *reader, strut_scene_source *source) {
  source->count = reader->parameter_count;
  source->declared = strut_arena_allocate(&source->arena, source->count, sizeof *source->declared);
  if (!source->declared) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < source->count; i++) {
    const strut_parameter_state *p = &reader->parameters[i];
    source->declared[i] = (strut_declared){.name = p->name, /* the tree's */
                                           .text = p->text,
                                           .bare = p->quantity.bare,
                                           .dimension = p->quantity.dimension};
  }
  return STRUT_OK;
}

/* The parameters only. */
static strut_status declare_parameters(strut_scene_source *source, strut_diagnostics *diagnostics) {
  strut_setup setup;
  strut_reader *reader = strut_allocate(1, sizeof *reader);
  if (!reader) return STRUT_NO_MEMORY;
  strut_setup_init(&setup);
  strut_reader_target(reader, &setup);
  reader->diagnostics = diagnostics;
  prepare(reader);
  reader->document.root = source->document.root;
  strut_read_fields(reader, STRUT_ROOM_SCENE, reader->document.root,
                    (strut_owner){"the scene", NULL}, &reader->top);
  if (reader->document.root->kind == STRUT_TREE_MAP) strut_read_parameters(reader, NULL, 0);
  strut_status status = reader->failed ? STRUT_BAD_SCENE : keep_declared(reader, source);
  if (reader->out_of_memory) status = STRUT_NO_MEMORY;
  free_reader(reader);
  strut_release(reader);
  strut_setup_free(&setup);
  return status;
}

strut_status strut_scene_source_open(const char *file, const char *text, size_t length,
                                     strut_diagnostics *diagnostics, strut_scene_source **result) {
  strut_scene_source *source = strut_allocate(1, sizeof *source);
  strut_diagnostics unused = {0};
  strut_diagnostics_source(diagnostics, file, text, length);
  strut_diagnostics_source(&unused, file, text, length);
  *result = source;
  if (!source) return STRUT_NO_MEMORY;
  source->file = file, source->text = text, source->length = length;
  strut_c_locale locale = strut_c_locale_enter();
  strut_status status = strut_document_read(&source->document, &unused);
  if (status == STRUT_OK) status = declare_parameters(source, &unused);
  strut_c_locale_leave(locale);
  strut_diagnostics_free(&unused);
  if (status == STRUT_OK) return status;
  strut_setup setup; /* once more, for everything that can be said */
  if (status == STRUT_BAD_SCENE)
    status = strut_setup_read(&setup, file, text, length, NULL, 0, STRUT_FOR_RUN, diagnostics);
  if (status == STRUT_OK) strut_setup_free(&setup);
  strut_scene_source_free(source);
  *result = NULL;
  return status == STRUT_OK ? STRUT_BAD_SCENE : status;
}

void strut_scene_source_free(strut_scene_source *source) {
  if (!source) return;
  strut_document_free(&source->document);
  strut_arena_free(&source->arena);
  strut_release(source);
}

const strut_declared *strut_scene_source_parameters(const strut_scene_source *source,
                                                    size_t *count) {
  *count = source->count;
  return source->declared;
}

strut_document *strut_scene_source_document(strut_scene_source *source) {
  return &source->document;
}

strut_status strut_scene_source_read(const strut_scene_source *source,
                                     const strut_setting *settings, size_t setting_count,
                                     strut_purpose purpose, strut_diagnostics *diagnostics,
                                     strut_setup *setup) {
  strut_diagnostics_source(diagnostics, source->file, source->text, source->length);
  return read_from(&source->document, settings, setting_count, purpose, diagnostics, setup);
}
