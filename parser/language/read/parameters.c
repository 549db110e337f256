/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What many things share: parameters, evaluated on demand, in any order; groups of keys. See reader.h. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/language/expression/expression_parts.h"
#include "parser/language/read/reader.h"
#include "parser/language/read/reuse/copies.h"

/* The name with that number, for suggestions. */
static const char *parameter_name(const void *context, size_t i) {
  const strut_reader *reader = context;
  return i < reader->parameter_count ? reader->parameters[i].name : NULL;
}

strut_parameter_state *strut_parameter_find(const strut_reader *reader, const char *name) {
  int32_t index = strut_name_map_find(&reader->parameter_names, name);
  return index < 0 ? NULL : &reader->parameters[index];
}

/* The place of the expression that is being evaluated, for errors that its text does not show. */
static strut_place asking_place(strut_reader *reader) {
  if (!reader->asking_set) return reader->asking->place;
  const strut_parameter_state *parameters = strut_parameter_find(reader, reader->asking_set);
  return parameters->set->place.line ? parameters->set->place : parameters->key->place;
}

static const char *stacked_name(strut_reader *reader, size_t i) {
  return reader->parameter_stack[i]->name;
}

/* Reports the cycle that leads back to p, at the place of p's expression. */
static void report_cycle(strut_reader *reader, const strut_parameter_state *parameters) {
  size_t first = 0;
  bool given = parameters->set && !parameters->set->known && parameters->set->place.line;
  while (reader->parameter_stack[first] != parameters) first++;
  strut_report_error(reader, given ? parameters->set->place : parameters->key->place,
                     "parameter '%s' depends on itself: %s", parameters->name,
                     strut_format_cycle(reader, stacked_name, first, reader->parameter_depth));
}

/* Reports a wrong setting: where the study gives it; for --set, or a number to differentiate by, at the declaration. */
static void report_setting(strut_reader *reader, const strut_setting *set, strut_place declared,
                           const char *message) {
  if (set->place.line)
    strut_report_error(reader, set->place, "in '%s' of the study: %s",
                       strut_sanitised_text(reader, set->name), message);
  else if (set->known)
    strut_report_error(reader, declared, "%s", message);
  else
    strut_report_error(reader, declared, "--set %s=%s: %s", strut_sanitised_text(reader, set->name),
                       strut_sanitised_text(reader, set->text), message);
}

static bool evaluate_set(strut_reader *reader, strut_parameter_state *parameters) {
  if (parameters->set->known) {
    parameters->quantity = (strut_quantity){.value = parameters->set->value,
                                            .dimension = parameters->set->dimension,
                                            .bare = parameters->set->bare};
    return true;
  }
  strut_expression_error error = {0};
  strut_scope scope = strut_parameter_scope(reader);
  const char *before = reader->asking_set;
  reader->asking_set = parameters->name;
  bool fine =
      strut_expression_evaluate(parameters->set->text, &scope, &parameters->quantity, &error);
  reader->asking_set = before;
  if (!fine && error.message[0])
    report_setting(reader, parameters->set, parameters->key->place, error.message);
  return fine;
}

/* Notes that a number without unit is in SI units, where it differs from the declared value by more
   than a factor of 100, or is an angle above 45 deg: then a unit was probably forgotten. */
static void note_scale(strut_reader *reader, const strut_parameter_state *parameters,
                       const strut_quantity *declared) {
  double times = fabs(parameters->quantity.value / declared->value);
  const char *unit = strut_unit_of_text(parameters->value->text, NULL).name;
  const char *given = parameters->set->text;
  bool wide = unit && strcmp(unit, "deg") == 0 && fabs(parameters->quantity.value) > STRUT_TAU / 8;
  bool far = times > 100.0 * (1.0 + 1e-9) || times < 0.01 * (1.0 - 1e-9);
  if (parameters->set->place.line || !(far || wide)) return;
  if (declared->value == 0.0 || parameters->quantity.value == 0.0) return;
  strut_note(reader->diagnostics, parameters->value->place,
             "--set %s=%s is taken as %s in SI units, %.6g times the %s here, since a plain number "
             "is in SI units; write --set %s=\"%s %s\" if that is meant",
             parameters->name, strut_sanitised_text(reader, given), given, times,
             parameters->value->text, parameters->name, strut_sanitised_text(reader, given),
             unit ? unit : "UNIT");
}

