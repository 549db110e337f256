/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rigidity of a shape as a table that fits a screen. */
#include "engine/output/report/reports.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/statics/rigidity/rigidity.h"

enum { STRUT_RIGIDITY_WORDS = 240 };

/* ---- words ---- */

enum { FEW_DIGITS = 4 };

static const char *stress_source_words(strut_stress_source source) {
  static const char *const words[] = {
      "no self-stress state", "the self-stress state", "the member forces",
      "a combination of states that tensions all cables", "the first self-stress state"};
  return words[source];
}

static const char *mechanism_words(const strut_mechanisms *all, const strut_mechanism *motion,
                                   char words[STRUT_RIGIDITY_WORDS]) {
  char moved[STRUT_QUANTITY_TEXT], stiff[STRUT_QUANTITY_TEXT];
  bool followed = isfinite(motion->moved) && motion->kind == STRUT_MOTION_FINITE;
  words[0] = '\0';
  if (motion->kind == STRUT_MOTION_RIGID_BODY) {
    snprintf(words, STRUT_RIGIDITY_WORDS, "not prevented by the supports");
  } else if (motion->kind == STRUT_MOTION_INFINITESIMAL && all->by_forces) {
    snprintf(words, STRUT_RIGIDITY_WORDS, "stiffened by the member forces: %s",
             strut_quantity_text(motion->stiffness, FEW_DIGITS, "N/m", stiff));
  } else if (motion->kind == STRUT_MOTION_INFINITESIMAL) {
    snprintf(
        words, STRUT_RIGIDITY_WORDS, "stiffened by a self-stress state%s",
        all->stiffener_pulls ? "" : ", but none is known that does so without compressing a cable");
  } else if (followed) {
    snprintf(words, STRUT_RIGIDITY_WORDS, "member lengths constant within %.0e over %s",
             motion->strain, strut_quantity_text(motion->moved, FEW_DIGITS, "m", moved));
  } else if (motion->kind == STRUT_MOTION_FINITE) {
    snprintf(words, STRUT_RIGIDITY_WORDS,
             "finite: without self-stress the member lengths are independent");
  } else {
    snprintf(words, STRUT_RIGIDITY_WORDS,
             "undecided: no stiffening self-stress found, and it could not be followed");
  }
  return words;
}

static const char *why_not(const strut_rigidity *r) {
  if (!r->stress.positive) return "the stress matrix has a negative eigenvalue";
  if (r->stress.supported && r->stress.nullity > 0)
    return "the stress matrix is not definite on the free coordinates";
  if (!r->stress.supported && r->stress.nullity > 3)
    return "the stress matrix vanishes on more than affine motions";
  if (!r->stress.supported && r->stress.nullity < 3) return "the forces do not balance";
  if (!r->stress.supported && r->stress.on_conic)
    return "an affine motion keeps all lengths: the members have only two directions";
  return "a cable is in compression";
}

static const char *super_stability_words(const strut_rigidity *r,
                                         char words[STRUT_RIGIDITY_WORDS]) {
  const char *source = stress_source_words(r->source);
  if (r->states.count == 0)
    snprintf(words, STRUT_RIGIDITY_WORDS, "no: %s", source);
  else if (r->stress.by_elements)
    snprintf(words, STRUT_RIGIDITY_WORDS,
             "not judged: elements (hinges, cells, running cables) carry %s", source);
  else if (!r->stress.tested)
    snprintf(words, STRUT_RIGIDITY_WORDS, "not tested: the structure is too large");
  else if (r->stress.super_stable)
    snprintf(words, STRUT_RIGIDITY_WORDS, "yes, by %s", source);
  else
    snprintf(words, STRUT_RIGIDITY_WORDS, "%s, by %s: %s",
             r->states.count == 1 ? "no" : "not shown", source, why_not(r));
  return words;
}

/* ---- elements beside members: columns of the equilibrium matrix behind those of members ---- */

typedef enum element { HINGES, CELLS, DISTANCES, ELEMENTS } element;

/* Key of their forces and of the list in JSON; words and units of a table. */
static const struct {
  const char *forces, *list, *word, *extent, *force, *extent_unit, *force_unit;
} elements[ELEMENTS] = {
    [HINGES] = {"moments", "hinges_at", "hinge", "angle", "moment", "rad", "N m"},
    [CELLS] = {"pressures", "cells_at", "cell", "area", "pressure", "m^2", "N/m"},
    [DISTANCES] = {"distance_forces", "distances_at", "distance", "distance", "force", "m", "N"}};

