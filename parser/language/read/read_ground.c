/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ground, its contacts and their friction. See reader.h. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/scene/profile.h"
#include "parser/language/read/reader.h"
#include "parser/language/read/reuse/copies.h"

/*
 * The friction of one contact while the layers (ground, groups, contact) are laid over each other: keys of all of
 * them, `mu` and those of both directions in words of the other ones.
 */
typedef struct friction_layers {
  strut_fields keys;         /* called like the top layer, */
  bool any, forward, broken; /* there is one; one has keys of a direction; one could not be read */
  int32_t signal;            /* of mu, or -1 */
  const strut_tree **reported; /* the layer whose lacks were reported last */
} friction_layers;

static strut_slot *slot_in(friction_layers *self, int key) {
  return strut_slot_of(&self->keys, key);
}

/* What the word of the slot of mu is: a number was read, or from DRIVEN on a signal. */
enum { UNREAD, PLAIN, DRIVEN };

/* `mu` of a layer, a number or a signal, read once although a group's holds for many contacts; NULL: none. */
static const strut_slot *read_mu(strut_reader *reader, strut_fields *layer) {
  strut_slot *slot = strut_slot_of(layer, STRUT_KEY_FRICTION_MU);
  const strut_tree *mu = strut_given(layer, STRUT_KEY_FRICTION_MU);
  if (mu && slot->word == UNREAD) {
    const strut_dimension plain = STRUT_DIM_NONE;
    bool signal =
        mu->kind == STRUT_TREE_MAP || (mu->kind == STRUT_TREE_SCALAR &&
                                       strut_name_map_find(&reader->signal_names, mu->text) >= 0);
    int32_t index = signal ? strut_read_signal(reader, mu, "mu", layer->owner, &plain) : -1;
    slot->number[0] = 1.0;
    bool fine = signal ? index >= 0
                       : strut_read_number(reader, mu, "mu", layer->owner, plain,
                                           STRUT_WITHIN(NOT_NEGATIVE), &slot->number[0]);
    slot->word = signal ? DRIVEN + index : PLAIN;
    if (!fine) slot->state = STRUT_BROKEN;
    layer->broken = layer->broken || !fine;
  }
  return slot->state == STRUT_GIVEN ? slot : NULL;
}

/*
 * Coefficients without a direction replace both directions of the layers below; a coefficient over a signal leaves
 * none of its own for the other.
 */
static void add_layer(strut_reader *reader, friction_layers *self, strut_fields *layer) {
  strut_check_rules(reader, layer);
  const strut_slot *mu = read_mu(reader, layer), *slots = layer->slot;
  const strut_slot *forward = strut_slot_of(layer, STRUT_KEY_FRICTION_MU_FORWARD),
                   *ahead = strut_slot_of(layer, STRUT_KEY_FRICTION_MU_FORWARD_STATIC),
                   *back = strut_slot_of(layer, STRUT_KEY_FRICTION_MU_BACKWARD),
                   *behind = strut_slot_of(layer, STRUT_KEY_FRICTION_MU_BACKWARD_STATIC);
  strut_slot *statics = slot_in(self, STRUT_KEY_FRICTION_MU_STATIC),
             *kinetics = slot_in(self, STRUT_KEY_FRICTION_MU_KINETIC);
  bool plain = mu || strut_given(layer, STRUT_KEY_FRICTION_MU_STATIC) ||
               strut_given(layer, STRUT_KEY_FRICTION_MU_KINETIC);
  bool both = mu || forward->state == STRUT_GIVEN;
  if (plain) {
    self->forward = false;
    *slot_in(self, STRUT_KEY_FRICTION_MU_BACKWARD) = (strut_slot){0};
    *slot_in(self, STRUT_KEY_FRICTION_MU_BACKWARD_STATIC) = (strut_slot){0};
  }
  if ((plain || both) && self->signal >= 0) *statics = *kinetics = (strut_slot){0};
  if (plain || both) self->signal = mu && mu->word >= DRIVEN ? mu->word - DRIVEN : -1;
  for (int i = 0; i < strut_section_size(STRUT_SECTION_FRICTION); i++)
    if (slots[i].state == STRUT_GIVEN && &slots[i] != mu && &slots[i] != forward &&
        &slots[i] != ahead)
      self->keys.slot[i] = slots[i];
  if (both) *statics = *kinetics = mu ? *mu : *forward;
  if (ahead->state == STRUT_GIVEN && statics->state == STRUT_GIVEN) *statics = *ahead;
  if (back->state == STRUT_GIVEN && behind->state != STRUT_GIVEN)
    *slot_in(self, STRUT_KEY_FRICTION_MU_BACKWARD_STATIC) = *back;
  self->forward = self->forward || forward->state == STRUT_GIVEN || ahead->state == STRUT_GIVEN ||
                  behind->state == STRUT_GIVEN;
  self->any = true;
  self->keys.map = layer->map, self->keys.owner = layer->owner;
  self->broken = self->broken || layer->broken;
}

