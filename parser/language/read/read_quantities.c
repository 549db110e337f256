/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measured quantities: `quantities` of the measurement. See reader.h. */
#include <stdio.h>
#include <string.h>

#include "engine/scene/study.h"
#include "parser/language/read/programs.h"
#include "parser/language/read/read_scene.h"

static const strut_observable *row_at(size_t k) {
  return strut_observable_at((strut_column_kind)k);
}

strut_dimension strut_column_dimension(strut_column_kind kind) {
  const strut_observable *observable = strut_observable_at(kind);
  return (strut_dimension){(float)observable->kg, (float)observable->m, (float)observable->s,
                           (float)observable->angle};
}

/* What every scene has stands before the dot: the i-th of them, or NULL. */
static const strut_owner_row *group_at(size_t i) {
  for (size_t owner = 0; owner < STRUT_OWNER_COUNT; owner++) {
    const strut_owner_row *row = strut_owner_row_of((strut_channel_owner)owner);
    if (row->group && i-- == 0) return row;
  }
  return NULL;
}

static bool is(strut_piece piece, const char *word) {
  return strlen(word) == piece.length && memcmp(word, piece.text, piece.length) == 0;
}

/* The kinds of things with columns, in the order in which messages prefer them. */
static const strut_thing kinds[] = {STRUT_THING_NODE,    STRUT_THING_MEMBER, STRUT_THING_HINGE,
                                    STRUT_THING_CELL,    STRUT_THING_SLIDER, STRUT_THING_COLLISION,
                                    STRUT_THING_DISTANCE};
enum { KIND_COUNT = sizeof kinds / sizeof kinds[0] };

/* The owners that a name may refer to, and their words in messages. */
typedef struct found_owner {
  unsigned owners;  /* bits 1 << strut_channel_owner */
  bool thing;       /* some are things */
  const char *what; /* "node", "member", "hinge", "the energy" */
  int32_t
      item[STRUT_THING_COUNT]; /* the thing of each kind, where its columns are among the owners */
} found_owner;

/* Things of all kinds and the owners above, for suggestions. */
static const char *owner_name(const void *context, size_t i) {
  const strut_reader *reader = context;
  for (size_t k = 0; k < KIND_COUNT; k++) {
    size_t count = strut_thing_count(reader->scene, kinds[k]);
    if (i < count) return strut_thing_name(reader->scene, kinds[k], i);
    i -= count;
  }
  const strut_owner_row *group = group_at(i);
  return group ? group->group : NULL;
}

static bool all_known(strut_reader *reader) {
  bool known = strut_slot_of(&reader->top, STRUT_KEY_SCENE_NODES)->state == STRUT_GIVEN;
  for (size_t k = 0; k < KIND_COUNT; k++)
    known =
        known && strut_slot_of(&reader->top, strut_key_of_things(kinds[k]))->state != STRUT_BROKEN;
  return known;
}

static found_owner find_owner(strut_reader *reader, const char *kind, strut_piece name) {
  found_owner found = {.owners = 0};
  const char *text = strut_piece_text(reader, name);
  for (size_t k = 0; k < KIND_COUNT; k++) {
    const char *word = strut_thing_at(kinds[k])->word;
    if (kind && strcmp(kind, word) != 0) continue;
    int32_t item = kinds[k] == STRUT_THING_SLIDER
                       ? strut_name_map_find(&reader->things[STRUT_THING_SLIDER].names, text)
                       : strut_find_thing(reader, kinds[k], NULL, text);
    if (item < 0) continue;
    for (int owner = 0; owner < STRUT_OWNER_COUNT; owner++)
      if (strut_thing_of_owner((strut_channel_owner)owner) == kinds[k]) found.owners |= 1u << owner;
    if (!found.what) found.what = word;
    found.item[kinds[k]] = item;
    found.thing = true;
  }
  for (int owner = 0; owner < STRUT_OWNER_COUNT && !kind; owner++) {
    const strut_owner_row *row = strut_owner_row_of((strut_channel_owner)owner);
    if (!row->group || !is(name, row->group)) continue;
    found.owners |= 1u << owner;
    if (!found.what) found.what = row->phrase;
  }
  return found;
}