static size_t count_of(const strut_scene *scene, element kind) {
  const size_t counts[ELEMENTS] = {scene->hinge_count, scene->cell_count, scene->distance_count};
  return counts[kind];
}

static size_t first_of(const strut_scene *scene, element kind) {
  size_t first = scene->member_count;
  for (element before = HINGES; before < kind; before++) first += count_of(scene, before);
  return first;
}

static const char *name_of(const strut_scene *scene, element kind, size_t i) {
  return kind == HINGES  ? scene->hinges[i].name
         : kind == CELLS ? scene->cells[i].name
                         : scene->distances[i].name;
}

/* Columns are forces [N] over lengths [m]; a cell presses outwards. */
static double force_of(const strut_rigidity *r, element kind, double force) {
  return kind == HINGES  ? force * r->matrix.size
         : kind == CELLS ? -force / r->matrix.size + 0.0
                         : force;
}

static double extent_of(const strut_rigidity *r, element kind, double length) {
  return kind == HINGES  ? length / r->matrix.size
         : kind == CELLS ? length * r->matrix.size
                         : length;
}

/* A cable that does not pull in this shape. */
static bool is_idle(const strut_rigidity *r, const strut_scene *scene, size_t j) {
  return scene->members[j].kind == STRUT_CABLE && !(r->force[j] > 0.0);
}

/* ---- JSON ---- */

/* Forces by member, or force densities where lengths are given. */
static void put_map(strut_json *json, struct cJSON *to, const char *key, const strut_scene *scene,
                    const double *force, const double *length) {
  struct cJSON *map = strut_json_object(json, to, key);
  for (size_t j = 0; j < scene->member_count; j++) {
    double divisor = !length ? 1.0 : length[j];
    strut_json_number(json, map, scene->members[j].name, divisor > 0 ? force[j] / divisor : 0.0);
  }
}

/* Forces of elements beside members: moments of hinges [N m], pressures of cells [N/m], forces of distances [N]. */
static void put_elements(strut_json *json, struct cJSON *to, const char *before,
                         const strut_rigidity *r, const strut_scene *scene, const double *force) {
  for (element kind = HINGES; kind < ELEMENTS; kind++) {
    char key[60];
    if (!count_of(scene, kind)) continue;
    snprintf(key, sizeof key, "%s%s", before, elements[kind].forces);
    struct cJSON *map = strut_json_object(json, to, key);
    for (size_t i = 0; i < count_of(scene, kind); i++)
      strut_json_number(json, map, name_of(scene, kind, i),
                        force_of(r, kind, force[first_of(scene, kind) + i]));
  }
}

static void put_head(strut_json *json, const strut_rigidity *r, const strut_model *model,
                     const char *at) {
  const strut_scene *scene = model->scene;
  struct cJSON *root = json->root;
  strut_json_text(json, root, "name", scene->name);
  strut_json_text(json, root, "strut_version", STRUT_VERSION);
  strut_json_text(json, root, "at", at);
  strut_json_integer(json, root, "nodes", (int64_t)scene->node_count);
  strut_json_integer(json, root, "members", (int64_t)scene->member_count);
  if (scene->hinge_count) strut_json_integer(json, root, "hinges", (int64_t)scene->hinge_count);
  if (scene->cell_count) strut_json_integer(json, root, "cells", (int64_t)scene->cell_count);
  if (scene->distance_count)
    strut_json_integer(json, root, "distances", (int64_t)scene->distance_count);
  strut_json_integer(json, root, "free_coordinates", r->matrix.rows);
  strut_json_integer(json, root, "supports", 2 * model->node_count - r->matrix.rows);
  strut_json_text(json, root, "method", r->spaces.dense ? "svd" : "qr");
  strut_json_number(json, root, "tolerance", STRUT_RANK_TOLERANCE);
  strut_json_integer(json, root, "rank", r->spaces.rank);
  strut_json_number(json, root, "largest", r->spaces.largest);
  strut_json_number(json, root, "kept", r->spaces.kept);
  strut_json_number(json, root, "dropped", r->spaces.dropped);
  strut_json_integer(json, root, "weak", r->spaces.weak);
  strut_json_integer(json, root, "without_length", r->without_length);
}

