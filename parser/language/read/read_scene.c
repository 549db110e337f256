/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reading a whole scene: text, tree, sections, check. See read_scene.h; the parts are in reader.h. */
#include "parser/language/read/read_scene.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/text.h"
#include "parser/language/read/programs.h"
#include "parser/language/read/reuse/copies.h"
#include "parser/language/read/reuse/used_files.h"

void strut_require_nodes(strut_reader *reader) {
  char expected[100];
  strut_slot *slot = strut_slot_of(&reader->top, STRUT_KEY_SCENE_NODES);
  if (slot->state != STRUT_ABSENT) return;
  if (!reader->holes)
    strut_report_error(reader, strut_root_place(reader), "the scene lacks 'nodes', expected %s",
                       strut_key_expected(STRUT_KEY_SCENE_NODES, expected, sizeof expected));
  slot->state = STRUT_BROKEN;
  reader->top.broken = true;
}

void strut_mark_incomplete(strut_reader *reader) {
  for (int k = 0; k < strut_section_size(STRUT_SECTION_SCENE); k++) {
    int key = strut_section_first(STRUT_SECTION_SCENE) + k;
    bool things = key == STRUT_KEY_SCENE_GROUPS || key == STRUT_KEY_SCENE_CONFIGURATIONS ||
                  (strut_section_of_things(key) != STRUT_SECTION_COUNT &&
                   key != STRUT_KEY_SCENE_PARTS && key != STRUT_KEY_SCENE_PLACE);
    if (things) reader->top.slot[k].state = STRUT_BROKEN;
  }
  reader->top.broken = reader->failed = reader->ends_unknown = reader->groups_unknown = true;
}

/* The scene's own numbers may use parameters: they are read here, when these are known. */
static void read_head(strut_reader *reader) {
  strut_owner owner = {"the scene", NULL};
  for (int i = 0; i < strut_section_size(STRUT_SECTION_SCENE); i++) {
    strut_slot *slot = &reader->top.slot[i];
    int key = strut_section_first(STRUT_SECTION_SCENE) + i;
    if (slot->state != STRUT_GIVEN || strut_key_at(key)->type != STRUT_TYPE_PAIR) continue;
    bool fine = strut_read_pair(reader, slot->value, strut_key_at(key)->name, owner,
                                strut_measure_dimension(strut_key_at(key)->measure), slot->number);
    if (!fine) slot->state = STRUT_BROKEN;
  }
  strut_store(reader, &reader->top, reader->scene);
}

