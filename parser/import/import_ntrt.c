/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NTRT: nodes, pairs by tag, builders by tag. Lengths are in decimetres unless said otherwise; y is up. */
#include <math.h>
#include <string.h>

#include "parser/import/ntrt.h"

/* A builder with NTRT's defaults. */
typedef struct builder {
  bool rod, cable; /* neither: a class that a scene has no word for */
  double radius, density, stiffness, damping, pretension; /* in the file's units */
} builder;

/* The scene's plane of the nodes. */
typedef struct plane {
  int across;   /* the coordinate that is x: 0 or 2 */
  double faint; /* lengths that are rounding */
} plane;

/* Finds the plane of all nodes: z or x is the same. False where there is none, which was reported. */
static bool find_plane(const strut_ntrt *n, plane *to) {
  double size = 0.0;
  size_t off[3] = {0, 0, 0}; /* the first node that is elsewhere, or 0 */
  for (size_t i = 0; i < n->node_count; i++)
    for (int c = 0; c < 3; c++) size = fmax(size, fabs(n->nodes[i].p[c] - n->nodes[0].p[c]));
  to->faint = 1e-12 * size;
  for (size_t i = 0; i < n->node_count; i++)
    for (int c = 0; c < 3; c++)
      if (!off[c] && fabs(n->nodes[i].p[c] - n->nodes[0].p[c]) > to->faint) off[c] = i;
  to->across = off[2] ? 2 : 0;
  if (!off[2] || !off[0]) return true;
  const strut_ntrt_node *node = &n->nodes[off[2]];
  strut_diagnose(node->said, node->place,
                 "node '%.60s' is not in one plane with those before it: strut is planar, and all "
                 "nodes must have the same z, or the same x",
                 node->name);
  return false;
}

/* A coordinate without what rotations leave of a zero. */
static const char *coordinate(const strut_ntrt *n, const plane *in, double value) {
  return strut_import_length(n->scene, fabs(value) <= in->faint ? 0.0 : value);
}

static void write_nodes(const strut_ntrt *n, const plane *in) {
  for (size_t i = 0; i < n->node_count; i++) {
    const strut_ntrt_node *node = &n->nodes[i];
    strut_import_node_add(
        n->scene, node->said, node->place, node->name,
        strut_import_text(n->scene, "{position: [%s, %s]}", coordinate(n, in, node->p[in->across]),
                          coordinate(n, in, node->p[1])));
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

static void read_parameters(strut_diagnostics *said, const strut_tree *map, builder *b) {
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
      strut_import_read_number(said, key->next, key->text, known[i].value);
    else
      strut_note(said, key->place, "not imported: '%.60s'", key->text);
  }
}

/* The builder of a pair with these tags; false: there is none. */
static bool find_builder(const strut_ntrt *n, const char *tags, builder *b) {
  size_t k = 0;
  while (k < n->builder_count && !has_words(tags, n->builders[k].key->text)) k++;
  const strut_tree *found = k < n->builder_count ? n->builders[k].key->next : NULL;
  *b = (builder){.radius = 0.5, .density = 1.0, .stiffness = 1000.0, .damping = 10.0};
  b->rod = !found && has_word(tags, "rod");
  b->cable = !found && has_word(tags, "string");
  if (!found) return b->rod || b->cable;
  strut_diagnostics *said = n->builders[k].said;
  const strut_tree *class =
      found->kind == STRUT_TREE_MAP ? strut_tree_find(found, "class", NULL) : NULL;
  if (!class || class->kind != STRUT_TREE_SCALAR) {
    strut_diagnose(said, found->place, "expected a builder with a 'class'");
    return false;
  }
  b->rod = strcmp(class->text, "tgRodInfo") == 0;
  b->cable = strcmp(class->text, "tgBasicActuatorInfo") == 0 ||
             strcmp(class->text, "tgBasicContactCableInfo") == 0 ||
             strcmp(class->text, "tgKinematicActuatorInfo") == 0 ||
             strcmp(class->text, "tgKinematicContactCableInfo") == 0;
  if (!b->rod && !b->cable)
    strut_note(said, class->place, "not imported: pairs of the class '%.60s'", class->text);
  const strut_tree *parameters = strut_tree_find(found, "parameters", NULL);
  if (parameters && parameters->kind == STRUT_TREE_MAP && (b->rod || b->cable))
    read_parameters(said, parameters, b);
  return true;
}

/* NTRT's stiffness and damping have no length in their units; forces and densities have. */
static void write_member(const strut_ntrt *n, const char *name, const strut_ntrt_pair *pair,
                         const builder *b, const plane *in) {
  static const double pi = 3.14159265358979323846;
  strut_import_scene *s = n->scene;
  strut_writer *to = &s->section[STRUT_IMPORT_MEMBERS];
  const strut_ntrt_node *from = &n->nodes[pair->end[0]], *end = &n->nodes[pair->end[1]];
  const char *first = strut_import_node_use(s, from->name);
  const char *second = strut_import_node_use(s, end->name);
  if (b->rod) {
    double length = hypot(end->p[in->across] - from->p[in->across], end->p[1] - from->p[1]);
    strut_import_line(s, to, "  %s: {kind: bar, nodes: [%s, %s], stiffness: 1e6 N/m, mass: %s kg}",
                      name, first, second,
                      strut_import_number(s, b->density * pi * b->radius * b->radius * length));
    return;
  }
  strut_import_line(s, to,
                    "  %s: {kind: cable, nodes: [%s, %s], stiffness: %s N/m, damping: %s N s/m, "
                    "pretension: %s N}",
                    name, first, second, strut_import_number(s, b->stiffness),
                    strut_import_number(s, b->damping), strut_import_length(s, b->pretension));
}

/* Pairs of the same tags in one structure follow each other, and have one builder. */
static bool write_members(const strut_ntrt *n, const plane *in) {
  bool rods = false, known = false;
  builder b = {.rod = false};
  size_t number = 0;
  for (size_t i = 0; i < n->pair_count; i++) {
    const strut_ntrt_pair *pair = &n->pairs[i];
    if (!i || pair[-1].tags != pair->tags || pair[-1].base != pair->base) {
      number = 0;
      known = find_builder(n, pair->tags, &b);
      if (!known)
        strut_note(pair->said, pair->place, "not imported: '%.60s' has no builder", pair->tags);
    }
    number++;
    if (!known || !(b.rod || b.cable)) continue;
    rods = rods || b.rod;
    const char *name =
        strut_import_text(n->scene, "%s-%zu", strut_import_name(n->scene, pair->base), number);
    write_member(n, name, pair, &b, in);
  }
  return rods;
}

strut_status strut_import_ntrt(strut_import_scene *s) {
  strut_ntrt n = {.scene = s};
  plane in = {.across = 0};
  strut_status status = strut_ntrt_read(&n);
  bool fine = !status && n.node_count;
  for (size_t i = 0; i < s->file_count; i++) fine = fine && !s->files[i].diagnostics.count;
  bool rods = false;
  if (fine && find_plane(&n, &in)) {
    write_nodes(&n, &in);
    rods = write_members(&n, &in);
  }
  if (rods)
    strut_import_line(s, &s->head,
                      "bars: rigid  # as NTRT's rods; their stiffness is for statics\n"
                      "# Gravity, ground and control are not in NTRT's file.");
  strut_ntrt_free(&n);
  return status;
}