static void put_self_stress(strut_json *json, const strut_rigidity *r, const strut_scene *scene) {
  struct cJSON *stress = strut_json_object(json, json->root, "self_stress");
  size_t columns = (size_t)r->matrix.columns;
  strut_json_integer(json, stress, "count", r->states.count);
  if (r->states.count > 0 && !r->states.force) {
    strut_json_text(json, stress, "states", NULL);
    return;
  }
  struct cJSON *states = strut_json_array(json, stress, "states");
  for (int32_t i = 0; i < r->states.count; i++) {
    const double *force = r->states.force + (size_t)i * columns;
    struct cJSON *state = strut_json_object(json, states, NULL);
    put_map(json, state, "forces", scene, force, NULL);
    put_map(json, state, "force_densities", scene, force, r->matrix.length);
    put_elements(json, state, "", r, scene, force);
    strut_json_bool(json, state, "feasible", r->states.cables_pull[i]);
  }
  if (r->states.count == 0) return;
  if (r->feasible) {
    put_map(json, stress, "feasible", scene, r->feasible, NULL);
    put_elements(json, stress, "feasible_", r, scene, r->feasible);
  } else {
    strut_json_text(json, stress, "feasible", NULL);
  }
}

/* Scaled so that the node that moves most moves by 1. */
static void put_motion(strut_json *json, struct cJSON *to, const strut_rigidity *r,
                       const strut_scene *scene, const double *motion) {
  struct cJSON *nodes = strut_json_object(json, to, "nodes");
  double largest = 0.0;
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < scene->node_count; i++) {
      double d[2];
      for (size_t k = 0; k < 2; k++) {
        int32_t row = r->matrix.row_of[2 * i + k];
        d[k] = row < 0 ? 0.0 : motion[row];
        if (pass == 1 && largest > 0) d[k] = fabs(d[k]) < 1e-13 * largest ? 0.0 : d[k] / largest;
      }
      if (pass == 0)
        largest = fmax(largest, hypot(d[0], d[1]));
      else
        strut_json_numbers(json, nodes, scene->nodes[i].name, d, 2);
    }
}

static void put_mechanisms(strut_json *json, const strut_rigidity *r, const strut_scene *scene) {
  const strut_mechanisms *m = &r->mechanisms;
  struct cJSON *to = strut_json_object(json, json->root, "mechanisms");
  strut_json_integer(json, to, "count", m->count);
  strut_json_integer(json, to, "rigid_body", m->rigid_body);
  strut_json_integer(json, to, "infinitesimal", m->infinitesimal);
  strut_json_integer(json, to, "finite", m->finite);
  strut_json_integer(json, to, "undecided", m->undecided);
  if (m->count > 0 && !m->list) {
    strut_json_text(json, to, "modes", NULL);
    return;
  }
  struct cJSON *modes = strut_json_array(json, to, "modes");
  for (int32_t i = 0; i < m->count; i++) {
    const strut_mechanism *mode = &m->list[i];
    char words[STRUT_RIGIDITY_WORDS];
    struct cJSON *row = strut_json_object(json, modes, NULL);
    strut_json_text(json, row, "kind", strut_motion_kind_name(mode->kind));
    strut_json_number(json, row, "stiffness", mode->stiffness);
    strut_json_number(json, row, "stress_form", mode->stress_form);
    strut_json_number(json, row, "moved", mode->moved);
    strut_json_number(json, row, "strain", mode->strain);
    strut_json_text(json, row, "test", mechanism_words(m, mode, words));
    put_motion(json, row, r, scene, mode->motion);
  }
  if (!m->stiffener) return;
  put_map(json, to, "stiffened_by", scene, m->stiffener, NULL);
  put_elements(json, to, "stiffened_by_", r, scene, m->stiffener);
}