/* Stops behind the section in which the diagnostics became full. */
static void read_sections(strut_reader *reader, const strut_setting *settings, size_t count) {
  static const struct {
    void (*read)(strut_reader *); /* NULL: all things of the kind */
    strut_thing kind;
  } sections[] = {
#define STEP(function) {function, STRUT_THING_COUNT}
#define THINGS(KIND)                                                                               \
  { NULL, STRUT_THING_##KIND }
      STEP(read_head),
      STEP(strut_read_scene_data),
      STEP(strut_read_groups),
      STEP(strut_read_nodes),
      STEP(strut_merge_nodes),
      STEP(strut_read_beams),
      THINGS(MEMBER),
      STEP(strut_add_beam_members),
      THINGS(HINGE),
      STEP(strut_add_beam_hinges),
      THINGS(CELL),
      THINGS(COLLISION),
      STEP(strut_read_bodies),
      THINGS(DISTANCE),
      THINGS(FOOT),
      STEP(strut_read_rayleigh),
      STEP(strut_read_lattice),
      STEP(strut_list_signals),
      STEP(strut_list_controllers),
      STEP(strut_list_states),
      THINGS(SENSOR),
      STEP(strut_read_controllers),
      STEP(strut_read_signals),
      STEP(strut_read_states),
      STEP(strut_read_pipes),
      STEP(strut_read_moves),
      THINGS(UNBALANCE),
      THINGS(ACTUATOR),
      STEP(strut_add_pipe_drives),
      THINGS(LOAD),
      THINGS(SLIDER),
      STEP(strut_read_ground),
      STEP(strut_read_configurations),
      STEP(strut_read_search),
      STEP(strut_read_initial),
      STEP(strut_read_stages),
      STEP(strut_read_experiment)
#undef STEP
#undef THINGS
  };
  strut_read_parameters(reader, settings, count);
  strut_read_parts(reader);
  for (size_t i = 0; i < sizeof sections / sizeof sections[0]; i++) {
    if (strut_diagnostics_full(reader->diagnostics)) return;
    reader->scope = NULL;
    if (sections[i].read)
      sections[i].read(reader);
    else
      strut_read_things(reader, sections[i].kind);
  }
  reader->scope = NULL;
  if (strut_diagnostics_full(reader->diagnostics)) return;
  strut_keep_signals(reader);
  strut_keep_parameters(reader);
  strut_report_unused_groups(reader);
  if (!reader->failed) strut_report_idle_settings(reader);
}

/* Sets the section of every singleton mapping, so that absent ones can be queried. */
static void clear_sections(strut_reader *reader) {
  reader->ground.section = STRUT_SECTION_GROUND;
  reader->initial.section = STRUT_SECTION_INITIAL;
  reader->settle.section = STRUT_SECTION_SETTLE;
  reader->search.section = STRUT_SECTION_EQUILIBRIA;
  reader->solver.section = STRUT_SECTION_SOLVER;
  reader->run.section = STRUT_SECTION_RUN;
  reader->measure.section = STRUT_SECTION_MEASURE;
  reader->steady.section = STRUT_SECTION_STEADY;
  reader->output.section = STRUT_SECTION_OUTPUT;
}

static bool describes_run(strut_reader *reader) {
  const strut_slot *solver = strut_slot_of(&reader->top, STRUT_KEY_SCENE_SOLVER);
  const char *step = strut_key_at(STRUT_KEY_SOLVER_STEP)->name;
  return strut_slot_of(&reader->top, STRUT_KEY_SCENE_RUN)->key != NULL ||
         (solver->state == STRUT_GIVEN && strut_tree_find(solver->value, step, NULL));
}

bool strut_tree_is_study(const strut_tree *root) {
  return root->kind == STRUT_TREE_MAP && strut_tree_find(root, "study", NULL) &&
         !strut_tree_find(root, "nodes", NULL);
}

void strut_reader_target(strut_reader *reader, strut_setup *setup) {
  reader->setup = setup;
  reader->scene = &setup->scene;
  reader->keep = &setup->scene.arena;
  reader->experiment = &setup->experiment;
}

static void read_tree(strut_reader *reader, const strut_setting *settings, size_t count) {
  strut_owner owner = {"the scene", NULL};
  strut_findings findings = {0};
  if (strut_tree_is_study(reader->document.root)) {
    strut_report_error(reader, strut_root_place(reader),
                       "this is a study, expected a model; 'strut sweep' runs studies");
    return;
  }
  strut_read_fields(reader, STRUT_SECTION_SCENE, reader->document.root, owner, &reader->top);
  if (!reader->top.map || reader->document.root->kind != STRUT_TREE_MAP) return;
  strut_require(reader, &reader->top, strut_root_place(reader));
  bool any = reader->purpose == STRUT_FOR_ANY || reader->purpose == STRUT_FOR_ANY_STATICS;
  if (any && !describes_run(reader)) reader->purpose = STRUT_FOR_STATICS;
  if (reader->purpose == STRUT_FOR_ANY) reader->purpose = STRUT_FOR_RUN;
  if (reader->top.broken || reader->holes) reader->ends_unknown = true;
  read_sections(reader, settings, count);
  if (reader->out_of_memory || strut_diagnostics_full(reader->diagnostics)) return;
  strut_name_map_free(
      &reader->things[STRUT_THING_NODE].names); /* the check makes such tables of its own */
  strut_name_map_free(&reader->things[STRUT_THING_MEMBER].names);
  strut_experiment_choose_method(&reader->setup->experiment, &reader->setup->scene);
  if (strut_setup_check(reader->setup, reader->purpose, &findings) == STRUT_NO_MEMORY)
    reader->out_of_memory = true;
  strut_place_findings(reader, &findings);
  reader->diagnostics->unstored += findings.unstored;
  strut_findings_free(&findings);
}

static strut_reader *open_reader(strut_setup *setup, strut_diagnostics *diagnostics) {
  strut_reader *reader = strut_allocate(1, sizeof *reader);
  strut_setup_init(setup);
  if (!reader) return NULL;
  strut_reader_target(reader, setup);
  reader->diagnostics = diagnostics;
  clear_sections(reader);
  return reader;
}

static void close_reader(strut_reader *reader) {
  for (int k = 0; k < STRUT_THING_COUNT; k++) strut_name_map_free(&reader->things[k].names);
  strut_name_map_free(&reader->signal_names);
  strut_name_map_free(&reader->group_names);
  strut_name_map_free(&reader->parameter_names);
  strut_copies_free(reader);
  strut_release(reader->signals);
  strut_release(reader->signal_state);
  strut_arena_free(&reader->scratch);
  strut_document_free(&reader->document);
  strut_release(reader);
}

/* The tree of the text and of all files that it names. */
static strut_status read_document(strut_document *document, strut_diagnostics *diagnostics) {
  strut_status status = strut_document_read(document, diagnostics);
  if (status == STRUT_NO_MEMORY) return status;
  strut_status files = strut_read_used_files(document, diagnostics);
  return files ? files : status;
}

/* Reads the scene from a source, or from the text if that is NULL. */
static strut_status read_from(const strut_scene_source *source, const strut_setting *settings,
                              size_t count, strut_purpose purpose, strut_diagnostics *diagnostics,
                              strut_setup *setup) {
  strut_status status = STRUT_OK;
  strut_reader *reader = open_reader(setup, diagnostics);
  if (!reader) return STRUT_NO_MEMORY;
  reader->purpose = purpose;
  strut_c_locale locale = strut_c_locale_enter();
  if (source) {
    reader->document.root = source->document.root;
    reader->tables = source->tables, reader->table_count = source->table_count;
  } else {
    status = read_document(&reader->document, diagnostics);
  }
  if (reader->out_of_memory) status = STRUT_NO_MEMORY;
  reader->holes = status == STRUT_BAD_SCENE;
  if (status != STRUT_NO_MEMORY && reader->document.root) read_tree(reader, settings, count);
  strut_note_copies(reader);
  strut_c_locale_leave(locale);
  if (!status && reader->failed) status = STRUT_BAD_SCENE;
  if (reader->out_of_memory) status = STRUT_NO_MEMORY;
  close_reader(reader);
  if (status) strut_setup_free(setup);
  return status;
}

strut_status strut_setup_read(strut_setup *setup, const char *file, const char *text, size_t length,
                              const strut_setting *settings, size_t setting_count,
                              strut_purpose purpose, strut_diagnostics *diagnostics) {
  strut_setup_init(setup);
  strut_diagnostics_source(diagnostics, file, text, length);
  return read_from(NULL, settings, setting_count, purpose, diagnostics, setup);
}

static strut_status keep_used(strut_scene_source *source, strut_diagnostics *from) {
  size_t most = from->used_count + 1; /* strut_scene_source_use adds one */
  source->used = strut_arena_allocate(&source->arena, most, sizeof *source->used);
  if (!source->used) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < from->used_count; i++) {
    strut_used_file *to = &source->used[i];
    const char *name = from->used[i].file;
    *to = from->used[i];
    to->file = strut_arena_text(&source->arena, name, strlen(name));
    if (!to->file) return STRUT_NO_MEMORY;
    from->used[i].owned = NULL;
    source->used_count++;
  }
  return STRUT_OK;
}