/* Does what is given fit what is declared? A bare value takes the declared dimension. */
static bool adopt_dimension(strut_reader *reader, strut_parameter_state *parameters,
                            const strut_quantity *declared) {
  char expected[200], found[80], message[320];
  if (declared->bare) return true;
  if (parameters->quantity.bare) {
    parameters->quantity.bare = false;
    parameters->quantity.dimension = declared->dimension;
    if (parameters->set) note_scale(reader, parameters, declared);
  }
  if (strut_dimension_equal(parameters->quantity.dimension, declared->dimension)) return true;
  strut_expected_number(declared->dimension, expected, sizeof expected);
  strut_dimension_name(parameters->quantity.dimension, found, sizeof found);
  if (!parameters->set)
    return strut_report_error(reader, parameters->of_part->given->place,
                              "expected %s for '%s' in 'set', found %s", expected, parameters->name,
                              found);
  snprintf(message, sizeof message, "expected %s, found %s", expected, found);
  report_setting(reader, parameters->set, parameters->key->place, message);
  return false;
}

strut_parameter_state *strut_parameter_in_scope(const strut_reader *reader, const strut_copy *scope,
                                                const char *name) {
  for (; scope; scope = scope->home) {
    for (size_t i = 0; i < scope->parameter_count; i++)
      if (strcmp(scope->parameters[i].name, name) == 0) return &scope->parameters[i];
    if (scope->closed) return NULL;
  }
  return strut_parameter_find(reader, name);
}

bool strut_text_parameter(const strut_reader *reader, const strut_copy *scope, const char *name,
                          strut_tree *text) {
  strut_parameter_state *parameter = strut_parameter_in_scope(reader, scope, name);
  if (!parameter || !parameter->text || parameter->state != STRUT_READ) return false;
  const strut_part_value *of_part = parameter->of_part;
  const strut_setting *set = parameter->set;
  parameter->used = true;
  *text = of_part && of_part->given ? *of_part->given : *parameter->value;
  if (of_part && of_part->given) /* itself the name of one, maybe */
    (void)strut_text_parameter(reader, of_part->given_scope, of_part->given->text, text);
  if (set)
    *text = (strut_tree){.text = set->text,
                         .place = set->place.line ? set->place : parameter->key->place};
  return true;
}

/* The number i or j of a copy, within the keys of its placement. */
static bool copy_number(const strut_reader *reader, const char *name, strut_quantity *quantity) {
  int which = strcmp(name, "i") == 0 ? 0 : strcmp(name, "j") == 0 ? 1 : 2;
  for (const strut_copy *scope = reader->scope; scope && which < 2; scope = scope->home) {
    if (which < scope->numbers) {
      *quantity = (strut_quantity){.value = (double)scope->number[which], .bare = true};
      return true;
    }
    if (scope->closed) break;
  }
  return false;
}

/* Is the name kept for the number of a copy? It is in a scene that places parts. */
static bool is_copy_number(const strut_reader *reader, const char *name) {
  const strut_slot *place = strut_slot_of((strut_fields *)&reader->top, STRUT_KEY_SCENE_PLACE);
  return place->key && (strcmp(name, "i") == 0 || strcmp(name, "j") == 0);
}

/* A value in `set` of a placement. */
static bool read_given(strut_reader *reader, strut_parameter_state *parameters) {
  strut_copy *before = reader->scope;
  reader->scope = parameters->of_part->given_scope;
  bool fine = strut_read_quantity(reader, parameters->of_part->given, parameters->name,
                                  (strut_owner){"'set'", NULL}, &parameters->quantity);
  reader->scope = before;
  return fine;
}