/* The words of some owners, one after the other, for suggestions. */
static const char *field_name(const void *context, size_t i) {
  const unsigned *owners = context;
  for (size_t k = 0; k < STRUT_COLUMN_COUNT; k++)
    if (*owners >> row_at(k)->owner & 1u && i-- == 0) return row_at(k)->word;
  return NULL;
}

/* "x, y or vx" */
static const char *field_list(unsigned owners, char *text, size_t size) {
  size_t count = 0, used = 0;
  while (field_name(&owners, count)) count++;
  text[0] = '\0';
  for (size_t i = 0; i < count && used < size; i++)
    used += (size_t)snprintf(text + used, size - used, "%s%s",
                             i == 0           ? ""
                             : i + 1 == count ? " or "
                                              : ", ",
                             field_name(&owners, i));
  return text;
}

static int refuse_owner(strut_reader *reader, const char *kind, strut_piece owner,
                        strut_refusal *refusal) {
  if (!all_known(reader)) return -1;
  const char *name = strut_piece_text(reader, owner);
  snprintf(refusal->text, sizeof refusal->text, "unknown %s '%.40s'%s",
           kind                         ? kind
           : reader->scene->hinge_count ? "node, member or hinge"
                                        : "node or member",
           name, strut_hint(reader, name, owner_name, reader));
  return -1;
}

static int refuse_field(strut_reader *reader, const found_owner *found, strut_piece owner,
                        strut_piece field, strut_refusal *refusal) {
  char list[200];
  bool thing = found->thing;
  const char *hint =
      strut_hint(reader, strut_piece_text(reader, field), field_name, &found->owners);
  snprintf(refusal->text, sizeof refusal->text, "%s%s%.40s%s has no column '%.40s'%s%s%s",
           found->what, thing ? " '" : "", thing ? strut_piece_text(reader, owner) : "",
           thing ? "'" : "", strut_piece_text(reader, field), hint, *hint ? "" : ", expected ",
           *hint ? "" : field_list(found->owners, list, sizeof list));
  return -1;
}

static bool has_contact(const strut_scene *scene, int32_t node) {
  for (size_t i = 0; i < scene->contact_count; i++)
    if (scene->contacts[i].node == node) return true;
  return false;
}

static bool touches(strut_reader *reader, strut_column_kind kind, int32_t node,
                    strut_refusal *refusal) {
  const strut_scene *scene = reader->scene;
  bool of_contact = strut_observable_at(kind)->owner == STRUT_OWNER_CONTACT;
  if (!of_contact && kind != STRUT_COLUMN_HEIGHT) return true;
  const strut_slot *ground = strut_slot_of(&reader->top, STRUT_KEY_SCENE_GROUND);
  const strut_slot *grounds = strut_slot_of(&reader->top, STRUT_KEY_SCENE_GROUNDS);
  if (ground->state == STRUT_BROKEN || grounds->state == STRUT_BROKEN || reader->ground.broken)
    return false; /* reported */
  if (ground->state == STRUT_ABSENT && grounds->state == STRUT_ABSENT)
    snprintf(refusal->text, sizeof refusal->text,
             "there is no ground, so node '%s' has no '%s'; add 'ground' to the scene",
             scene->nodes[node].name, strut_observable_at(kind)->word);
  else if (of_contact && !has_contact(scene, node))
    snprintf(refusal->text, sizeof refusal->text,
             "node '%s' does not touch the ground, so it has no '%s'; list it in 'nodes' "
             "of the ground",
             scene->nodes[node].name, strut_observable_at(kind)->word);
  else
    return true;
  return false;
}