/* Names them, so that places in them can be shown. */
static void enter_used(const strut_scene_source *source, strut_diagnostics *diagnostics) {
  if (diagnostics->used_count) return; /* of an earlier scene of this source */
  for (size_t i = 0; i < source->used_count; i++) {
    const strut_used_file *used = &source->used[i];
    strut_diagnostics_use(diagnostics, used->file, used->text, used->length);
  }
}

strut_declared strut_declaration_of(const strut_parameter_state *parameter) {
  bool scalar = parameter->value->kind == STRUT_TREE_SCALAR;
  return (strut_declared){.name = parameter->name, /* the tree's */
                          .text = parameter->text,
                          .bare = parameter->quantity.bare,
                          .dimension = parameter->quantity.dimension,
                          .shown = strut_unit_of_text(scalar ? parameter->value->text : "", NULL)};
}

static strut_status keep_declared(strut_reader *reader, strut_scene_source *source) {
  size_t count = source->parameter_count = reader->parameter_count;
  source->parameters = strut_arena_allocate(&source->arena, count, sizeof *source->parameters);
  if (!source->parameters) return STRUT_NO_MEMORY;
  for (size_t i = 0; i < count; i++)
    source->parameters[i] = strut_declaration_of(&reader->parameters[i]);
  return STRUT_OK;
}