/* Reports a key that the law needs and no layer gives, at the top layer. */
static void report_lack(strut_reader *reader, const friction_layers *self, int key) {
  char expected[200];
  bool speed = strut_key_at(key)->measure == STRUT_MEASURE_VELOCITY;
  if (*self->reported == self->keys.map) return;
  strut_report_error(reader, self->keys.map->place, "%s lacks '%s', expected %s%s",
                     strut_owner_text(reader, self->keys.owner), strut_key_at(key)->name,
                     speed ? strut_expected_number(STRUT_DIM_VELOCITY, expected, sizeof expected)
                           : "a number such as 0.5",
                     key == STRUT_KEY_FRICTION_STICK_VELOCITY ? "; 'law: coulomb' has none" : "");
}

/* Reports static friction below kinetic friction. False: there is some. */
static bool check_static_friction(strut_reader *reader, const friction_layers *self,
                                  const strut_friction *friction) {
  int way = strut_friction_holds_too_little(friction);
  if (way != 0 && *self->reported != self->keys.map)
    strut_report_error(
        reader, self->keys.map->place,
        "%s has static friction %g below kinetic friction %g, expected at least as much: a "
        "contact that gives way would be held again at once",
        strut_owner_text(reader, self->keys.owner), strut_friction_static(friction, way),
        strut_friction_kinetic(friction, way));
  return way == 0;
}

/*
 * Are all numbers given that the friction law needs? What is missing is reported once for each top layer;
 * where no coefficient is given, as one lacking key, mu.
 */
static bool has_all(strut_reader *reader, friction_layers *self, strut_friction_law law) {
  const strut_slot *statics = slot_in(self, STRUT_KEY_FRICTION_MU_STATIC),
                   *kinetics = slot_in(self, STRUT_KEY_FRICTION_MU_KINETIC);
  bool none = statics->state != STRUT_GIVEN && kinetics->state != STRUT_GIVEN;
  bool complete = true, lacks_mu = false;
  for (int p = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++) {
    int key = strut_key_find(STRUT_SECTION_FRICTION, strut_friction_key(p));
    const strut_slot *slot = slot_in(self, key);
    if (!strut_friction_needs(law, p) || slot->state == STRUT_GIVEN) continue;
    bool both = none && (slot == statics || slot == kinetics);
    if (!(both && lacks_mu)) report_lack(reader, self, both ? STRUT_KEY_FRICTION_MU : key);
    lacks_mu = lacks_mu || both;
    complete = false;
  }
  if (!self->forward || strut_given(&self->keys, STRUT_KEY_FRICTION_MU_BACKWARD)) return complete;
  report_lack(reader, self, STRUT_KEY_FRICTION_MU_BACKWARD);
  return false;
}

/* The friction that the layers make. False: that was reported. */
static bool make_friction(strut_reader *reader, friction_layers *self, strut_friction *friction) {
  *friction = (strut_friction){0};
  if (!self->any || self->broken) return !self->broken;
  strut_store(reader, &self->keys, friction);
  if (!strut_given(&self->keys, STRUT_KEY_FRICTION_LAW)) friction->law = STRUT_FRICTION_KARNOPP;
  friction->directional = strut_given(&self->keys, STRUT_KEY_FRICTION_MU_BACKWARD);
  friction->driven = self->signal >= 0;
  friction->signal = friction->driven ? self->signal : 0;
  bool fine = has_all(reader, self, friction->law) && check_static_friction(reader, self, friction);
  if (!fine) *self->reported = self->keys.map;
  return fine;
}