/* A word alone: time, or a thing whose column is missing. */
static int find_word(strut_reader *reader, strut_piece word, strut_column *column,
                     strut_dimension *dimension, strut_refusal *refusal) {
  char list[200];
  for (size_t k = 0; k < STRUT_COLUMN_COUNT; k++)
    if (row_at(k)->owner == STRUT_OWNER_RUN && is(word, row_at(k)->word)) {
      column->kind = (strut_column_kind)k;
      *dimension = strut_column_dimension((strut_column_kind)k);
      if (k != STRUT_COLUMN_LEAST_GAP || reader->setup->scene.collision_count) return 1;
      snprintf(refusal->text, sizeof refusal->text, "'%s' is of collisions, and the scene has none",
               row_at(k)->word);
      return -1;
    }
  if (strut_find_variable(reader, word, column, dimension)) return column->item >= 0 ? 1 : -1;
  found_owner found = find_owner(reader, NULL, word);
  if (!found.owners) return 0;
  const char *name = strut_piece_text(reader, word);
  snprintf(refusal->text, sizeof refusal->text,
           "'%.40s' alone is not a number; write '%.40s.' and %s", name, name,
           field_list(found.owners, list, sizeof list));
  return -1;
}

static int find_anywhere(void *context, const char *kind, strut_piece owner, strut_piece field,
                         strut_column *column, strut_dimension *dimension, strut_refusal *refusal) {
  strut_reader *reader = context;
  if (kind && strcmp(kind, "rate") == 0)
    return strut_find_sensor_rate(reader, owner, column, dimension, refusal);
  if (!owner.length && !kind) return find_word(reader, field, column, dimension, refusal);
  found_owner found = find_owner(reader, kind, owner);
  if (!found.owners && !kind &&
      strut_find_variable(reader, strut_whole_name(owner, field), column, dimension))
    return column->item >= 0 ? 1 : -1;
  if (!found.owners) return refuse_owner(reader, kind, owner, refusal);
  int count = 0;
  for (size_t k = 0; k < STRUT_COLUMN_COUNT; k++) {
    if (!(found.owners >> row_at(k)->owner & 1u) || !is(field, row_at(k)->word)) continue;
    count++;
    column->kind = (strut_column_kind)k;
    *dimension = strut_column_dimension((strut_column_kind)k);
  }
  if (!count) return refuse_field(reader, &found, owner, field, refusal);
  if (count > 1) {
    bool hinges = reader->scene->hinge_count > 0;
    char text[80];
    const char *name = strut_piece_text(reader, owner);
    snprintf(text, sizeof text, " or hinge(%.40s)", name);
    snprintf(
        refusal->text, sizeof refusal->text, "%s",
        strut_scratch_text(
            reader,
            "'%.40s.%.40s' means two things, since a node%s is called '%.40s'; rename it, or write "
            "node(%.40s)%smember(%.40s)%s for it",
            name, strut_piece_text(reader, field),
            hinges ? ", a member or a hinge" : " or a member", name, name, hinges ? ", " : " or ",
            name, hinges ? text : ""));
    return -1;
  }
  strut_channel_owner of = strut_observable_at(column->kind)->owner;
  strut_thing thing = strut_thing_of_owner(of);
  if (thing < STRUT_THING_COUNT) column->item = found.item[thing];
  return 1;
}

/* Where contacts are known. */
static int find_column(void *context, const char *kind, strut_piece owner, strut_piece field,
                       strut_column *column, strut_dimension *dimension, strut_refusal *refusal) {
  int found = find_anywhere(context, kind, owner, field, column, dimension, refusal);
  if (found <= 0) return found;
  strut_channel_owner of = strut_observable_at(column->kind)->owner;
  if (of != STRUT_OWNER_NODE && of != STRUT_OWNER_CONTACT) return 1;
  return touches(context, column->kind, column->item, refusal) ? 1 : -1;
}