/* Reads nothing but the parameters and the data. */
static strut_status declare_parameters(strut_scene_source *source, strut_diagnostics *diagnostics) {
  strut_setup setup;
  strut_reader *reader = open_reader(&setup, diagnostics);
  if (!reader) return STRUT_NO_MEMORY;
  reader->document.root = source->document.root;
  strut_read_fields(reader, STRUT_SECTION_SCENE, reader->document.root,
                    (strut_owner){"the scene", NULL}, &reader->top);
  reader->keep = &source->arena;
  if (reader->document.root->kind == STRUT_TREE_MAP) {
    strut_read_parameters(reader, NULL, 0);
    strut_read_scene_data(reader);
  }
  source->tables = reader->tables, source->table_count = reader->table_count;
  strut_status status = reader->failed ? STRUT_BAD_SCENE : keep_declared(reader, source);
  if (reader->out_of_memory) status = STRUT_NO_MEMORY;
  close_reader(reader);
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
  strut_status status = read_document(&source->document, &unused);
  if (status == STRUT_OK) status = declare_parameters(source, &unused);
  if (status == STRUT_OK) status = keep_used(source, &unused);
  strut_c_locale_leave(locale);
  strut_diagnostics_free(&unused);
  if (status == STRUT_OK) return status;
  strut_setup setup; /* read again to report all errors */
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
  for (size_t i = 0; i < source->used_count; i++) strut_release(source->used[i].owned);
  strut_arena_free(&source->arena);
  strut_release(source);
}

const strut_declared *strut_scene_source_parameter(const strut_scene_source *source,
                                                   const char *name) {
  size_t count = source->parameter_count;
  size_t i = strut_row_find(STRUT_NAMED(source->parameters, count), name);
  return i < count ? &source->parameters[i] : NULL;
}

bool strut_setting_put(const strut_scene_source *source, const char *name, double value,
                       char text[STRUT_NUMBER_TEXT], strut_setting *settings, size_t *count) {
  const strut_declared *declared = strut_scene_source_parameter(source, name);
  if (!declared || declared->text) return false;
  size_t at = strut_row_find(STRUT_NAMED(settings, *count), name);
  if (at == *count) settings[(*count)++] = (strut_setting){.name = name};
  strut_number_text(value, text);
  settings[at] = (strut_setting){.name = name,
                                 .text = text,
                                 .known = true,
                                 .bare = declared->bare,
                                 .value = value,
                                 .dimension = declared->dimension,
                                 .place = settings[at].place};
  return true;
}

unsigned strut_scene_source_use(strut_scene_source *source, const char *file, const char *text,
                                size_t length) {
  if (source->used_count == STRUT_USED_FILES_MOST) return 0;
  source->used[source->used_count] = (strut_used_file){file, text, length, NULL};
  return (unsigned)++source->used_count;
}

strut_status strut_scene_source_read(const strut_scene_source *source,
                                     const strut_setting *settings, size_t setting_count,
                                     strut_purpose purpose, strut_diagnostics *diagnostics,
                                     strut_setup *setup) {
  strut_diagnostics_source(diagnostics, source->file, source->text, source->length);
  enter_used(source, diagnostics);
  return read_from(source, settings, setting_count, purpose, diagnostics, setup);
}

enum { FIRST_SIZE = 64 * 1024 };

static strut_status file_trouble(strut_error *error, const char *name, int code) {
  char reason[128];
  if (strerror_r(code, reason, sizeof reason) != 0)
    snprintf(reason, sizeof reason, "error %d", code);
  return strut_fail(error, STRUT_FILE_TROUBLE, "cannot read %s: %s", name, reason);
}

/* Reads to the end of the stream; the block grows as needed and keeps room for a NUL. */
static strut_status read_stream(FILE *stream, const char *name, char **text, size_t *length,
                                strut_error *error) {
  size_t capacity = 0, used = 0, got;
  do {
    if (capacity < used + 2) {
      size_t wider = capacity ? 2 * capacity : FIRST_SIZE;
      if (wider > STRUT_TEXT_MOST + 2) wider = STRUT_TEXT_MOST + 2;
      char *block = strut_reallocate(*text, wider, 1);
      if (!block) return strut_fail(error, STRUT_NO_MEMORY, "out of memory while reading %s", name);
      *text = block;
      capacity = wider;
    }
    errno = 0;
    got = fread(*text + used, 1, capacity - used - 1, stream);
    used += got;
    if (used > STRUT_TEXT_MOST)
      return strut_fail(error, STRUT_BAD_SCENE, "%s has more than %zu MiB", name,
                        STRUT_TEXT_MOST >> 20);
  } while (got);
  if (ferror(stream)) return file_trouble(error, name, errno ? errno : EIO);
  (*text)[used] = '\0';
  *length = used;
  return STRUT_OK;
}