/* The defaults of all contacts: those of the ground. */
typedef struct ground_defaults {
  strut_contact contact;
  friction_layers friction;
  bool broken, made; /* made: that of contacts without keys of their own, which is `contact`'s */
  const strut_tree *reported;
  double along[2]; /* the direction of a line, along which forward is; else that of x */
} ground_defaults;

/* Lays the friction of the contact's groups, then its own, over the ground's. */
static void own_friction(strut_reader *reader, strut_fields *fields, friction_layers *layers) {
  const strut_slot *group = strut_slot_of(fields, STRUT_KEY_CONTACT_GROUP);
  const strut_slot *own = strut_slot_of(fields, STRUT_KEY_CONTACT_FRICTION);
  strut_group *groups[STRUT_MOST_GROUPS];
  size_t count = group->state == STRUT_GIVEN ? strut_groups_named(reader, group->value, groups) : 0;
  for (size_t g = 0; g < count; g++)
    for (size_t i = 0; i < groups[g]->count; i++)
      if (groups[g]->items[i].nested) add_layer(reader, layers, groups[g]->items[i].nested);
  if (own->state != STRUT_GIVEN || own->from) return;
  strut_fields nested;
  strut_owner mine = {"the friction of contact", fields->owner.name};
  strut_read_fields(reader, STRUT_SECTION_FRICTION, own->value, mine, &nested);
  add_layer(reader, layers, &nested);
}

/* Forward is where the part's own x points, along the ground; of a friction of the scene it is that of the ground. */
static bool turn_friction(strut_reader *reader, const strut_tree *key, const double along[2],
                          strut_friction *friction) {
  double ahead[2] = {1.0, 0.0};
  const strut_tree *own = strut_tree_find(key->next, "friction", NULL);
  if (!strut_scope_of(reader, own) || !friction->directional) return true;
  strut_place_vector(reader, NULL, ahead);
  double forward = strut_dot(ahead, along, 2);
  if (fabs(forward) < 1e-9)
    return strut_report_error(
        reader, key->place,
        "contact '%s' has a friction with a direction, but its copy stands upright "
        "on the ground; give its contact where it is placed",
        strut_local_name(reader, key->text));
  if (forward > 0.0) return true;
  double statics = friction->mu_static, kinetics = friction->mu_kinetic;
  friction->mu_static = friction->mu_static_backward,
  friction->mu_kinetic = friction->mu_kinetic_backward;
  friction->mu_static_backward = statics, friction->mu_kinetic_backward = kinetics;
  return true;
}

/* A contact with keys of its own. False: some are wrong. */
static bool read_own_keys(strut_reader *reader, const strut_tree *key, ground_defaults *defaults,
                          strut_contact *contact) {
  friction_layers layers = defaults->friction;
  strut_owner owner = {"contact", reader->scene->nodes[contact->node].name};
  strut_fields fields;
  strut_enter_scope(reader, key);
  strut_read_fields(reader, STRUT_SECTION_CONTACT, key->next, owner, &fields);
  strut_apply_groups(reader, &fields, STRUT_KEY_CONTACT_GROUP);
  strut_store(reader, &fields, contact);
  own_friction(reader, &fields, &layers);
  bool fine = make_friction(reader, &layers, &contact->friction);
  fine = turn_friction(reader, key, defaults->along, &contact->friction) && fine;
  reader->scope = NULL;
  return fine && !fields.broken;
}

static bool read_contact(strut_reader *reader, const strut_tree *key, ground_defaults *defaults,
                         strut_contact *contact) {
  if (key) return read_own_keys(reader, key, defaults, contact) && !defaults->broken;
  if (!defaults->made && !make_friction(reader, &defaults->friction, &defaults->contact.friction))
    defaults->broken = true;
  defaults->made = true;
  contact->friction = defaults->contact.friction;
  return !defaults->broken;
}

/* A node that is moved cannot touch; `all` leaves it out. */
static bool moves(const strut_reader *reader, int32_t node) {
  return reader->node_moves && reader->node_moves[node];
}

