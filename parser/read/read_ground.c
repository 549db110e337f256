/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ground, its contacts and their friction. See reader.h. */
#include <string.h>

#include "parser/read/reader.h"

/* The friction of one contact while the layers (ground, groups, contact) are laid over each other. */
typedef struct friction_layers {
  strut_friction friction;
  unsigned given;         /* one bit for each key that some layer gave */
  bool any, broken;       /* there is a layer; one could not be read */
  const strut_tree *last; /* the mapping of the top layer, */
  strut_owner owner;      /* and what messages call it */
} friction_layers;

static unsigned key_bit(int key) {
  return 1u << (key - strut_section_first(STRUT_SECTION_FRICTION));
}

static bool is_given(strut_fields *fields, int key, double *number) {
  const strut_slot *slot = strut_slot_of(fields, key);
  if (slot->state == STRUT_GIVEN) *number = slot->number[0];
  return slot->state == STRUT_GIVEN;
}

/*
 * Coefficients of a layer beside mu_static and mu_kinetic. Those without a direction replace both
 * directions of the layers below.
 */
static void set_coefficients(friction_layers *f, strut_fields *fields) {
  strut_friction *all = &f->friction;
  const unsigned directions =
      key_bit(STRUT_KEY_FRICTION_MU_FORWARD) | key_bit(STRUT_KEY_FRICTION_MU_FORWARD_STATIC) |
      key_bit(STRUT_KEY_FRICTION_MU_BACKWARD) | key_bit(STRUT_KEY_FRICTION_MU_BACKWARD_STATIC);
  double mu;
  bool both = is_given(fields, STRUT_KEY_FRICTION_MU, &mu);
  if (both || is_given(fields, STRUT_KEY_FRICTION_MU_STATIC, &all->mu_static) ||
      is_given(fields, STRUT_KEY_FRICTION_MU_KINETIC, &all->mu_kinetic))
    all->directional = false, f->given &= ~directions;
  if (both || is_given(fields, STRUT_KEY_FRICTION_MU_FORWARD, &mu)) {
    all->mu_static = all->mu_kinetic = mu;
    f->given |= key_bit(STRUT_KEY_FRICTION_MU_STATIC) | key_bit(STRUT_KEY_FRICTION_MU_KINETIC);
  }
  is_given(fields, STRUT_KEY_FRICTION_MU_FORWARD_STATIC, &all->mu_static);
  if (is_given(fields, STRUT_KEY_FRICTION_MU_BACKWARD, &mu)) {
    all->directional = true;
    all->mu_static_backward = all->mu_kinetic_backward = mu;
  }
  is_given(fields, STRUT_KEY_FRICTION_MU_BACKWARD_STATIC, &all->mu_static_backward);
}

static void add_layer(strut_reader *reader, friction_layers *f, strut_fields *fields,
                      strut_owner owner) {
  f->any = true;
  f->last = fields->map;
  f->owner = owner;
  if (fields->broken) f->broken = true;
  strut_store_fields(reader, fields, &reader->scene->arena, &f->friction, sizeof f->friction);
  for (int i = 0; i < strut_section_size(STRUT_SECTION_FRICTION); i++)
    if (fields->slot[i].state == STRUT_GIVEN) f->given |= 1u << i;
  set_coefficients(f, fields);
}

/* Reports a key that the law needs and no layer gives, at the top layer. */
static void report_lack(strut_reader *reader, const friction_layers *f, int key) {
  char expected[200];
  bool speed = strut_key_at(key)->measure == STRUT_MEASURE_VELOCITY;
  strut_report_error(reader, f->last->place, "%s lacks '%s', expected %s",
                     strut_owner_text(reader, f->owner), strut_key_at(key)->name,
                     speed ? strut_expected_number(STRUT_DIM_VELOCITY, expected, sizeof expected)
                           : "a number such as 0.5");
}

/*
 * Are all numbers given that the friction law needs? What is missing is reported once for each top layer;
 * where no coefficient is given, as one lacking key, mu.
 */
