/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sliders: masses that slide along members. See reader.h. */
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "parser/read/reader.h"

/* Reports the name of a beam, which is no member but makes some. */
static bool is_beam(strut_reader *reader, const strut_tree *value, strut_owner owner) {
  for (size_t i = 0; i < reader->beam_count && value->kind == STRUT_TREE_SCALAR; i++) {
    if (strcmp(reader->beams[i].name, value->text) != 0) continue;
    strut_report_error(reader, value->place,
                       "expected a member for 'member' of %s, found the beam '%s'; name one of its "
                       "bars, such as '%s.1'",
                       strut_owner_text(reader, owner), value->text, value->text);
    return true;
  }
  return false;
}

static double drawn_length(const strut_scene *scene, int32_t member) {
  const int32_t *node = scene->members[member].node;
  if (node[0] < 0 || node[1] < 0) return 0.0;
  return strut_distance(scene->nodes[node[0]].position, scene->nodes[node[1]].position);
}

/* A share of the member, or a length from its first node as drawn, which becomes a share. */
static bool read_position(strut_reader *reader, const strut_tree *value, strut_owner owner,
                          strut_sliding_mass *s) {
  strut_quantity q;
  char found[80];
  if (!strut_read_scalar(reader, value, "position", owner, "a number") ||
      !strut_read_quantity(reader, value, "position", owner, &q))
    return false;
  s->share = q.value;
  if (q.bare || strut_dimension_equal(q.dimension, STRUT_DIM_NONE)) return true;
  if (strut_dimension_equal(q.dimension, STRUT_DIM_LENGTH)) {
    double length = s->member >= 0 ? drawn_length(reader->scene, s->member) : 0.0;
    if (length > 0.0) s->share *= strut_scope_scale(reader, value) / length;
    return length > 0.0;
  }
  strut_report_error(
      reader, value->place,
      "expected a share such as '50 %%', or a length, for 'position' of %s, found %s",
      strut_owner_text(reader, owner), strut_dimension_name(q.dimension, found, sizeof found));
  return false;
}

static bool read_motion(strut_reader *reader, const strut_slot *slot, strut_owner owner,
                        strut_sliding_mass *s) {
  const strut_dimension share = STRUT_DIM_NONE, length = STRUT_DIM_LENGTH;
  if (slot->state != STRUT_GIVEN) return slot->state == STRUT_ABSENT;
  const char *name = s->travel ? "travel" : "moves";
  s->signal = strut_read_signal(reader, slot->value, name, owner, s->travel ? &length : &share);
  return s->signal >= 0;
}

static bool read_slider(strut_reader *reader, const strut_tree *key, strut_sliding_mass *s) {
  strut_owner owner = {"slider", s->name};
  bool fine = strut_read_name(reader, key, "slider");
  strut_fields fields;
  strut_read_fields(reader, STRUT_SECTION_SLIDER, key->next, owner, &fields);
  strut_require(reader, &fields, owner, key->place);
  const strut_slot *member = strut_slot_of(&fields, STRUT_KEY_SLIDER_MEMBER);
  const strut_slot *position = strut_slot_of(&fields, STRUT_KEY_SLIDER_POSITION);
  const strut_slot *moves = strut_slot_of(&fields, STRUT_KEY_SLIDER_MOVES);
  const strut_slot *travel = strut_slot_of(&fields, STRUT_KEY_SLIDER_TRAVEL);
  bool known = strut_slot_of(&reader->top, STRUT_KEY_SCENE_MEMBERS)->state == STRUT_GIVEN ||
               reader->beam_count > 0;
  if (member->state == STRUT_GIVEN && known && !is_beam(reader, member->value, owner))
    s->member =
        strut_read_reference(reader, member->value, "member", owner, "member",
                             &reader->member_names, strut_member_name, reader->scene->member_count);
  strut_store_fields(reader, &fields, &reader->scene->arena, s, sizeof *s);
  if (position->state == STRUT_GIVEN)
    fine = read_position(reader, position->value, owner, s) && fine;
  s->travel = travel->state == STRUT_GIVEN;
  fine = read_motion(reader, s->travel ? travel : moves, owner, s) && fine;
  return fine && !fields.broken && s->member >= 0;
}

void strut_read_sliders(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_SLIDERS);
  if (!map) return;
  scene->sliding_masses =
      strut_reader_allocate(reader, &scene->arena, map->count, sizeof *scene->sliding_masses);
  reader->slider_source =
      strut_reader_allocate(reader, &reader->scratch, map->count, sizeof *reader->slider_source);
  if (!scene->sliding_masses || !reader->slider_source) return;
  for (const strut_tree *key = strut_first_entry(reader, map); key;
       key = strut_following_entry(reader, key)) {
    size_t i = strut_next_entry(reader, &scene->sliding_count);
    scene->sliding_masses[i] = strut_sliding_mass_default();
    scene->sliding_masses[i].name = strut_keep_text(reader, key->text);
    strut_add_name(reader, &reader->slider_names, scene->sliding_masses[i].name, i);
    bool fine = read_slider(reader, key, &scene->sliding_masses[i]);
    reader->slider_source[i] = (strut_source){key, key->next, !fine};
  }
}