static bool mark_matches(strut_reader *reader, const strut_tree *item, strut_owner owner,
                         unsigned char *touches) {
  bool any = false;
  for (int32_t node = -1; (node = strut_next_match(reader, item, node)) >= 0; any = true)
    touches[node] = 1;
  if (!any)
    strut_report_error(reader, item->place, "no node fits '%s' in 'nodes' of %s",
                       strut_sanitised_text(reader, item->text), strut_owner_text(reader, owner));
  return any;
}

static bool mark_nodes(strut_reader *reader, strut_fields *fields, unsigned char *touches) {
  const strut_slot *slot = strut_slot_of(fields, STRUT_KEY_GROUND_NODES);
  size_t count = reader->scene->node_count;
  if (slot->state != STRUT_GIVEN || slot->value->kind == STRUT_TREE_SCALAR) {
    for (size_t i = 0; i < count; i++) touches[i] = !moves(reader, (int32_t)i);
    return slot->state != STRUT_BROKEN;
  }
  bool fine = true;
  for (const strut_tree *item = slot->value->first; item; item = item->next) {
    if (strut_is_pattern(item)) {
      fine = mark_matches(reader, item, fields->owner, touches) && fine;
      continue;
    }
    int32_t node = strut_read_reference(reader, item, "nodes", fields->owner, STRUT_THING_NODE);
    if (node < 0) {
      fine = false;
    } else if (touches[node]) {
      fine = strut_report_error(reader, item->place, "node '%s' appears twice in 'nodes' of %s",
                                item->text, strut_owner_text(reader, fields->owner));
    } else {
      touches[node] = 1;
    }
  }
  return fine;
}

/* Keys that the scene gives under the name of a copy's contact change that one. */
static void add_entry(strut_reader *reader, const strut_tree *own, const strut_tree **entry) {
  struct {
    strut_placed_tree key;
    strut_tree value;
  } *both = NULL;
  if (*entry && (*entry)->placed && own->next->kind == STRUT_TREE_MAP)
    both = strut_scratch_array(reader, 1, sizeof *both);
  if (both) {
    both->key = *(const strut_placed_tree *)*entry, both->value = *(*entry)->next;
    both->key.tree.next = &both->value;
    strut_lay_over_placed(reader, &both->value, own->next, STRUT_SECTION_CONTACT);
  }
  *entry = both ? &both->key.tree : own;
}

/* The entry in `contacts` of each node that has one. */
static bool find_entries(strut_reader *reader, strut_fields *fields, const unsigned char *touches,
                         bool complete, const strut_tree **entry) {
  const strut_slot *slot = strut_slot_of(fields, STRUT_KEY_GROUND_CONTACTS);
  bool fine = slot->state != STRUT_BROKEN;
  if (slot->state != STRUT_GIVEN) return fine;
  for (const strut_tree *key = slot->value->first; key; key = key->next->next) {
    if (strut_is_pattern(key)) {
      for (int32_t node = -1; (node = strut_next_match(reader, key, node)) >= 0;)
        if (touches[node]) add_entry(reader, key, &entry[node]);
      continue;
    }
    int32_t node = strut_read_reference(reader, key, "contacts", fields->owner, STRUT_THING_NODE);
    if (node >= 0 && touches[node]) {
      add_entry(reader, key, &entry[node]);
      continue;
    }
    fine = false;
    if (node >= 0 && moves(reader, node))
      strut_report_error(reader, key->place,
                         "node '%s' has a contact with %s, but it moves, so that it cannot touch",
                         key->text, strut_owner_text(reader, fields->owner));
    else if (node >= 0 && complete)
      strut_report_error(reader, key->place, "node '%s' has a contact, but 'nodes' of %s lacks it",
                         key->text, strut_owner_text(reader, fields->owner));
  }
  return fine;
}