static void put_verdicts(strut_json *json, const strut_rigidity *r) {
  char words[STRUT_RIGIDITY_WORDS];
  struct cJSON *root = json->root;
  struct cJSON *count = strut_json_object(json, root, "maxwell_calladine");
  strut_json_integer(json, count, "members_minus_coordinates", r->matrix.columns - r->matrix.rows);
  strut_json_integer(json, count, "self_stress_minus_mechanisms",
                     r->states.count - r->mechanisms.count);
  strut_json_integer(json, root, "class", r->bars_at_node > 1 ? r->bars_at_node : 1);
  /* of several states another combination might do it */
  bool single = r->states.count <= 1;
  bool known = r->states.count == 0 || (r->stress.tested && (single || r->stress.super_stable));
  if (known)
    strut_json_bool(json, root, "super_stable", r->stress.super_stable);
  else
    strut_json_text(json, root, "super_stable", NULL);
  strut_json_text(json, root, "super_stability", super_stability_words(r, words));
  if (r->stress.tested) {
    struct cJSON *stress = strut_json_object(json, root, "stress_matrix");
    strut_json_numbers(json, stress, "eigenvalues", r->stress.eigenvalues, (size_t)r->stress.count);
    strut_json_integer(json, stress, "nullity", r->stress.nullity);
    strut_json_text(json, stress, "of", stress_source_words(r->source));
    strut_json_text(json, stress, "on", r->stress.supported ? "free coordinates" : "nodes");
  } else {
    strut_json_text(json, root, "stress_matrix", NULL);
  }
}

static void put_tensegrity(strut_json *json, const strut_tensegrity *t) {
  struct cJSON *to = strut_json_object(json, json->root, "classification");
  strut_json_text(json, to, "label", t->label);
  strut_json_bool(json, to, "self_stress", t->self_stress);
  strut_json_bool(json, to, "cables", t->cables);
  strut_json_bool(json, to, "stiffened_mechanism", t->mechanism);
  strut_json_bool(json, to, "all_states_stiffen", t->all_states);
  strut_json_bool(json, to, "struts_apart", t->struts_apart);
  strut_json_bool(json, to, "struts_inside", t->struts_inside);
}

static void put_members(strut_json *json, const strut_rigidity *r, const strut_scene *scene) {
  strut_json_bool(json, json->root, "equilibrium", r->equilibrium);
  strut_json_number(json, json->root, "residual", r->residual);
  strut_json_bool(json, json->root, "self_equilibrium", r->self_equilibrium);
  struct cJSON *idle = strut_json_array(json, json->root, "without_force");
  for (size_t j = 0; j < scene->member_count; j++)
    if (is_idle(r, scene, j)) strut_json_text(json, idle, NULL, scene->members[j].name);
  struct cJSON *members = strut_json_object(json, json->root, "members_at");
  for (size_t j = 0; j < scene->member_count; j++) {
    struct cJSON *row = strut_json_object(json, members, scene->members[j].name);
    strut_json_text(json, row, "kind", strut_member_kind_name(scene->members[j].kind));
    strut_json_number(json, row, "length", r->matrix.length[j]);
    strut_json_number(json, row, "force", r->force[j]);
    strut_json_number(json, row, "force_density",
                      r->matrix.length[j] > 0 ? r->density[j] : (double)NAN);
  }
  for (element kind = HINGES; kind < ELEMENTS; kind++) {
    size_t count = count_of(scene, kind), first = first_of(scene, kind);
    struct cJSON *list = count ? strut_json_object(json, json->root, elements[kind].list) : NULL;
    for (size_t i = 0; i < count; i++) {
      struct cJSON *row = strut_json_object(json, list, name_of(scene, kind, i));
      strut_json_number(json, row, elements[kind].extent,
                        extent_of(r, kind, r->matrix.length[first + i]));
      strut_json_number(json, row, elements[kind].force, force_of(r, kind, r->force[first + i]));
    }
  }
}

char *strut_rigidity_json(const strut_rigidity *rigidity, const strut_model *model,
                          const char *at) {
  strut_json json = strut_json_begin();
  put_head(&json, rigidity, model, at);
  put_self_stress(&json, rigidity, model->scene);
  put_mechanisms(&json, rigidity, model->scene);
  put_verdicts(&json, rigidity);
  put_tensegrity(&json, &rigidity->tensegrity);
  put_members(&json, rigidity, model->scene);
  return strut_json_end(&json);
}

/* ---- the table ---- */

enum { MOST_ROWS = 30, MOST_STATES = 6, DIGITS = 6 };

static strut_rounded_quantity in(double value, const char *unit) {
  return strut_quantity_of(value, DIGITS, unit);
}

