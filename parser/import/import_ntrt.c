/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NTRT: nodes, pairs by tag, builders by tag. Lengths are in decimetres unless said otherwise; y is up. */
#include <math.h>
#include <string.h>

#include "parser/import/import_parts.h"

enum { MOST_TAGS = 16 };

/* A builder with NTRT's defaults. */
typedef struct builder {
  bool rod, cable; /* neither: a class that a scene has no word for */
  double radius, density, stiffness, damping, pretension; /* in the file's units */
} builder;

typedef struct ntrt {
  strut_import_scene *scene;
  strut_diagnostics *said;
  const strut_tree *nodes, *builders;
  int across; /* the coordinate that is x: 0 or 2 */
  bool rods, spheres;
} ntrt;

/* Three coordinates; false where that was reported. */
static bool read_point(ntrt *n, const strut_tree *value, double p[3]) {
  if (value->kind != STRUT_TREE_LIST || value->count != 3) {
    strut_diagnose(n->said, value->place, "expected three coordinates [x, y, z]");
    return false;
  }
  const strut_tree *item = value->first;
  bool fine = true;
  for (int i = 0; i < 3; i++, item = item->next)
    fine = strut_import_read_number(n->said, item, "a coordinate", &p[i]) && fine;
  return fine;
}

/* Finds the plane of all nodes: z or x is the same. False where there is none, which was reported. */
static bool find_plane(ntrt *n) {
  const strut_tree *off[3] = {NULL, NULL, NULL};
  double first[3], p[3];
  bool any = false;
  for (const strut_tree *key = n->nodes->first; key; key = key->next->next) {
    if (!read_point(n, key->next, p)) return false;
    if (!any) memcpy(first, p, sizeof first);
    any = true;
    for (int i = 0; i < 3; i++)
      if (p[i] != first[i] && !off[i]) off[i] = key;
  }
  n->across = off[2] ? 2 : 0;
  if (!off[2] || !off[0]) return true;
  const strut_tree *key = off[2];
  strut_diagnose(n->said, key->next->place,
                 "node '%.60s' is not in one plane with those before it: strut is planar, and all "
                 "nodes must have the same z, or the same x",
                 key->text);
  return false;
}

static void read_nodes(ntrt *n) {
  strut_import_scene *s = n->scene;
  for (const strut_tree *key = n->nodes->first; key; key = key->next->next) {
    double p[3] = {0.0, 0.0, 0.0};
    if (!read_point(n, key->next, p)) continue;
    strut_import_node_add(
        s, n->said, key->place, key->text,
        strut_import_text(s, "{position: [%s, %s]}", strut_import_length(s, p[n->across]),
                          strut_import_length(s, p[1])));
  }
}

/* Has the list of words, with blanks between, this word? */
static bool has_word(const char *words, const char *word) {
  size_t length = strlen(word);
  for (const char *at = words; (at = strstr(at, word)) != NULL; at += length)
    if ((at == words || at[-1] == ' ') && (at[length] == ' ' || !at[length])) return true;
  return false;
}

/* Does every word of `some` stand in `words`? */
static bool has_words(const char *words, const char *some) {
  char word[80];
  for (some += strspn(some, " "); *some; some += strspn(some, " ")) {
    size_t length = strcspn(some, " ");
    if (length >= sizeof word) return false;
    memcpy(word, some, length);
    word[length] = '\0';
    if (!has_word(words, word)) return false;
    some += length;
  }
  return true;
}

static void read_parameters(ntrt *n, const strut_tree *map, builder *b) {
  const struct {
    const char *name;
    double *value;
    bool of_rod;
  } known[] = {{"radius", &b->radius, true},
               {"density", &b->density, true},
               {"stiffness", &b->stiffness, false},
               {"damping", &b->damping, false},
               {"pretension", &b->pretension, false}};
  for (const strut_tree *key = map->first; key; key = key->next->next) {
    size_t i = 0;
    while (i < 5 && (strcmp(known[i].name, key->text) != 0 || known[i].of_rod != b->rod)) i++;
    if (i < 5)
      strut_import_read_number(n->said, key->next, key->text, known[i].value);
    else
      strut_note(n->said, key->place, "not imported: '%.60s'", key->text);
  }
}

/* The builder of a pair with these tags; false: there is none. */
static bool find_builder(ntrt *n, const strut_tree *tags, builder *b) {
  const strut_tree *found = NULL;
  *b = (builder){.radius = 0.5, .density = 1.0, .stiffness = 1000.0, .damping = 10.0};
  for (const strut_tree *key = n->builders ? n->builders->first : NULL; key; key = key->next->next)
    if (!found && has_words(tags->text, key->text)) found = key->next;
  b->rod = !found && has_word(tags->text, "rod");
  b->cable = !found && has_word(tags->text, "string");
  if (!found) return b->rod || b->cable;
  const strut_tree *class =
      found->kind == STRUT_TREE_MAP ? strut_tree_find(found, "class", NULL) : NULL;
  if (!class || class->kind != STRUT_TREE_SCALAR) {
    strut_diagnose(n->said, found->place, "expected a builder with a 'class'");
    return false;
  }
  b->rod = strcmp(class->text, "tgRodInfo") == 0;
  b->cable = strcmp(class->text, "tgBasicActuatorInfo") == 0 ||
             strcmp(class->text, "tgBasicContactCableInfo") == 0 ||
             strcmp(class->text, "tgKinematicActuatorInfo") == 0 ||
             strcmp(class->text, "tgKinematicContactCableInfo") == 0;
  if (!b->rod && !b->cable)
    strut_note(n->said, class->place, "not imported: pairs of the class '%.60s'", class->text);
  const strut_tree *parameters = strut_tree_find(found, "parameters", NULL);
  if (parameters && parameters->kind == STRUT_TREE_MAP && (b->rod || b->cable))
    read_parameters(n, parameters, b);
  return true;
}