void strut_resolve_parameter(strut_reader *reader, strut_parameter_state *parameters) {
  if (parameters->state != STRUT_UNREAD) return;
  if (reader->parameter_depth >= STRUT_DEEPEST_PARAMETER) {
    strut_report_error(reader, parameters->key->place,
                       "parameters depend on each other more than %d deep",
                       STRUT_DEEPEST_PARAMETER);
    parameters->state = STRUT_FAILED;
    return;
  }
  reader->parameter_stack[reader->parameter_depth++] = parameters;
  parameters->state = STRUT_READING;
  strut_quantity declared;
  strut_copy *before = reader->scope;
  reader->scope = parameters->of_part ? parameters->of_part->scope : NULL;
  bool fine = strut_read_quantity(reader, parameters->value, parameters->name,
                                  (strut_owner){"the parameters", NULL}, &declared);
  reader->scope = before;
  bool given = parameters->of_part && parameters->of_part->given;
  if (given)
    fine = fine && read_given(reader, parameters);
  else if (parameters->set)
    fine = evaluate_set(reader, parameters) && fine;
  else if (fine)
    parameters->quantity = declared;
  fine = fine && ((!given && !parameters->set) || adopt_dimension(reader, parameters, &declared));
  if (parameters->state == STRUT_READING) parameters->state = fine ? STRUT_READ : STRUT_FAILED;
  reader->parameter_depth--;
}

static int look_up_parameter(void *context, const char *name, size_t length,
                             strut_quantity *quantity) {
  strut_reader *reader = context;
  char text[STRUT_LONGEST_NAME + 1];
  if (length >= sizeof text) return 0;
  memcpy(text, name, length);
  text[length] = '\0';
  strut_parameter_state *parameters = strut_parameter_in_scope(reader, reader->scope, text);
  if (!parameters && copy_number(reader, text, quantity)) return 1;
  if (!parameters && is_copy_number(reader, text)) {
    strut_report_error(reader, asking_place(reader),
                       "'%s', the number of a copy, is known in the keys of a repeated placement "
                       "and in its 'next', but neither in its 'count' nor within the part; 'set' "
                       "of the placement gives it to a parameter of the part",
                       text);
    return -1;
  }
  if (!parameters) return 0;
  parameters->used = true;
  if (parameters->text) {
    strut_report_error(reader, asking_place(reader),
                       "parameter '%s' is a text, expected a number here", parameters->name);
    return -1;
  }
  strut_resolve_parameter(reader, parameters);
  if (parameters->state == STRUT_READING) {
    report_cycle(reader, parameters);
    parameters->state = STRUT_FAILED;
  }
  if (parameters->state == STRUT_FAILED) return -1;
  *quantity = parameters->quantity;
  return 1;
}

strut_scope strut_parameter_scope(strut_reader *reader) {
  return (strut_scope){look_up_parameter, parameter_name, reader, !strut_hints_left(reader),
                       strut_diagnostics_full(reader->diagnostics)};
}

/* A parameter's name must be an identifier, and no function: expressions refer to it. */
static bool check_parameter_name(strut_reader *reader, const strut_tree *key) {
  const char *c = key->text;
  size_t length = strlen(c);
  if (!strut_read_name(reader, key, "parameter")) return false;
  if (strcmp(c, "pi") == 0 || strut_function_find(c, length))
    return strut_report_error(reader, key->place,
                              "'%s' cannot be the name of a parameter: expressions use it", c);
  if (is_copy_number(reader, c))
    return strut_report_error(
        reader, key->place,
        "'%s' cannot be the name of a parameter in a scene that places parts: it is "
        "the number of a copy",
        c);
  if (!strchr(STRUT_DIGITS, *c) && strspn(c, STRUT_LETTERS STRUT_DIGITS) == length) return true;
  return strut_report_error(reader, key->place,
                            "'%s' cannot be the name of a parameter, expected a letter, then "
                            "letters, digits and '_', so that it can stand in expressions",
                            c);
}