static bool complete_friction(strut_reader *reader, friction_layers *f,
                              const strut_tree **reported) {
  if (!f->any || f->broken) return !f->broken;
  if (!(f->given & key_bit(STRUT_KEY_FRICTION_LAW))) f->friction.law = STRUT_FRICTION_KARNOPP;
  bool statics = f->given & key_bit(STRUT_KEY_FRICTION_MU_STATIC);
  bool kinetics = f->given & key_bit(STRUT_KEY_FRICTION_MU_KINETIC);
  bool complete = true, reported_mu = false;
  for (int p = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++) {
    int key = strut_key_find(STRUT_SECTION_FRICTION, strut_friction_key(p));
    if (!strut_friction_needs(f->friction.law, p) || (f->given & key_bit(key))) continue;
    complete = false;
    bool both = !statics && !kinetics &&
                (key == STRUT_KEY_FRICTION_MU_STATIC || key == STRUT_KEY_FRICTION_MU_KINETIC);
    if (*reported != f->last && !(both && reported_mu))
      report_lack(reader, f, both ? STRUT_KEY_FRICTION_MU : key);
    reported_mu = reported_mu || both;
  }
  bool forward = f->given & (key_bit(STRUT_KEY_FRICTION_MU_FORWARD) |
                             key_bit(STRUT_KEY_FRICTION_MU_FORWARD_STATIC) |
                             key_bit(STRUT_KEY_FRICTION_MU_BACKWARD_STATIC));
  if (forward && !f->friction.directional) {
    if (*reported != f->last) report_lack(reader, f, STRUT_KEY_FRICTION_MU_BACKWARD);
    complete = false;
  }
  if (!complete) *reported = f->last;
  return complete;
}

/* The defaults of all contacts: those of the ground. */
typedef struct ground_defaults {
  strut_contact contact;
  friction_layers friction;
  bool broken;
  const strut_tree *reported; /* the layer of friction whose lacks were reported last */
} ground_defaults;

/* Lays the friction of the contact's groups, then its own, over the ground's. */
static void own_friction(strut_reader *reader, strut_fields *fields, strut_owner owner,
                         friction_layers *layers) {
  const strut_slot *group = strut_slot_of(fields, STRUT_KEY_CONTACT_GROUP);
  const strut_slot *own = strut_slot_of(fields, STRUT_KEY_CONTACT_FRICTION);
  strut_group *groups[STRUT_MOST_GROUPS];
  size_t count = group->state == STRUT_GIVEN ? strut_groups_named(reader, group->value, groups) : 0;
  for (size_t g = 0; g < count; g++)
    for (size_t i = 0; i < groups[g]->count; i++)
      if (groups[g]->items[i].nested)
        add_layer(reader, layers, groups[g]->items[i].nested,
                  (strut_owner){"the friction of group", groups[g]->name});
  if (own->state != STRUT_GIVEN || own->from) return;
  strut_fields nested;
  strut_owner mine = {"the friction of contact", owner.name};
  strut_read_fields(reader, STRUT_SECTION_FRICTION, own->value, mine, &nested);
  add_layer(reader, layers, &nested, mine);
}

static void read_contact(strut_reader *reader, const strut_tree *key, ground_defaults *defaults,
                         strut_contact *contact, strut_source *source) {
  friction_layers layers = defaults->friction;
  strut_owner owner = {"contact", reader->scene->nodes[contact->node].name};
  bool fine = !defaults->broken;
  if (key) {
    strut_fields fields;
    strut_read_fields(reader, STRUT_SECTION_CONTACT, key->next, owner, &fields);
    strut_apply_groups(reader, &fields, STRUT_KEY_CONTACT_GROUP, owner);
    strut_store_fields(reader, &fields, &reader->scene->arena, contact, sizeof *contact);
    own_friction(reader, &fields, owner, &layers);
    if (fields.broken) fine = false;
  }
  if (!complete_friction(reader, &layers, &defaults->reported)) fine = false;
  contact->friction = layers.friction;
  *source = (strut_source){key, key ? key->next : NULL, !fine};
}