static int find_pair(void *context, strut_piece word, strut_piece first, strut_piece second,
                     strut_column *column, strut_dimension *dimension, strut_refusal *refusal) {
  strut_reader *reader = context;
  const strut_piece names[2] = {first, second};
  int32_t node[2];
  for (size_t k = 0; k < STRUT_COLUMN_COUNT; k++)
    if (row_at(k)->owner == STRUT_OWNER_PAIR && is(word, row_at(k)->word)) {
      column->kind = (strut_column_kind)k;
      *dimension = strut_column_dimension((strut_column_kind)k);
    }
  for (int k = 0; k < 2; k++) {
    const char *name = strut_piece_text(reader, names[k]);
    node[k] = strut_find_thing(reader, STRUT_THING_NODE, NULL, name);
    if (node[k] >= 0) continue;
    if (all_known(reader))
      snprintf(refusal->text, sizeof refusal->text, "unknown node '%.40s'%s", name,
               strut_hint_of_things(reader, name, STRUT_THING_NODE));
    return -1;
  }
  if (node[0] == node[1]) {
    snprintf(refusal->text, sizeof refusal->text, "'%.*s' needs two different nodes",
             (int)word.length, word.text);
    return -1;
  }
  column->item = node[0], column->other = node[1];
  return 1;
}

static strut_instruction *keep_program(strut_reader *reader, const strut_compiler *compiler) {
  strut_instruction *program = strut_keep_array(reader, compiler->length, sizeof *program);
  for (size_t i = 0; i < compiler->length && program; i++) {
    const strut_compiled *from = &compiler->program[i];
    program[i] = from->instruction;
    if (from->instruction.operation == STRUT_OPERATION_NUMBER)
      program[i].unit = strut_keep_unit(reader, from->dimension, NULL);
  }
  return program;
}

strut_instruction *strut_compile(strut_reader *reader, const strut_tree *value, const char *key,
                                 strut_owner owner, strut_compiler *compiler,
                                 strut_quantity *quantity) {
  compiler->context = reader;
  compiler->program =
      strut_scratch_array(reader, strlen(value->text) + 1, sizeof *compiler->program);
  if (!compiler->program) return NULL;
  if (strut_read_program(reader, value, key, owner, compiler, quantity))
    return keep_program(reader, compiler);
  reader->failed = true;
  return NULL;
}

strut_instruction *strut_read_column(strut_reader *reader, const strut_tree *value, const char *key,
                                     strut_owner owner, strut_column *column) {
  strut_compiler compiler = {.column = find_anywhere, .pair = find_pair};
  strut_quantity q;
  strut_instruction *program = strut_compile(reader, value, key, owner, &compiler, &q);
  if (!program) return NULL;
  *column = program->column;
  if (compiler.length == 1 && q.varies) return program;
  strut_report_error(reader, value->place,
                     "expected one column of the motion for '%s' of %s, such as com.vy, NODE.y or "
                     "MEMBER.force; what follows from several is an expression of a signal",
                     key, strut_owner_text(reader, owner));
  return NULL;
}

/* The expression; *dimension is that of its values. */
static bool read_expression(strut_reader *reader, const strut_tree *value, strut_owner owner,
                            strut_quantity_definition *definition, strut_dimension *dimension) {
  strut_compiler compiler = {.column = find_column, .pair = find_pair};
  strut_quantity q;
  definition->program = strut_compile(reader, value, "of", owner, &compiler, &q);
  if (!definition->program) return false;
  if (!q.varies)
    return strut_report_error(
        reader, value->place,
        "'of' of %s does not change in time, expected a column of the motion such as com.vy, "
        "NODE.y or MEMBER.force",
        strut_owner_text(reader, owner));
  definition->length = compiler.length;
  definition->depth = compiler.depth;
  *dimension = q.bare ? STRUT_DIM_NONE : q.dimension;
  return true;
}