static void add_rank(strut_buffer *table, const strut_rigidity *r) {
  const strut_null_spaces *s = &r->spaces;
  strut_buffer_add(table, "  rank               %d of %d x %d; %s kept down to %.4g, ", s->rank,
                   r->matrix.rows, r->matrix.columns,
                   s->dense ? "singular values" : "diagonal of R", s->kept);
  if (s->dense && s->dropped > 0)
    strut_buffer_add(table, "dropped from %.1e\n", s->dropped);
  else
    strut_buffer_add(table, "%s\n", s->dense ? "the rest are zero" : "by sparse QR");
  if (s->weak > 0)
    strut_buffer_add(
        table,
        "                     %d of them below a millionth of the largest: as small a\n"
        "                     displacement of nodes may change s and f\n",
        s->weak);
}

static void add_counts(strut_buffer *table, const strut_rigidity *r, const strut_scene *scene) {
  char others[60] = "";
  int left = 0;
  for (element kind = HINGES; kind < ELEMENTS; kind++) left += count_of(scene, kind) > 0;
  for (element kind = HINGES; kind < ELEMENTS; kind++)
    if (count_of(scene, kind)) {
      size_t used = strlen(others);
      snprintf(others + used, sizeof others - used, "%s%ss", --left ? ", " : " and ",
               elements[kind].word);
    }
  const strut_mechanisms *m = &r->mechanisms;
  strut_buffer_add(table, "  self-stress        s = %d\n", r->states.count);
  strut_buffer_add(table, "  mechanisms         f = %d", m->count);
  const char *before = ": ";
  const int32_t count[] = {m->rigid_body, m->infinitesimal, m->finite, m->undecided};
  for (int i = 0; i < 4; i++) {
    if (count[i] == 0) continue;
    strut_buffer_add(table, "%s%d %s", before, count[i],
                     strut_motion_kind_name((strut_motion_kind)i));
    before = ", ";
  }
  strut_buffer_add(table,
                   "\n  Maxwell-Calladine  %d members%s - %d free coordinates = %d = s - f\n",
                   r->matrix.columns, others, r->matrix.rows, r->matrix.columns - r->matrix.rows);
}

/* Cables that do not pull here, which strut modes leaves out. */
static void add_idle(strut_buffer *table, const strut_rigidity *r, const strut_scene *scene) {
  size_t count = 0, first = 0;
  for (size_t j = scene->member_count; j-- > 0;)
    if (is_idle(r, scene, j)) count++, first = j;
  if (!count) return;
  strut_buffer_add(table, "  without force      %s", scene->members[first].name);
  if (count > 1) strut_buffer_add(table, " and %zu more", count - 1);
  strut_buffer_add(table,
                   ": slack or just taut. They count as members here;\n%21sstrut modes leaves them "
                   "out, and so finds more motions without stiffness\n",
                   "");
}

/* ": self-stress, cables in tension": what the kind is judged by. */
static void add_features(strut_buffer *table, const strut_tensegrity *t) {
  const struct {
    bool has;
    const char *text;
  } features[] = {{t->self_stress, "self-stress"},
                  {t->cables, "cables in tension"},
                  {t->mechanism, "a stiffened mechanism"},
                  {t->struts_apart, "bars apart"},
                  {t->struts_inside, "bars inside the net"}};
  const char *between = ": ";
  for (size_t i = 0; t->judged && i < sizeof features / sizeof features[0]; i++) {
    if (!features[i].has) continue;
    strut_buffer_add(table, "%s%s", between, features[i].text);
    between = ", ";
  }
}

static void add_verdicts(strut_buffer *table, const strut_rigidity *r, const strut_scene *scene) {
  char words[STRUT_RIGIDITY_WORDS];
  const strut_tensegrity *t = &r->tensegrity;
  if (r->bars_at_node > 0)
    strut_buffer_add(
        table, "  class              %d: %s\n", r->bars_at_node,
        r->bars_at_node == 1 ? "no two bars meet" : "at most this many bars meet at a node");
  strut_buffer_add(table, "  super stable       %s\n", super_stability_words(r, words));
  if (r->has_cables && r->states.force && r->states.count > 0)
    strut_buffer_add(table, "  cables             %s\n",
                     r->cables_can_pull
                         ? "one self-stress state tensions every cable that any state loads"
                         : "no self-stress state tensions every cable that some state loads");
  strut_buffer_add(table, "  kind               %s", t->label);
  add_features(table, t);
  strut_buffer_add(table, "\n  equilibrium        %s: net force on a free coordinate up to %s\n",
                   r->equilibrium ? "yes" : "no", in(r->residual, "N").text);
  add_idle(table, r, scene);
  if (r->without_length)
    strut_buffer_add(table, "  without length     %d members, which have no direction here\n",
                     r->without_length);
}