strut_status strut_file_read(const char *path, char **text, size_t *length, strut_error *error) {
  char name[400];
  bool standard = strcmp(path, "-") == 0;
  *text = NULL;
  *length = 0;
  snprintf(name, sizeof name, standard ? "the standard input" : "'%s'", path);
  FILE *stream = standard ? stdin : fopen(path, "rb");
  if (!stream) return file_trouble(error, name, errno);
  strut_status status = read_stream(stream, name, text, length, error);
  if (!standard) fclose(stream);
  if (status != STRUT_OK) {
    strut_release(*text);
    *text = NULL;
  }
  return status;
}

/* ---- the place of each finding ---- */

/* The item of a thing's groups that gives `key`; the later group wins. */
static strut_group_item *group_item(strut_reader *reader, const strut_tree *map, const char *key) {
  strut_tree *named = strut_tree_find(map, "group", NULL);
  strut_group *groups[STRUT_MOST_GROUPS];
  size_t count = named ? strut_groups_named(reader, named, groups) : 0;
  while (count > 0) {
    const strut_group *group = groups[--count];
    for (size_t i = 0; i < group->count; i++)
      if (strcmp(group->items[i].slot.key->text, key) == 0) return &group->items[i];
  }
  return NULL;
}

/* The value of the thing's own key, else of its group's, else the thing's name. False: the group's
   value has a finding already. */
static bool thing_place(strut_reader *reader, const strut_source *source, const char *key,
                        strut_place *place) {
  strut_enter_scope(reader, source->key);
  const strut_tree *own = key ? strut_tree_find(source->value, key, NULL) : NULL;
  strut_group_item *item = key && !own ? group_item(reader, source->value, key) : NULL;
  *place = own ? own->place : item ? item->slot.value->place : source->key->place;
  if (!item) return true;
  bool first = !item->found;
  item->found = true;
  return first;
}

/* The slot of a finding's key, or NULL. */
static strut_slot *slot_named(strut_fields *fields, const char *key) {
  int found = key ? strut_key_find(fields->section, key) : -1;
  return found < 0 ? NULL : strut_slot_of(fields, found);
}

/* The value of a key of the ground, the solver, ..., else the key of the whole section. */
static strut_place field_place(strut_reader *reader, strut_fields *fields, const char *key,
                               int section) {
  const strut_slot *slot = slot_named(fields, key);
  if (slot && slot->value) return slot->value->place;
  const strut_tree *whole = strut_slot_of(&reader->top, section)->key;
  return whole ? whole->place : strut_root_place(reader);
}

static bool node_place(strut_reader *reader, const strut_finding *finding, strut_place *place) {
  const strut_source *source = &reader->things[STRUT_THING_NODE].source[finding->index];
  bool mass = finding->key && strcmp(finding->key, "mass") == 0;
  bool velocity = finding->key && strcmp(finding->key, "velocity") == 0;
  if ((mass || !finding->key) && reader->ends_unknown) return false;
  if (mass && reader->masses_unknown) return false;
  if (!velocity) return thing_place(reader, source, finding->key, place);
  const strut_tree *map = strut_given(&reader->initial, STRUT_KEY_INITIAL_VELOCITIES);
  *place = source->key->place;
  for (const strut_tree *key = map ? map->first : NULL; key; key = key->next->next)
    if (strcmp(key->text, reader->scene->nodes[finding->index].name) == 0)
      *place = key->next->place;
  return true;
}

/* The value of a ground's own key, else its name. */
static strut_place ground_place(strut_reader *reader, size_t ground, const char *key) {
  if (!reader->things[STRUT_THING_GROUND].source)
    return field_place(reader, &reader->ground, key, STRUT_KEY_SCENE_GROUND);
  const strut_slot *slot = slot_named(&reader->grounds[ground], key);
  return slot && slot->value ? slot->value->place
                             : reader->things[STRUT_THING_GROUND].source[ground].key->place;
}