/* Without a unit the accuracy is relative, otherwise absolute. */
static void read_accuracy(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                          strut_dimension dimension, bool known,
                          strut_quantity_definition *definition) {
  char expected[120], found[80];
  strut_quantity q;
  if (slot->state != STRUT_GIVEN || !strut_read_any_quantity(reader, slot->value, "accuracy", owner,
                                                             "a number such as '1 %'", &q))
    return;
  bool relative = q.bare || strut_dimension_equal(q.dimension, STRUT_DIM_NONE);
  bool plain = strut_dimension_equal(dimension, STRUT_DIM_NONE);
  if (!relative && known && !strut_dimension_equal(q.dimension, dimension))
    strut_report_error(
        reader, slot->value->place,
        "expected a number without unit such as '1 %%'%s%s for 'accuracy' of %s, found %s",
        plain ? "" : " or ",
        plain ? "" : strut_dimension_name(dimension, expected, sizeof expected),
        strut_owner_text(reader, owner), strut_dimension_name(q.dimension, found, sizeof found));
  else if (strut_check_limits(reader, slot->value, "accuracy", owner,
                              relative ? strut_key_at(STRUT_KEY_QUANTITY_ACCURACY)->limits
                                       : STRUT_WITHIN(ABOVE_ZERO),
                              q.value))
    definition->accuracy = q.value, definition->accuracy_unit = relative ? NULL : definition->unit;
}

/* The value that an arrival waits for, of the expression's dimension; NULL: that is not known. */
static void read_target(strut_reader *reader, strut_fields *fields,
                        const strut_dimension *dimension, strut_quantity_definition *definition) {
  const strut_slot *slot = strut_slot_of(fields, STRUT_KEY_QUANTITY_TARGET);
  bool wanted = definition->take == STRUT_TAKE_ARRIVAL, given = slot->state == STRUT_GIVEN;
  if (slot->state == STRUT_BROKEN) return;
  if (!given && wanted)
    strut_report_error(reader, fields->key->place, "%s lacks 'target', the value that it waits for",
                       strut_owner_text(reader, fields->owner));
  if (!given || !wanted || !dimension) return;
  strut_read_number(reader, slot->value, "target", fields->owner, *dimension, STRUT_WITHIN(ANY),
                    &definition->target);
  definition->target_unit = strut_keep_unit(reader, *dimension, "1");
}

bool strut_ends_at_comma(strut_reader *reader, const strut_tree *of, const char *key,
                         strut_owner owner) {
  int open = 0;
  if (!of || of->kind != STRUT_TREE_SCALAR || of->quoted) return false;
  for (const char *c = of->text; *c; c++) open += *c == '(' ? 1 : *c == ')' ? -1 : 0;
  return open > 0 && of->next &&
         !strut_report_error(
             reader, of->place,
             "in '%s' of %s: the text ends here, since a comma ends it within '{...}'; put the "
             "whole expression in quotes",
             key, strut_owner_text(reader, owner));
}

/* A moment is no energy, though the dimension is that of one. */
static bool is_moment(const strut_quantity_definition *definition) {
  return definition->length == 1 && definition->program[0].operation == STRUT_OPERATION_COLUMN &&
         definition->program[0].column.kind == STRUT_COLUMN_MOMENT &&
         definition->take != STRUT_TAKE_RATE && definition->take != STRUT_TAKE_ARRIVAL;
}

static void read_quantity(strut_reader *reader, const strut_tree *key,
                          strut_quantity_definition *definition) {
  strut_owner owner = {"quantity", key->text};
  strut_dimension dimension = STRUT_DIM_NONE;
  strut_fields fields = {.section = STRUT_SECTION_QUANTITY};
  const strut_tree *of = key->next;
  bool map = of->kind == STRUT_TREE_MAP;
  if (strut_ends_at_comma(reader, map ? strut_tree_find(of, "of", NULL) : of, "of", owner)) return;
  if (map) {
    strut_read_fields_of(reader, STRUT_SECTION_QUANTITY, key, owner, &fields);
    strut_require(reader, &fields, key->place);
    of = strut_given(&fields, STRUT_KEY_QUANTITY_OF);
  } else if (!strut_read_scalar(reader, of, key->text, (strut_owner){"the quantities", NULL},
                                "an expression such as com.vy, or a mapping such as {of: com.vy, "
                                "take: max}")) {
    return;
  }
  bool known = of && read_expression(reader, of, owner, definition, &dimension);
  strut_store(reader, &fields, definition);
  if (of && map) read_target(reader, &fields, known ? &dimension : NULL, definition);
  if (definition->take == STRUT_TAKE_RATE) dimension.s -= 1.0f;
  if (definition->take == STRUT_TAKE_ARRIVAL) dimension = STRUT_DIM_TIME;
  definition->unit = is_moment(definition) ? "N m" : strut_keep_unit(reader, dimension, "1");
  read_accuracy(reader, strut_slot_of(&fields, STRUT_KEY_QUANTITY_ACCURACY), owner, dimension,
                known, definition);
}

