/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Stages of a path. See reader.h. */
#include <string.h>

#include "engine/scene/things.h"
#include "parser/language/read/reader.h"

int32_t strut_read_coordinate(strut_reader *reader, const strut_tree *value, const char *key,
                              strut_owner owner) {
  if (value->kind != STRUT_TREE_SCALAR) {
    strut_report_error(reader, value->place, "expected NODE.x or NODE.y for '%s' of %s, found %s",
                       key, strut_owner_text(reader, owner), strut_found(reader, value));
    return -1;
  }
  int32_t at = strut_coordinate_find(reader->scene, value->text);
  if (at < 0)
    strut_report_error(
        reader, value->place,
        "unknown coordinate '%s' in '%s' of %s, expected a node with its axis, such as "
        "%s.x",
        strut_sanitised_text(reader, value->text), key, strut_owner_text(reader, owner),
        reader->scene->node_count ? reader->scene->nodes[0].name : "node");
  return at;
}

/* A load, or a list of loads as one text, "p, q"; NULL: reported. */
static const char *read_loads(strut_reader *reader, const strut_tree *value, strut_owner owner) {
  bool list = value->kind == STRUT_TREE_LIST && value->count;
  const char *names = NULL;
  for (const strut_tree *item = list ? value->first : value; item; item = item->next) {
    int32_t load = strut_read_reference(reader, item, "load", owner, STRUT_THING_LOAD);
    if (load < 0) return NULL;
    const char *name = reader->scene->loads[load].name;
    if (names && strut_path_names_load(names, name)) {
      strut_report_error(reader, item->place, "%s names load '%s' twice",
                         strut_owner_text(reader, owner), name);
      return NULL;
    }
    names = names ? strut_arena_format(&reader->scene->arena, "%s, %s", names, name)
                  : strut_arena_text(&reader->scene->arena, name, strlen(name));
    if (!names || !list) break;
  }
  return names;
}

/* What the stage follows, and the dimension of its value; false: reported. */
static bool read_followed(strut_reader *reader, strut_fields *fields, strut_owner owner,
                          strut_path_stage *stage, strut_dimension *dimension) {
  const strut_tree *load = strut_given(fields, STRUT_KEY_STAGE_LOAD),
                   *over = strut_given(fields, STRUT_KEY_STAGE_OVER),
                   *release = strut_given(fields, STRUT_KEY_STAGE_RELEASE);
  *dimension = STRUT_DIM_NONE;
  if (load) return (stage->load = read_loads(reader, load, owner));
  if (release) return strut_read_coordinate(reader, release, "release", owner) >= 0;
  *dimension = STRUT_DIM_LENGTH;
  int32_t actuator = strut_find_thing(reader, STRUT_THING_ACTUATOR, NULL, over->text);
  if (actuator < 0) return strut_read_coordinate(reader, over, "over", owner) >= 0;
  const strut_actuator *a = &reader->scene->actuators[actuator];
  if (a->member < 0) *dimension = a->hinge >= 0 ? STRUT_DIM_ANGLE : STRUT_DIM_STIFFNESS;
  if (!a->force) return true;
  return strut_report_error(
      reader, over->place,
      "actuator '%s' in 'over' of %s gives a force, which statics leaves out; use a load", a->name,
      strut_owner_text(reader, owner));
}

/* Where it ends: 1 of a load, 0 of a release, else it must be given. */
static bool read_until(strut_reader *reader, strut_fields *fields, strut_owner owner,
                       strut_dimension dimension, strut_path_stage *stage) {
  const strut_slot *until = strut_slot_of(fields, STRUT_KEY_STAGE_UNTIL);
  bool given = until->state == STRUT_GIVEN;
  stage->until = stage->load ? 1.0 : 0.0;
  if (stage->release && given)
    return strut_report_error(reader, until->key->place,
                              "%s gives 'until' beside 'release', which ends without reaction",
                              strut_owner_text(reader, owner));
  if (stage->over && !given)
    return strut_report_error(reader, strut_slot_of(fields, STRUT_KEY_STAGE_OVER)->key->place,
                              "%s lacks 'until', the end value of '%s'",
                              strut_owner_text(reader, owner),
                              strut_sanitised_text(reader, stage->over));
  return !given || strut_read_number(reader, until->value, "until", owner, dimension,
                                     STRUT_RANGE_ANY, &stage->until);
}

/* `stop: {NODE.x: LENGTH}` */
static bool read_stop(strut_reader *reader, const strut_tree *map, strut_owner owner,
                      strut_path_stage *stage) {
  stage->stop = -1;
  if (!map) return true;
  if (map->kind != STRUT_TREE_MAP || map->count != 1)
    return strut_report_error(reader, map->place,
                              "expected {NODE.x: LENGTH} for 'stop' of %s, found %s",
                              strut_owner_text(reader, owner), strut_found(reader, map));
  stage->stop = strut_read_coordinate(reader, map->first, "stop", owner);
  if (stage->stop < 0 ||
      !strut_read_number(reader, map->first->next, "stop", owner, STRUT_DIM_LENGTH, STRUT_RANGE_ANY,
                         &stage->stop_distance))
    return false;
  if (stage->stop_distance != 0.0) return true;
  return strut_report_error(reader, map->first->next->place,
                            "'stop' of %s is 0, where the stage begins",
                            strut_owner_text(reader, owner));
}