void strut_declare_parameter(strut_reader *reader, const strut_tree *key,
                             strut_parameter_state *parameters) {
  const strut_tree *value = key->next;
  *parameters = (strut_parameter_state){.name = key->text, .key = key, .value = value};
  bool fine = check_parameter_name(reader, key);
  fine = strut_read_scalar(reader, value, key->text, (strut_owner){"the parameters", NULL},
                           "an expression or a quoted text") &&
         fine;
  parameters->text = value->kind == STRUT_TREE_SCALAR && value->quoted;
  parameters->state = fine ? (parameters->text ? STRUT_READ : STRUT_UNREAD) : STRUT_FAILED;
}

static void apply_setting(strut_reader *reader, const strut_setting *setting) {
  strut_parameter_state *parameters = strut_parameter_find(reader, setting->name);
  char message[300];
  if (!parameters) {
    snprintf(message, sizeof message, "the scene has no parameter '%s'%s",
             strut_sanitised_text(reader, setting->name),
             strut_hint(reader, setting->name, parameter_name, reader));
    const strut_tree *key = strut_slot_of(&reader->top, STRUT_KEY_SCENE_PARAMETERS)->key;
    report_setting(reader, setting, key ? key->place : strut_root_place(reader), message);
  } else if (parameters->set) {
    strut_report_error(reader, setting->place.line ? setting->place : parameters->key->place,
                       "%s%s is given twice", setting->place.line ? "" : "--set ",
                       parameters->name);
  } else {
    parameters->set = setting;
  }
}

void strut_read_parameters(strut_reader *reader, const strut_setting *settings, size_t count) {
  const strut_slot *slot = strut_slot_of(&reader->top, STRUT_KEY_SCENE_PARAMETERS);
  bool known = slot->state != STRUT_BROKEN;
  const strut_tree *map = strut_given(&reader->top, STRUT_KEY_SCENE_PARAMETERS);
  reader->parameters =
      strut_scratch_array(reader, map ? map->count : 0, sizeof *reader->parameters);
  if (!reader->parameters) return;
  for (const strut_tree *key = map ? map->first : NULL; key; key = key->next->next) {
    strut_declare_parameter(reader, key, &reader->parameters[reader->parameter_count]);
    strut_add_name(reader, &reader->parameter_names, key->text, reader->parameter_count++);
  }
  for (size_t i = 0; known && i < count; i++) apply_setting(reader, &settings[i]);
  for (size_t i = 0; i < reader->parameter_count; i++)
    strut_resolve_parameter(reader, &reader->parameters[i]);
}

void strut_keep_parameters(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  bool point = false; /* of a study, whose figures have the units of the study: no time is spent */
  for (size_t i = 0; i < reader->parameter_count; i++)
    point = point || (reader->parameters[i].set && reader->parameters[i].set->known);
  if (reader->failed) return; /* the scene will be discarded */
  scene->parameters = strut_keep_array(reader, reader->parameter_count, sizeof *scene->parameters);
  for (size_t i = 0; scene->parameters && i < reader->parameter_count; i++) {
    const strut_parameter_state *parameters = &reader->parameters[i];
    if (parameters->value->kind != STRUT_TREE_SCALAR) return; /* reported */
    const char *declared = parameters->value->text;
    const char *text = parameters->set ? parameters->set->text : declared;
    strut_parameter *kept = &scene->parameters[scene->parameter_count++];
    kept->name = strut_arena_text(&scene->arena, parameters->name, strlen(parameters->name));
    kept->text = strut_arena_text(&scene->arena, text, strlen(text));
    kept->value = parameters->text ? (double)NAN : parameters->quantity.value;
    if (!point) kept->shown = strut_unit_of_text(text, &scene->arena);
    if (!point && !kept->shown.name) kept->shown = strut_unit_of_text(declared, &scene->arena);
    if (!kept->name || !kept->text) reader->out_of_memory = true;
  }
}

