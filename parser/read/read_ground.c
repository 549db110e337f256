/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ground, its contacts and their friction. See reader.h. */
#include <string.h>

#include "parser/read/reader.h"

/* Friction of one contact while layers of keys are laid over each other. */
typedef struct friction_layers {
  strut_friction friction;
  bool any, law, given[STRUT_FRICTION_PARAMETER_COUNT]; /* given so far */
  bool broken;
  const strut_tree *last; /* the mapping of the top layer, */
  strut_owner owner;      /* and whose it is */
} friction_layers;

static bool is_coefficient(int parameter) {
  return parameter == STRUT_FRICTION_PARAMETER_MU_STATIC ||
         parameter == STRUT_FRICTION_PARAMETER_MU_KINETIC;
}

static void add_layer(friction_layers *f, strut_fields *fields, strut_owner owner) {
  static const int keys[] = {
#define STRUT_FRICTION_ROW(NAME, ...) STRUT_KEY_FRICTION_##NAME,
      STRUT_FRICTION_PARAMETERS(STRUT_FRICTION_ROW)
#undef STRUT_FRICTION_ROW
  };
  const strut_slot *both = strut_slot_of(fields, STRUT_KEY_FRICTION_MU);
  f->any = true;
  f->last = fields->map;
  f->owner = owner;
  if (fields->broken) f->broken = true;
  for (int p = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++) {
    const strut_slot *slot = strut_slot_of(fields, keys[p]);
    if (both->state == STRUT_GIVEN && is_coefficient(p)) slot = both;
    if (slot->state != STRUT_GIVEN) continue;
    *strut_friction_parameter(&f->friction, p) = slot->number[0];
    f->given[p] = true;
  }
  const strut_slot *law = strut_slot_of(fields, STRUT_KEY_FRICTION_LAW);
  if (law->state == STRUT_GIVEN) {
    f->friction.law = (strut_friction_law)law->word;
    f->law = true;
  }
}

static void report_missing(strut_reader *reader, const friction_layers *f, const char *key,
                           bool coefficient) {
  char expected[200];
  strut_report_error(
      reader, f->last->place, "%s lacks '%s', expected %s", strut_owner_text(reader, f->owner), key,
      coefficient ? "a number such as 0.5"
                  : strut_expected_number(STRUT_DIM_VELOCITY, expected, sizeof expected));
}

/* Are all numbers given that the friction law needs? Reports at the top layer what is missing, once. */
static bool finish_friction(strut_reader *reader, friction_layers *f, const strut_tree **said) {
  if (!f->any || f->broken) return !f->broken;
  if (!f->law) f->friction.law = STRUT_FRICTION_KARNOPP;
  bool complete = true, none = true;
  for (int p = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++) {
    complete = complete && (f->given[p] || !strut_friction_needs(f->friction.law, p));
    none = none && !(f->given[p] && is_coefficient(p));
  }
  if (complete) return true;
  if (*said == f->last) return false;
  *said = f->last;
  bool coefficients = false; /* one of them reported */
  for (int p = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++) {
    if (f->given[p] || !strut_friction_needs(f->friction.law, p)) continue;
    if (is_coefficient(p) && coefficients) continue;
    coefficients = coefficients || is_coefficient(p);
    report_missing(reader, f, is_coefficient(p) && none ? "mu" : strut_friction_key(p),
                   is_coefficient(p));
  }
  return false;
}

/* What the contacts of the ground have in common. */
typedef struct ground_defaults {
  double stiffness, damping, dissipation;
  friction_layers friction;
  bool broken;
  const strut_tree *said;
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
        add_layer(layers, groups[g]->items[i].nested,
                  (strut_owner){"the friction of group", groups[g]->name});
  if (own->state != STRUT_GIVEN || own->from) return;
  strut_fields nested;
  strut_owner mine = {"the friction of contact", owner.name};
  strut_read_fields(reader, STRUT_ROOM_FRICTION, own->value, mine, &nested);
  add_layer(layers, &nested, mine);
}

static void read_contact(strut_reader *reader, const strut_tree *key, ground_defaults *defaults,
                         strut_contact *contact, strut_source *source) {
  friction_layers layers = defaults->friction;
  strut_owner owner = {"contact", reader->scene->nodes[contact->node].name};
  bool fine = !defaults->broken;
  contact->stiffness = defaults->stiffness;
  contact->damping = defaults->damping;
  contact->dissipation = defaults->dissipation;
  if (key) {
    strut_fields fields;
    strut_read_fields(reader, STRUT_ROOM_CONTACT, key->next, owner, &fields);
    strut_apply_groups(reader, &fields, STRUT_KEY_CONTACT_GROUP, owner);
    contact->stiffness = strut_number_or(&fields, STRUT_KEY_CONTACT_STIFFNESS, defaults->stiffness);
    contact->damping = strut_number_or(&fields, STRUT_KEY_CONTACT_DAMPING, defaults->damping);
    contact->dissipation =
        strut_number_or(&fields, STRUT_KEY_CONTACT_DISSIPATION, defaults->dissipation);
    own_friction(reader, &fields, owner, &layers);
    if (fields.broken) fine = false;
  }
  if (!finish_friction(reader, &layers, &defaults->said)) fine = false;
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
      strut_report_error(reader, item->place, "node '%s' stands twice in 'nodes' of the ground",
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
    scene->contacts[c] = strut_contact_default();
    scene->contacts[c].node = (int32_t)i;
    read_contact(reader, entry[i], defaults, &scene->contacts[c], &reader->contact_source[c]);
  }
}

void strut_read_ground(strut_reader *reader) {
  strut_fields *fields = &reader->ground;
  strut_owner owner = {"the ground", NULL};
  if (!strut_read_section(reader, STRUT_KEY_SCENE_GROUND, STRUT_ROOM_GROUND, owner.kind, fields))
    return;
  strut_require(reader, fields, owner,
                strut_slot_of(&reader->top, STRUT_KEY_SCENE_GROUND)->key->place);
  strut_ground *ground = &reader->scene->ground;
  ground->present = true;
  ground->height = strut_number_or(fields, STRUT_KEY_GROUND_HEIGHT, 0.0);
  ground->slope = strut_number_or(fields, STRUT_KEY_GROUND_SLOPE, 0.0);
  ground->belt_speed = strut_number_or(fields, STRUT_KEY_GROUND_BELT_SPEED, 0.0);
  const strut_slot *law = strut_slot_of(fields, STRUT_KEY_GROUND_DAMPING_LAW);
  if (law->state == STRUT_GIVEN) ground->damping_law = (strut_ground_damping)law->word;
  ground_defaults defaults = {
      .stiffness = strut_number_or(fields, STRUT_KEY_GROUND_STIFFNESS, 1.0),
      .damping = strut_number_or(fields, STRUT_KEY_GROUND_DAMPING, 0.0),
      .dissipation = strut_number_or(fields, STRUT_KEY_GROUND_DISSIPATION, 0.0),
      .broken = fields->broken};
  const strut_slot *friction = strut_slot_of(fields, STRUT_KEY_GROUND_FRICTION);
  if (friction->state == STRUT_GIVEN) {
    strut_fields nested;
    strut_owner mine = {"the friction of the ground", NULL};
    strut_read_fields(reader, STRUT_ROOM_FRICTION, friction->value, mine, &nested);
    add_layer(&defaults.friction, &nested, mine);
  }
  if (strut_slot_of(&reader->top, STRUT_KEY_SCENE_NODES)->state == STRUT_GIVEN)
    read_contacts(reader, &defaults);
  else
    fields->broken = true;
}