/* The contact's own key, its group's, the ground's, or the name of the contact. */
static bool contact_place(strut_reader *reader, const strut_finding *finding, strut_place *place) {
  const strut_source *source = &reader->things[STRUT_THING_CONTACT].source[finding->index];
  int32_t g = reader->scene->contacts[finding->index].ground;
  *place = ground_place(reader, (size_t)g, finding->key);
  if (!source->key) return true;
  strut_place before = *place, mine;
  bool fresh = thing_place(reader, source, finding->key, &mine);
  bool ground = mine.line == source->key->place.line && mine.column == source->key->place.column &&
                finding->key && strut_key_find(STRUT_SECTION_GROUND, finding->key) >= 0;
  *place = ground ? before : mine;
  return fresh;
}

static bool signal_place(strut_reader *reader, const strut_finding *finding, strut_place *place) {
  const strut_tree *value = reader->signal_state[finding->index].value;
  const strut_tree *own = finding->key ? strut_tree_find(value, finding->key, NULL) : NULL;
  *place = own ? own->place : value->place;
  return true;
}

static bool many_place(strut_reader *reader, const strut_finding *finding, strut_place *place) {
  const strut_source *source = &reader->things[finding->subject].source[finding->index];
  if (source->broken) return false;
  bool of_ground =
      finding->subject == STRUT_ON_CONFIGURATION || finding->subject == STRUT_ON_SENSOR;
  if (of_ground && reader->ground.broken) return false;
  if (finding->subject == STRUT_ON_NODE) return node_place(reader, finding, place);
  if (finding->subject == STRUT_ON_CONTACT) return contact_place(reader, finding, place);
  return thing_place(reader, source, finding->key, place);
}

static bool single_place(strut_reader *reader, const strut_finding *finding, strut_place *place) {
  const struct {
    strut_fields *fields;
    int section;
    bool broken; /* what it depends on, too */
  } mappings[] = {
      [STRUT_ON_GROUND] = {&reader->ground, STRUT_KEY_SCENE_GROUND, false},
      [STRUT_ON_SCENE] = {&reader->top, STRUT_KEY_SCENE_NODES, false},
      [STRUT_ON_INITIAL] = {&reader->settle, STRUT_KEY_SCENE_INITIAL, false},
      [STRUT_ON_EQUILIBRIA] = {&reader->search, STRUT_KEY_SCENE_EQUILIBRIA, reader->ground.broken},
      [STRUT_ON_SOLVER] = {&reader->solver, STRUT_KEY_SCENE_SOLVER, false},
      [STRUT_ON_RUN] = {&reader->run, STRUT_KEY_SCENE_RUN, reader->run.broken},
      [STRUT_ON_OUTPUT] = {&reader->output, STRUT_KEY_SCENE_OUTPUT, reader->run.broken}};
  const char *key = finding->key;
  strut_subject subject = finding->subject;
  strut_fields *fields = mappings[subject].fields;
  int section = mappings[subject].section;
  bool measured = key && (strcmp(key, "last") == 0 || strcmp(key, "node") == 0);
  if (subject == STRUT_ON_RUN && measured) fields = &reader->measure;
  bool broken = fields->broken || mappings[subject].broken;
  if (subject == STRUT_ON_GROUND && reader->things[STRUT_THING_GROUND].source) {
    *place = ground_place(reader, finding->index, key);
    return !reader->grounds[finding->index].broken;
  }
  if (subject == STRUT_ON_GROUND && key && strcmp(key, "slope") == 0 &&
      strut_slot_of(fields, STRUT_KEY_GROUND_SLOPE)->state == STRUT_GIVEN)
    broken = false; /* it does not depend on other keys */
  if (subject == STRUT_ON_SCENE) {
    const strut_slot *slot = slot_named(fields, key);
    broken = slot && slot->state == STRUT_BROKEN;
  }
  if (!broken) *place = field_place(reader, fields, key, section);
  return !broken;
}

void strut_place_findings(strut_reader *reader, const strut_findings *findings) {
  for (size_t i = 0; i < findings->count; i++) {
    const strut_finding *finding = &findings->items[i];
    strut_place place;
    bool many = strut_subject_is_thing(finding->subject) && finding->subject != STRUT_ON_GROUND;
    bool fresh = finding->subject == STRUT_ON_SIGNAL ? signal_place(reader, finding, &place)
                 : many                              ? many_place(reader, finding, &place)
                                                     : single_place(reader, finding, &place);
    if (fresh) strut_report_error(reader, place, "%s", finding->message);
    reader->scope = NULL;
  }
  /* A finding is left out where its cause was reported; never is a scene with one accepted. */
  if (findings->count && !reader->diagnostics->count)
    strut_report_error(reader, strut_root_place(reader), "%s", findings->items[0].message);
}