/* The contacts that copies of parts bring with them. */
static bool add_copied(strut_reader *reader, unsigned char *touches, const strut_tree **entry) {
  bool fine = true;
  const strut_tree *map = reader->copies ? reader->copies->contacts : NULL;
  STRUT_ENTRIES (reader, key, map) {
    strut_owner owner = {"part", reader->scope ? reader->scope->placement->part->name : NULL};
    strut_tree name = *key;
    name.text = strut_local_name(reader, key->text);
    name.placed = false;
    int32_t node = strut_read_reference(reader, &name, "contacts", owner, STRUT_THING_NODE);
    if (node < 0) {
      fine = false;
    } else if (entry[node] && entry[node]->next->first != key->next->first) {
      fine = strut_report_error(reader, key->place,
                                "node '%s' has two different contacts, of the parts that share it",
                                reader->scene->nodes[node].name);
    } else {
      touches[node] = 1, entry[node] = key;
    }
  }
  return fine;
}

/* Contacts of one ground, in the order of their nodes. */
typedef struct contact_list {
  strut_contact *contact;
  strut_source *source;
  size_t count;
} contact_list;

/* Memory for the contacts of `nodes` nodes with all pieces. False: there are too many, which was reported. */
static bool make_contacts(strut_reader *reader, strut_fields *fields, size_t nodes, size_t pieces,
                          contact_list *list) {
  const strut_slot *profile = strut_slot_of(fields, STRUT_KEY_GROUND_PROFILE);
  double count = (double)nodes * (double)pieces;
  if (pieces > 1 && count > reader->limit_things) {
    strut_report_error(reader, profile->value->place,
                       "%zu nodes with the %zu parts of the profile of %s make %.3g contacts, at "
                       "most %.0f are possible%s",
                       nodes, pieces, strut_owner_text(reader, fields->owner), count,
                       reader->limit_things, strut_limit_hint(reader));
    fields->broken = true;
    return false;
  }
  list->contact = strut_keep_array(reader, nodes * pieces, sizeof *list->contact);
  list->source = strut_scratch_array(reader, nodes * pieces, sizeof *list->source);
  return list->contact && list->source;
}

/* The contacts of a ground with its nodes; of each node one for each convex piece. */
static void read_contacts(strut_reader *reader, strut_fields *fields, ground_defaults *defaults,
                          size_t pieces, contact_list *list) {
  size_t count = reader->scene->node_count, touching = 0;
  unsigned char *touches = strut_scratch_array(reader, count, 1);
  const strut_tree **entry = strut_scratch_array(reader, count, sizeof *entry);
  if (!touches || !entry) return;
  bool complete = mark_nodes(reader, fields, touches);
  complete = add_copied(reader, touches, entry) && complete;
  if (!find_entries(reader, fields, touches, complete, entry) || !complete) fields->broken = true;
  for (size_t i = 0; i < count; i++) touching += touches[i];
  if (!make_contacts(reader, fields, touching, pieces, list)) return;
  for (size_t i = 0; i < count; i++) {
    if (!touches[i]) continue;
    size_t c = list->count++;
    list->contact[c] = defaults->contact;
    list->contact[c].node = (int32_t)i;
    bool fine = read_contact(reader, entry[i], defaults, &list->contact[c]);
    list->source[c] = (strut_source){entry[i], entry[i] ? entry[i]->next : NULL, !fine};
    for (size_t piece = 1; piece < pieces; piece++) {
      size_t more = list->count++;
      list->contact[more] = list->contact[c];
      list->contact[more].piece = (int32_t)piece;
      list->source[more] = list->source[c];
    }
  }
}

/* Those of contacts are set. */
static void read_friction(strut_reader *reader, strut_fields *fields, ground_defaults *defaults) {
  const strut_tree *friction = strut_given(fields, STRUT_KEY_GROUND_FRICTION);
  strut_fields layer;
  defaults->friction =
      (friction_layers){.keys = {.section = STRUT_SECTION_FRICTION, .map = fields->map},
                        .signal = -1,
                        .reported = &defaults->reported};
  if (!friction) return;
  strut_owner owner = strut_owner_within(reader, "friction", fields->owner);
  strut_read_fields(reader, STRUT_SECTION_FRICTION, friction, owner, &layer);
  add_layer(reader, &defaults->friction, &layer);
}

/* ---- shape and motion ---- */