void strut_report_idle_settings(strut_reader *reader) {
  for (size_t i = 0; i < reader->parameter_count; i++) {
    const strut_parameter_state *parameters = &reader->parameters[i];
    if (!parameters->set || parameters->used) continue;
    char message[120];
    snprintf(message, sizeof message, "nothing in the scene uses parameter '%s'", parameters->name);
    report_setting(reader, parameters->set, parameters->key->place, message);
  }
}

/* ---- groups: keys of a member, a node, a contact or a hinge ---- */

enum { SECTIONS = STRUT_GROUP_SECTIONS, HINGE = 3 };

/* An earlier key of the group that belongs to the same set as `key`, or NULL. */
static const strut_tree *rival(const strut_group *group, int key) {
  int set = strut_key_at(key)->set;
  for (size_t i = 0; set && i < group->count; i++)
    if (group->items[i].key[0] >= 0 && strut_key_at(group->items[i].key[0])->set == set)
      return group->items[i].slot.key;
  return NULL;
}

/* The value as things of the section read it, in the scope of the group, once it is needed. */
static strut_slot *read_value(strut_reader *reader, const strut_group *group,
                              strut_group_item *item, size_t section) {
  bool hinge = section == HINGE && item->apart;
  strut_slot *slot = hinge ? &item->of_hinge : &item->slot;
  const strut_tree *key = item->slot.key;
  if (slot->state != STRUT_ABSENT) return slot;
  strut_copy *before = strut_enter_scope(reader, group->key);
  strut_read_slot(reader, hinge ? item->key[HINGE] : item->first, key, key->next,
                  (strut_owner){"group", group->name}, slot);
  reader->scope = before;
  return slot;
}

static void read_item(strut_reader *reader, strut_group *group, const strut_tree *key,
                      strut_owner owner) {
  strut_group_item item = {.key = {-1, -1, -1, -1}, .slot = {.key = key, .value = key->next}};
  int found = -1;
  for (size_t r = 0; r < SECTIONS; r++) {
    item.key[r] = strut_key_named(reader, strut_group_sections[r], key);
    if (found < 0) found = item.key[r];
  }
  if (found >= 0 && strut_key_at(found)->type == STRUT_TYPE_GROUPS) {
    strut_report_error(reader, key->place, "a group cannot have a group, found '%s' in %s",
                       key->text, strut_owner_text(reader, owner));
    group->broken = true;
    return;
  }
  if (found < 0) {
    int meant = strut_unknown_key(reader, key, strut_group_sections, SECTIONS, owner);
    group->broken = true;
    if (meant < 0) return;
    for (size_t r = 0; r < SECTIONS; r++)
      item.key[r] = strut_key_find(strut_group_sections[r], strut_key_at(meant)->name);
    item.slot.state = STRUT_BROKEN;
    group->items[group->count++] = item;
    return;
  }
  item.first = found;
  item.apart = item.key[HINGE] >= 0 &&
               strut_key_at(item.key[HINGE])->measure != strut_key_at(found)->measure;
  if (!item.apart) read_value(reader, group, &item, 0);
  const strut_tree *other = rival(group, found);
  if (other) {
    strut_report_error(reader, key->place, "%s gives both '%s' and '%s', expected one of them",
                       strut_owner_text(reader, owner), other->text, key->text);
    item.slot.state = item.of_hinge.state = STRUT_BROKEN;
  }
  if (item.slot.state == STRUT_GIVEN && strcmp(strut_key_at(found)->name, "friction") == 0) {
    item.nested = strut_scratch_array(reader, 1, sizeof *item.nested);
    if (!item.nested) return;
    strut_read_fields(reader, STRUT_SECTION_FRICTION, key->next,
                      (strut_owner){"the friction of group", group->name}, item.nested);
  }
  group->items[group->count++] = item;
}