/* Forces of the states are those of elements where members have forces [N]. */
static void add_elements(strut_buffer *table, const strut_rigidity *r, const strut_scene *scene,
                         element kind, int32_t states) {
  size_t columns = (size_t)r->matrix.columns, count = count_of(scene, kind);
  if (count)
    strut_buffer_add(table, "  %-12s %-6s %12s %12s\n", elements[kind].word, "",
                     elements[kind].extent, elements[kind].force);
  for (size_t i = 0; i < count && i < MOST_ROWS; i++) {
    size_t j = first_of(scene, kind) + i;
    double extent = extent_of(r, kind, r->matrix.length[j]), force = force_of(r, kind, r->force[j]);
    strut_buffer_add(table, "  %-12s %-6s %12s %12s %13s", name_of(scene, kind, i), "",
                     strut_quantity_of_any(extent, DIGITS, elements[kind].extent_unit).text,
                     in(force, elements[kind].force_unit).text, "");
    for (int32_t k = 0; k < states; k++)
      strut_buffer_add(table, " %10.6g",
                       force_of(r, kind, r->states.force[(size_t)k * columns + j]));
    strut_buffer_add(table, "\n");
  }
  if (count > MOST_ROWS)
    strut_buffer_add(table, "  ... and %zu more; --json lists all\n", count - MOST_ROWS);
}

static void add_members(strut_buffer *table, const strut_rigidity *r, const strut_scene *scene) {
  size_t members = scene->member_count, columns = (size_t)r->matrix.columns;
  int32_t states = r->states.force ? r->states.count : 0;
  if (states > MOST_STATES) states = MOST_STATES;
  strut_buffer_add(table, "\n  %-12s %-6s %12s %12s %13s", "member", "kind", "length", "force",
                   "force density");
  for (int32_t i = 0; i < states; i++) strut_buffer_add(table, "   state %-2d", i + 1);
  strut_buffer_add(table, "\n");
  for (size_t j = 0; j < members && j < MOST_ROWS; j++) {
    strut_buffer_add(table, "  %-12s %-6s %12s %12s %13s", scene->members[j].name,
                     strut_member_kind_name(scene->members[j].kind),
                     in(r->matrix.length[j], "m").text, in(r->force[j], "N").text,
                     in(r->density[j], "N/m").text);
    for (int32_t i = 0; i < states; i++)
      strut_buffer_add(table, " %10.6g", r->states.force[(size_t)i * columns + j]);
    strut_buffer_add(table, "\n");
  }
  if (members > MOST_ROWS)
    strut_buffer_add(table, "  ... and %zu more; --json lists all\n", members - MOST_ROWS);
  for (element kind = HINGES; kind < ELEMENTS; kind++) add_elements(table, r, scene, kind, states);
  if (r->states.count > states)
    strut_buffer_add(table, "  %d more self-stress states%s\n", r->states.count - states,
                     r->states.force ? "; --json lists all" : ": too many to list");
}

static void add_modes(strut_buffer *table, const strut_mechanisms *m) {
  char words[STRUT_RIGIDITY_WORDS];
  if (m->count == 0) return;
  if (!m->list) {
    strut_buffer_add(table, "\n  too many mechanisms to list\n");
    return;
  }
  strut_buffer_add(table, "\n  mechanism\n");
  for (int32_t i = 0; i < m->count && i < MOST_ROWS; i++)
    strut_buffer_add(table, "  %-3d %-14s %s\n", i + 1, strut_motion_kind_name(m->list[i].kind),
                     mechanism_words(m, &m->list[i], words));
  if (m->count > MOST_ROWS)
    strut_buffer_add(table, "  ... and %d more; --json lists all\n", m->count - MOST_ROWS);
}

char *strut_rigidity_table(const strut_rigidity *r, const strut_model *model, const char *at) {
  strut_c_locale locale = strut_c_locale_enter();
  strut_buffer table = {0};
  const char *name = model->scene->name;
  strut_buffer_add(&table, "%s%srigidity at: %s\n", name, *name ? ": " : "", at);
  add_rank(&table, r);
  add_counts(&table, r, model->scene);
  add_verdicts(&table, r, model->scene);
  add_members(&table, r, model->scene);
  add_modes(&table, &r->mechanisms);
  strut_c_locale_leave(locale);
  return strut_buffer_take(&table);
}