/* The slope of a line by its normal vector. */
static bool read_normal(strut_reader *reader, strut_fields *fields, strut_ground_section *section) {
  strut_ground *ground = &section->ground;
  const strut_slot *normal = strut_slot_of(fields, STRUT_KEY_GROUND_NORMAL);
  if (normal->state != STRUT_GIVEN) return true;
  const double *n = section->normal;
  if (n[0] == 0.0 && n[1] == 0.0)
    return strut_report_error(reader, normal->value->place, "the normal of %s has no direction",
                              strut_owner_text(reader, fields->owner));
  ground->slope = n[0] == 0.0 ? (n[1] > 0.0 ? 0.0 : STRUT_PI) : atan2(-n[0], n[1]);
  if (!ground->placed && n[1] < 0.0) { /* steeper than a ground without a point may be */
    ground->placed = true;
    ground->through[1] = ground->height;
    ground->height = 0.0;
  }
  return true;
}

/* Is it the straight line at rest that `ground` was at first? A point of the line gives its height. */
static bool is_plain(strut_ground *ground, const contact_list *list) {
  for (size_t i = 0; i < list->count; i++)
    if (list->contact[i].friction.driven) return false;
  if (ground->shape != STRUT_GROUND_LINE || ground->moves[0] || ground->moves[1]) return false;
  if (!ground->placed) return true;
  if (!(fabs(ground->slope) < 0.25 * STRUT_TAU)) return false;
  ground->height = ground->through[1];
  if (ground->slope != 0.0) ground->height -= ground->through[0] * tan(ground->slope);
  ground->placed = false;
  ground->through[0] = ground->through[1] = 0.0;
  return true;
}

static size_t pieces_of(const strut_ground *ground) {
  size_t segment, other;
  if (ground->shape != STRUT_GROUND_PROFILE) return 1;
  return strut_profile_check(ground, &segment, &other) ? 1 : strut_ground_pieces(ground);
}

/* Names of contacts where a node may have several: NODE, NODE.GROUND, NODE.PIECE or NODE.GROUND.PIECE. */
static void name_contacts(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  size_t surfaces = 0, *pieces = strut_scratch_array(reader, scene->ground_count, sizeof *pieces);
  for (size_t g = 0; g < scene->ground_count && pieces; g++)
    surfaces += pieces[g] = pieces_of(&scene->grounds[g]);
  for (size_t i = 0; surfaces > 1 && i < scene->contact_count; i++) {
    strut_contact *contact = &scene->contacts[i];
    const char *node = scene->nodes[contact->node].name,
               *ground = scene->grounds[contact->ground].name, *dot = *ground ? "." : "";
    contact->name =
        pieces[contact->ground] > 1
            ? strut_kept_text(reader, "%s%s%s.%d", node, dot, ground, (int)contact->piece + 1)
            : strut_kept_text(reader, "%s%s%s", node, dot, ground);
  }
}

/* All contacts in the order of their nodes; those of one node in the order of the grounds. */
static void merge_contacts(strut_reader *reader, const contact_list *lists) {
  strut_scene *scene = reader->scene;
  size_t grounds = scene->ground_count, total = 0;
  size_t *next = strut_scratch_array(reader, grounds, sizeof *next);
  for (size_t g = 0; g < grounds; g++) total += lists[g].count;
  if (!next || !strut_reserve_things(reader, STRUT_THING_CONTACT, total)) return;
  for (int32_t node = 0; (size_t)node < scene->node_count; node++)
    for (size_t g = 0; g < grounds; g++)
      for (; next[g] < lists[g].count && lists[g].contact[next[g]].node == node; next[g]++) {
        size_t c = scene->contact_count++;
        scene->contacts[c] = lists[g].contact[next[g]];
        scene->contacts[c].ground = (int32_t)g;
        reader->things[STRUT_THING_CONTACT].source[c] = lists[g].source[next[g]];
      }
  name_contacts(reader);
}

/* A belt that rubs on nothing carries nothing. */
static void check_belt(strut_reader *reader, const strut_slot *belt, const contact_list *list) {
  bool rubs = belt->state != STRUT_GIVEN || !list->count;
  for (size_t i = 0; i < list->count && !rubs; i++)
    rubs = list->contact[i].friction.law != STRUT_FRICTION_NONE || list->source[i].broken;
  if (!rubs)
    strut_report_error(reader, belt->key->place,
                       "'belt_speed' has no meaning without 'friction' of a contact");
}