static void read_group(strut_reader *reader, const strut_tree *key, strut_group *group) {
  const strut_tree *map = key->next;
  strut_owner owner = {"group", key->text};
  if (!strut_read_name(reader, key, "group")) group->broken = true;
  if (map->kind != STRUT_TREE_MAP) {
    strut_report_error(reader, map->place,
                       "expected keys of a member, a node, a contact or a hinge for %s, found %s",
                       strut_owner_text(reader, owner), strut_found(reader, map));
    group->broken = true;
    return;
  }
  group->items = strut_scratch_array(reader, map->count, sizeof *group->items);
  for (const strut_tree *tree = map->first; tree && group->items; tree = tree->next->next)
    read_item(reader, group, tree, owner);
}

size_t strut_groups_named(strut_reader *reader, const strut_tree *value, strut_group **groups) {
  size_t count = 0;
  const strut_tree *item = value->kind == STRUT_TREE_LIST ? value->first : value;
  for (; item && count < STRUT_MOST_GROUPS; item = value == item ? NULL : item->next) {
    int32_t index = item->kind == STRUT_TREE_SCALAR
                        ? strut_find_named(reader, &reader->group_names, item, item->text)
                        : -1;
    if (index >= 0) groups[count++] = &reader->groups[index];
  }
  return count;
}

void strut_read_groups(strut_reader *reader) {
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_GROUPS);
  size_t i = 0;
  if (!map) return;
  reader->groups = strut_scratch_array(reader, map->count, sizeof *reader->groups);
  STRUT_ENTRIES (reader, key, reader->groups ? map : NULL) {
    reader->groups[reader->group_count] = (strut_group){.name = key->text, .key = key};
    strut_add_name(reader, &reader->group_names, key->text, reader->group_count++);
  }
  STRUT_ENTRIES (reader, key, reader->groups ? map : NULL)
    read_group(reader, key, &reader->groups[i++]);
}

static bool check_names(strut_reader *reader, const strut_tree *value, const char *key,
                        strut_owner owner) {
  bool fine = true,
       known = strut_slot_of(&reader->top, STRUT_KEY_SCENE_GROUPS)->state != STRUT_BROKEN;
  const strut_tree *item = value->kind == STRUT_TREE_LIST ? value->first : value;
  if (value->kind == STRUT_TREE_LIST && value->count > STRUT_MOST_GROUPS)
    return strut_report_error(reader, value->place, "%s names %u groups, expected at most %d",
                              strut_owner_text(reader, owner), (unsigned)value->count,
                              STRUT_MOST_GROUPS);
  const strut_namespace names = {"group", &reader->group_names, strut_row_name,
                                 STRUT_NAMED(reader->groups, reader->group_count)};
  for (; item && known; item = value == item ? NULL : item->next) {
    if (strut_read_name_of(reader, item, key, owner, &names) < 0)
      fine = false;
    else if (strut_find_literally(reader, names.map, item, item->text) < 0)
      reader->groups_unknown = true; /* another value of the parameter may use any other group */
  }
  return fine && known;
}

/* True where the fields have the key, or another one of its set, already. */
static bool taken(strut_fields *fields, int key) {
  int set = strut_key_at(key)->set;
  if (strut_slot_of(fields, key)->state != STRUT_ABSENT) return true;
  if (!set) return false;
  int size = strut_section_size(fields->section);
  const strut_key *keys = strut_key_at(strut_section_first(fields->section));
  for (int i = 0; i < size; i++)
    if (keys[i].set == set && fields->slot[i].state != STRUT_ABSENT) return true;
  return false;
}