static bool read_stage(strut_reader *reader, const strut_tree *item, int number,
                       strut_path_stage *stage) {
  strut_fields fields;
  strut_dimension dimension;
  strut_owner owner = {strut_formatted(reader, &reader->scratch, "stage %d", number), NULL};
  if (item->kind != STRUT_TREE_MAP)
    return strut_report_error(reader, item->place,
                              "expected a stage such as {load: NAME}, found %s",
                              strut_found(reader, item));
  bool fine = strut_read_object(reader, STRUT_SECTION_STAGE, item, owner, &fields, stage);
  if (fields.broken) return false;
  if (!strut_given(&fields, STRUT_KEY_STAGE_LOAD) && !stage->over && !stage->release)
    return strut_report_error(reader, item->place, "%s lacks 'load', 'over' or 'release'",
                              owner.kind);
  fine = read_followed(reader, &fields, owner, stage, &dimension) &&
         read_until(reader, &fields, owner, dimension, stage) && fine;
  return read_stop(reader, strut_given(&fields, STRUT_KEY_STAGE_STOP), owner, stage) && fine;
}

/* A release needs a coordinate that supports or earlier stages hold, and a stage before. */
static bool check_releases(strut_reader *reader, const strut_tree *item) {
  const strut_scene *scene = reader->scene;
  const strut_experiment *experiment = reader->experiment;
  bool fine = true;
  uint8_t *held =
      strut_reader_allocate(reader, &reader->scratch, 2 * scene->node_count, sizeof *held);
  if (!held) return false;
  for (size_t i = 0; i < 2 * scene->node_count; i++) held[i] = scene->nodes[i / 2].fixed[i % 2];
  for (size_t k = 0; item; item = item->next, k++) {
    const strut_path_stage *stage = &experiment->stages[k];
    for (size_t i = 0; i < stage->hold_count; i++) held[stage->hold[i]] = 1;
    int32_t over = stage->over ? strut_coordinate_find(scene, stage->over) : -1;
    if (over >= 0) held[over] = 1;
    if (!stage->release) continue;
    int32_t at = strut_coordinate_find(scene, stage->release);
    if (k == 0 || !held[at])
      fine =
          strut_report_error(reader, item->place, "stage %zu releases '%s', which %s", k + 1,
                             strut_sanitised_text(reader, stage->release),
                             held[at] ? "must have been held in a stage before" : "nothing holds");
    held[at] = 0;
  }
  return fine;
}

/* A stage must not end where the one before of the same load has ended. */
static bool check_ends(strut_reader *reader, const strut_tree *item) {
  const strut_path_stage *stage = reader->experiment->stages;
  for (size_t k = 0; item; item = item->next, k++)
    for (size_t i = k; i-- > 0 && stage[k].load;) {
      if (!stage[i].load || strcmp(stage[i].load, stage[k].load) != 0) continue;
      if (stage[i].until != stage[k].until || stage[i].stop >= 0) break;
      return strut_report_error(
          reader, item->place,
          "stage %zu ends where it starts: stage %zu took load '%s' to %g already", k + 1, i + 1,
          stage[k].load, stage[k].until);
    }
  return true;
}

void strut_read_stages(strut_reader *reader) {
  strut_experiment *experiment = reader->experiment;
  strut_fields path;
  strut_owner owner = {"the path", NULL};
  const strut_tree *value = strut_given(&reader->top, STRUT_KEY_SCENE_PATH);
  if (!value) return;
  if (value->kind != STRUT_TREE_MAP) {
    strut_report_error(reader, value->place, "expected {stages: [...]} for 'path', found %s",
                       strut_found(reader, value));
    return;
  }
  strut_read_fields(reader, STRUT_SECTION_SCENE_PATH, value, owner, &path);
  if (path.broken) return;
  strut_store(reader, &path, owner, experiment);
  const strut_tree *stages = strut_given(&path, STRUT_KEY_SCENE_PATH_STAGES);
  if (!strut_mentions(&path, STRUT_KEY_SCENE_PATH_STAGES) &&
      !strut_mentions(&path, STRUT_KEY_SCENE_PATH_FRICTION))
    strut_report_error(reader, value->place,
                       "the path lacks 'stages', expected a list of stages such as [{load: NAME}]");
  if (!stages) return;
  if (stages->kind != STRUT_TREE_LIST || !stages->count) {
    strut_report_error(reader, stages->place,
                       "expected a list of stages such as [{load: NAME}, {over: NODE.x, until: 1 "
                       "mm}], found %s",
                       strut_found(reader, stages));
    return;
  }
  experiment->stages = strut_reader_allocate(reader, &reader->scene->arena, stages->count,
                                             sizeof *experiment->stages);
  bool fine = experiment->stages;
  int number = 0;
  for (const strut_tree *item = stages->first; item && experiment->stages; item = item->next) {
    fine = read_stage(reader, item, number + 1, &experiment->stages[number]) && fine;
    number++;
  }
  fine = fine && check_releases(reader, stages->first) && check_ends(reader, stages->first);
  experiment->stage_count = fine ? (size_t)number : 0;
}