static void read_one(strut_reader *reader, strut_fields *fields, strut_place place,
                     strut_ground *ground, contact_list *list) {
  strut_require(reader, fields, place);
  strut_ground_section section = {.ground = *ground, .contact = strut_contact_default()};
  if (!strut_store(reader, fields, &section) || !read_normal(reader, fields, &section))
    fields->broken = true;
  *ground = section.ground;
  bool line = ground->shape == STRUT_GROUND_LINE;
  ground_defaults defaults = {
      .contact = section.contact,
      .broken = fields->broken,
      .along = {line ? cos(ground->slope) : 1.0, line ? sin(ground->slope) : 0.0}};
  read_friction(reader, fields, &defaults);
  if (strut_entries(reader, STRUT_KEY_SCENE_NODES))
    read_contacts(reader, fields, &defaults, pieces_of(ground), list);
  else
    fields->broken = true;
  check_belt(reader, strut_slot_of(fields, STRUT_KEY_GROUND_BELT_SPEED), list);
}

static void read_single(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  strut_fields *fields = &reader->ground;
  strut_owner owner = {"the ground", NULL};
  strut_ground ground = {.present = true, .name = ""};
  contact_list list = {0};
  if (!strut_read_section(reader, STRUT_KEY_SCENE_GROUND, STRUT_SECTION_GROUND, owner.kind, fields))
    return;
  read_one(reader, fields, strut_slot_of(&reader->top, STRUT_KEY_SCENE_GROUND)->key->place, &ground,
           &list);
  if (is_plain(&ground, &list)) {
    scene->ground = ground;
    scene->contacts = list.contact, scene->contact_count = list.count;
    reader->things[STRUT_THING_CONTACT].source = list.source;
    return;
  }
  scene->grounds = strut_keep_array(reader, 1, sizeof *scene->grounds);
  if (!scene->grounds) return;
  ground.present = false;
  scene->grounds[scene->ground_count++] = ground;
  reader->grounds = fields;
  merge_contacts(reader, &list);
}

/* Contacts of parts wait for a ground; those of a used file come along with one that was not taken. */
static void note_contacts_without_ground(strut_reader *reader) {
  const strut_tree *map = reader->copies ? reader->copies->contacts : NULL;
  if (!map || !map->first || strut_slot_of(&reader->top, STRUT_KEY_SCENE_GROUND)->key ||
      strut_slot_of(&reader->top, STRUT_KEY_SCENE_GROUNDS)->key)
    return;
  for (const strut_copy *copy = strut_scope_of(reader, map->first); copy; copy = copy->outer)
    if (copy->closed) return;
  strut_note(reader->diagnostics, map->first->place,
             "the scene has no ground that the contacts of the part could touch");
}

void strut_read_ground(strut_reader *reader) {
  strut_scene *scene = reader->scene;
  read_single(reader);
  note_contacts_without_ground(reader);
  const strut_tree *map = strut_entries(reader, STRUT_KEY_SCENE_GROUNDS);
  if (!map || strut_slot_of(&reader->top, STRUT_KEY_SCENE_GROUND)->key) return;
  contact_list *lists = strut_scratch_array(reader, map->count, sizeof *lists);
  reader->grounds = strut_scratch_array(reader, map->count, sizeof *reader->grounds);
  if (!lists || !reader->grounds || !strut_reserve_things(reader, STRUT_THING_GROUND, map->count))
    return;
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    size_t g = scene->ground_count;
    strut_owner owner = {"ground", strut_keep_text(reader, key->text)};
    strut_add_thing(reader, STRUT_THING_GROUND, key, owner.name);
    lists[g] = (contact_list){0};
    bool fine = strut_read_name(reader, key, "ground");
    strut_read_fields(reader, STRUT_SECTION_GROUND, key->next, owner, &reader->grounds[g]);
    read_one(reader, &reader->grounds[g], key->place, &scene->grounds[g], &lists[g]);
    if (!fine) reader->grounds[g].broken = true;
    if (reader->grounds[g].broken)
      reader->ground.broken = true; /* so that what depends on it is not reported */
    reader->things[STRUT_THING_GROUND].source[g].broken = reader->grounds[g].broken;
  }
  merge_contacts(reader, lists);
}