static void apply_group(strut_reader *reader, strut_fields *fields, strut_group *group) {
  size_t section = 0;
  while (strut_group_sections[section] != fields->section) section++;
  assert(section < SECTIONS);
  /* lengths of a group outside of a scaled copy are scaled with the thing that uses it */
  double scale = strut_scope_scale(reader, NULL);
  if (group->key->placed) scale /= strut_scope_scale(reader, group->key);
  group->used = true;
  for (size_t i = 0; i < group->count; i++) {
    strut_group_item *item = &group->items[i];
    int key = item->key[section];
    if (key >= 0) {
      if (taken(fields, key)) continue;
      const strut_slot *slot = read_value(reader, group, item, section);
      *strut_slot_of(fields, key) = *slot;
      strut_slot_of(fields, key)->from = item;
      if (strut_key_at(key)->measure == STRUT_MEASURE_LENGTH)
        strut_slot_of(fields, key)->number[0] *= scale;
      if (slot->state == STRUT_BROKEN || (item->nested && item->nested->broken))
        fields->broken = true;
    } else if (!item->refused[section]) {
      item->refused[section] = true;
      if (item->slot.state == STRUT_BROKEN) continue;
      strut_report_error(reader, item->slot.key->place,
                         "group '%s' gives '%s' to %s, but a %s has no '%s'", group->name,
                         item->slot.key->text, strut_owner_text(reader, fields->owner),
                         strut_section_name(fields->section), item->slot.key->text);
    }
  }
  if (group->broken) fields->broken = true;
}

void strut_apply_groups(strut_reader *reader, strut_fields *fields, int group_key) {
  const strut_slot *slot = strut_slot_of(fields, group_key);
  strut_group *groups[STRUT_MOST_GROUPS];
  if (slot->state == STRUT_BROKEN) {
    reader->groups_unknown = true;
    strut_suppress_missing(fields);
  }
  if (slot->state != STRUT_GIVEN) return;
  bool fine = check_names(reader, slot->value, strut_key_at(group_key)->name, fields->owner);
  size_t count = strut_groups_named(reader, slot->value, groups);
  while (count > 0) apply_group(reader, fields, groups[--count]);
  if (fine) return;
  reader->groups_unknown = true;
  fields->broken = true; /* the unknown group may have given what seems to be missing */
  strut_suppress_missing(fields);
}

/* Does some `group` of a tree name the group? Then copies that are not made would use it. */
static bool is_mentioned(const strut_tree *tree, const char *name) {
  if (!tree || tree->kind == STRUT_TREE_SCALAR) return false;
  for (const strut_tree *k = tree->first; k; k = k->next) {
    bool group = tree->kind == STRUT_TREE_MAP && strcmp(k->text, "group") == 0;
    if (tree->kind == STRUT_TREE_MAP) k = k->next;
    if (group && k->kind == STRUT_TREE_SCALAR && strcmp(k->text, name) == 0) return true;
    for (const strut_tree *item = group ? k->first : NULL; item; item = item->next)
      if (item->kind == STRUT_TREE_SCALAR && strcmp(item->text, name) == 0) return true;
    if (!group && is_mentioned(k, name)) return true;
  }
  return false;
}

void strut_report_unused_groups(strut_reader *reader) {
  for (size_t i = 0; i < reader->group_count; i++)
    for (size_t k = 0; k < reader->groups[i].count; k++) {
      strut_group_item *item = &reader->groups[i].items[k]; /* wrong values of others, too */
      if (item->of_hinge.state == STRUT_ABSENT) read_value(reader, &reader->groups[i], item, 0);
    }
  if (reader->groups_unknown || reader->top.broken) return;
  for (size_t i = 0; i < reader->group_count; i++) {
    const strut_group *group = &reader->groups[i];
    if (group->used || group->broken || group->key->placed) continue;
    if (is_mentioned(strut_slot_of(&reader->top, STRUT_KEY_SCENE_PARTS)->value, group->name) ||
        is_mentioned(strut_slot_of(&reader->top, STRUT_KEY_SCENE_PLACE)->value, group->name))
      continue;
    strut_report_error(reader, group->key->place, "nothing uses group '%s'", group->name);
  }
}