/* Marks the nodes that may touch the ground. */
static bool mark_nodes(strut_reader *reader, unsigned char *touches) {
  const strut_slot *slot = strut_slot_of(&reader->ground, STRUT_KEY_GROUND_NODES);
  size_t count = reader->scene->node_count;
  if (slot->state != STRUT_GIVEN || slot->value->kind == STRUT_TREE_SCALAR) {
    memset(touches, 1, count);
    return slot->state != STRUT_BROKEN;
  }
  bool fine = true;
  strut_owner owner = {"the ground", NULL};
  for (const strut_tree *item = slot->value->first; item; item = item->next) {
    int32_t node = strut_read_reference(reader, item, "nodes", owner, "node", &reader->node_names,
                                        strut_node_name, count);
    if (node < 0) {
      fine = false;
    } else if (touches[node]) {
      strut_report_error(reader, item->place, "node '%s' appears twice in 'nodes' of the ground",
                         item->text);
      fine = false;
    } else {
      touches[node] = 1;
    }
  }
  return fine;
}

/* The entry in `contacts` of each node that has one. */
static bool find_entries(strut_reader *reader, const unsigned char *touches, bool complete,
                         const strut_tree **entry) {
  const strut_slot *slot = strut_slot_of(&reader->ground, STRUT_KEY_GROUND_CONTACTS);
  bool fine = slot->state != STRUT_BROKEN;
  if (slot->state != STRUT_GIVEN) return fine;
  for (const strut_tree *key = slot->value->first; key; key = key->next->next) {
    int32_t node =
        strut_read_reference(reader, key, "contacts", (strut_owner){"the ground", NULL}, "node",
                             &reader->node_names, strut_node_name, reader->scene->node_count);
    if (node >= 0 && touches[node]) {
      entry[node] = key;
      continue;
    }
    fine = false;
    if (node >= 0 && complete)
      strut_report_error(reader, key->place,
                         "node '%s' has a contact, but 'nodes' of the ground lacks it", key->text);
  }
  return fine;
}

static void read_contacts(strut_reader *reader, ground_defaults *defaults) {
  strut_scene *scene = reader->scene;
  size_t count = scene->node_count;
  unsigned char *touches = strut_reader_allocate(reader, &reader->scratch, count, 1);
  const strut_tree **entry = strut_reader_allocate(reader, &reader->scratch, count, sizeof *entry);
  scene->contacts = strut_reader_allocate(reader, &scene->arena, count, sizeof *scene->contacts);
  reader->contact_source =
      strut_reader_allocate(reader, &reader->scratch, count, sizeof *reader->contact_source);
  if (!touches || !entry || !scene->contacts || !reader->contact_source) return;
  bool complete = mark_nodes(reader, touches);
  if (!find_entries(reader, touches, complete, entry) || !complete) reader->ground.broken = true;
  for (size_t i = 0; i < count; i++) {
    if (!touches[i]) continue;
    size_t c = scene->contact_count++;
    scene->contacts[c] = defaults->contact;
    scene->contacts[c].node = (int32_t)i;
    read_contact(reader, entry[i], defaults, &scene->contacts[c], &reader->contact_source[c]);
  }
}

void strut_read_ground(strut_reader *reader) {
  strut_fields *fields = &reader->ground;
  strut_owner owner = {"the ground", NULL};
  if (!strut_read_section(reader, STRUT_KEY_SCENE_GROUND, STRUT_SECTION_GROUND, owner.kind, fields))
    return;
  strut_require(reader, fields, owner,
                strut_slot_of(&reader->top, STRUT_KEY_SCENE_GROUND)->key->place);
  strut_ground_section section = {.ground = {.present = true}, .contact = strut_contact_default()};
  strut_store_fields(reader, fields, &reader->scene->arena, &section, sizeof section);
  reader->scene->ground = section.ground;
  ground_defaults defaults = {.contact = section.contact, .broken = fields->broken};
  const strut_slot *friction = strut_slot_of(fields, STRUT_KEY_GROUND_FRICTION);
  if (friction->state == STRUT_GIVEN) {
    strut_fields nested;
    strut_owner mine = {"the friction of the ground", NULL};
    strut_read_fields(reader, STRUT_SECTION_FRICTION, friction->value, mine, &nested);
    add_layer(reader, &defaults.friction, &nested, mine);
  }
  if (strut_slot_of(&reader->top, STRUT_KEY_SCENE_NODES)->state == STRUT_GIVEN)
    read_contacts(reader, &defaults);
  else
    fields->broken = true;
}