/* The name becomes a column of a study's table and a word of `keep`. */
static bool may_be_called(strut_reader *reader, const strut_tree *key) {
  if (!strut_read_name(reader, key, "quantity")) return false;
  return strut_keep_find(key->text, STRUT_COMPUTE_RUN) < 0 ||
         strut_report_error(
             reader, key->place,
             "a quantity cannot be called '%s', since 'keep' of a study means something else by it",
             key->text);
}

void strut_read_quantities(strut_reader *reader, const strut_slot *slot) {
  strut_experiment *experiment = reader->experiment;
  if (slot->state != STRUT_GIVEN) return;
  const strut_tree *map = slot->value;
  experiment->quantities = strut_keep_array(reader, map->count, sizeof *experiment->quantities);
  if (!experiment->quantities) return;
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    strut_quantity_definition *definition = &experiment->quantities[experiment->quantity_count++];
    definition->name = strut_keep_text(reader, key->text);
    definition->unit = "1";
    if (may_be_called(reader, key)) read_quantity(reader, key, definition);
  }
}

/* The declaration of a parameter of the scene that is read, or of `source`. False: there is none. */
static bool find_declared(strut_reader *reader, const strut_scene_source *source, const char *name,
                          strut_declared *declared) {
  const strut_declared *of_source = source ? strut_scene_source_parameter(source, name) : NULL;
  const strut_parameter_state *own = source ? NULL : strut_parameter_find(reader, name);
  if (of_source) *declared = *of_source;
  if (own) *declared = strut_declaration_of(own);
  return of_source || own;
}

static bool check_derivative(strut_reader *reader, const strut_tree *list, const strut_tree *item,
                             strut_owner owner, const strut_scene_source *source,
                             strut_declared *declared) {
  static const char key[] = "derivatives";
  if (!strut_read_scalar(reader, item, key, owner, "a parameter of the scene")) return false;
  for (const strut_tree *other = list->first; other != item; other = other->next)
    if (other->kind == STRUT_TREE_SCALAR && strcmp(other->text, item->text) == 0)
      return strut_report_error(reader, item->place, "'%s' appears twice in '%s' of %s",
                                strut_sanitised_text(reader, item->text), key,
                                strut_owner_text(reader, owner));
  bool found = find_declared(reader, source, item->text, declared);
  if (found && !declared->text) return true;
  const strut_named_rows *names = source ? STRUT_NAMED(source->parameters, source->parameter_count)
                                         : STRUT_NAMED(reader->parameters, reader->parameter_count);
  const char *hint = found ? "; it is a text" : strut_hint_of_rows(reader, item->text, names);
  return strut_report_error(
      reader, item->place,
      "expected a number of the %s's 'parameters' for '%s' of %s, found '%s'%s",
      source ? "model" : "scene", key, strut_owner_text(reader, owner),
      strut_sanitised_text(reader, item->text), hint);
}

size_t strut_read_derivatives(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                              const strut_scene_source *source, strut_derived_by **list) {
  size_t count = 0;
  if (slot->state != STRUT_GIVEN) return 0;
  *list = strut_keep_array(reader, slot->value->count, sizeof **list);
  for (const strut_tree *item = slot->value->first; item && *list; item = item->next) {
    strut_declared declared = {0};
    if (!check_derivative(reader, slot->value, item, owner, source, &declared)) continue;
    (*list)[count++] =
        (strut_derived_by){strut_keep_text(reader, item->text),
                           declared.bare ? "1" : strut_keep_unit(reader, declared.dimension, "1")};
  }
  return count;
}