/* Indices of the pair's nodes in the file; false where that was reported. */
static bool read_pair(ntrt *n, const strut_tree *pair, const strut_tree *ends[2], double *length) {
  double p[2][3];
  if (pair->kind != STRUT_TREE_LIST || pair->count != 2) {
    strut_diagnose(n->said, pair->place, "expected a pair of nodes [a, b]");
    return false;
  }
  const strut_tree *item = pair->first;
  for (int i = 0; i < 2; i++, item = item->next) {
    const strut_tree *node =
        item->kind == STRUT_TREE_SCALAR ? strut_tree_find(n->nodes, item->text, NULL) : NULL;
    if (!node) {
      strut_diagnose(n->said, item->place, "there is no node '%.60s'",
                     item->kind == STRUT_TREE_SCALAR ? item->text : "");
      return false;
    }
    if (!read_point(n, node, p[i])) return false;
    ends[i] = item;
  }
  *length = hypot(p[1][n->across] - p[0][n->across], p[1][1] - p[0][1]);
  return true;
}

/* NTRT's stiffness and damping have no length in their units; forces and densities have. */
static void write_member(ntrt *n, const char *name, const strut_tree *const ends[2],
                         const builder *b, double length) {
  static const double pi = 3.14159265358979323846;
  strut_import_scene *s = n->scene;
  strut_writer *to = &s->section[STRUT_IMPORT_MEMBERS];
  const char *from = strut_import_node_use(s, ends[0]->text);
  const char *end = strut_import_node_use(s, ends[1]->text);
  if (b->rod) {
    n->rods = true;
    strut_import_line(s, to, "  %s: {kind: bar, nodes: [%s, %s], stiffness: 1e6 N/m, mass: %s kg}",
                      name, from, end,
                      strut_import_number(s, b->density * pi * b->radius * b->radius * length));
    return;
  }
  strut_import_line(s, to,
                    "  %s: {kind: cable, nodes: [%s, %s], stiffness: %s N/m, damping: %s N s/m, "
                    "pretension: %s N}",
                    name, from, end, strut_import_number(s, b->stiffness),
                    strut_import_number(s, b->damping), strut_import_length(s, b->pretension));
}

static void read_group(ntrt *n, const strut_tree *tags) {
  strut_import_scene *s = n->scene;
  builder b;
  size_t number = 0;
  if (tags->next->kind != STRUT_TREE_LIST) {
    strut_diagnose(n->said, tags->next->place, "expected a list of pairs for '%.60s'", tags->text);
    return;
  }
  if (!find_builder(n, tags, &b)) {
    strut_note(n->said, tags->place, "not imported: '%.60s' has no builder", tags->text);
    return;
  }
  for (const strut_tree *pair = tags->next->first; pair && (b.rod || b.cable); pair = pair->next) {
    const strut_tree *ends[2];
    double length = 0.0;
    if (!read_pair(n, pair, ends, &length)) continue;
    write_member(n, strut_import_text(s, "%s-%zu", strut_import_name(s, tags->text), ++number),
                 ends, &b, length);
  }
}

static void read_root(ntrt *n, const strut_tree *root) {
  static const char *const keys[] = {"nodes", "pair_groups", "builders"};
  const strut_tree *value[3] = {NULL, NULL, NULL};
  for (const strut_tree *key = root->first; key; key = key->next->next) {
    size_t i = 0;
    while (i < 3 && strcmp(keys[i], key->text) != 0) i++;
    if (strcmp(key->text, "substructures") == 0 || strcmp(key->text, "bond_groups") == 0)
      strut_diagnose(n->said, key->place,
                     "'%s' is not read: import the structures one by one, and place them as parts",
                     key->text);
    else if (i == 3)
      strut_diagnose(n->said, key->place, "expected nodes, pair_groups or builders, found '%.60s'",
                     key->text);
    else if (key->next->kind != STRUT_TREE_MAP)
      strut_diagnose(n->said, key->next->place, "expected a mapping for '%s'", key->text);
    else
      value[i] = key->next;
  }
  if (!value[0] || !value[1]) {
    strut_diagnose(n->said, root->place, "expected mappings 'nodes' and 'pair_groups'");
    return;
  }
  n->nodes = value[0];
  n->builders = value[2];
  if (!find_plane(n)) return;
  read_nodes(n);
  for (const strut_tree *key = value[1]->first; key; key = key->next->next) read_group(n, key);
}

strut_status strut_import_ntrt(strut_import_scene *s) {
  strut_document document = {0};
  ntrt n = {.scene = s, .said = &s->files[0].diagnostics};
  strut_status status = strut_document_read(&document, n.said);
  if (!status && document.root->kind != STRUT_TREE_MAP)
    strut_diagnose(n.said, document.root->place, "expected a mapping with nodes and pair_groups");
  else if (!status)
    read_root(&n, document.root);
  if (n.rods)
    strut_import_line(s, &s->head,
                      "bars: rigid  # as NTRT's rods; their stiffness is for statics\n"
                      "# Gravity, ground and control are not in NTRT's file.");
  strut_document_free(&document);
  return status;
}
