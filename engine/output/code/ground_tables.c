/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contacts, their laws, and the surfaces that they touch, as static tables. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/output/code/writer.h"

/* ---- which there are ---- */

typedef enum shape { LINE, PIECE, CIRCLE } shape;

static shape shape_of(const strut_surface *s) {
  if (!s->facets) return CIRCLE;
  return s->facets == 1 && s->before == HUGE_VAL && s->beyond == HUGE_VAL ? LINE : PIECE;
}

static bool has_shape(const strut_code_writer *w, shape wanted) {
  const strut_contact_table *t = &w->model->contacts;
  for (int32_t i = 0; i < t->surfaces; i++)
    if (shape_of(&t->surface[i]) == wanted) return true;
  return false;
}
bool strut_code_has_circles(const strut_code_writer *w) { return has_shape(w, CIRCLE); }
bool strut_code_has_pieces(const strut_code_writer *w) { return has_shape(w, PIECE); }

static bool has_facets(const strut_code_writer *w) {
  return has_shape(w, LINE) || has_shape(w, PIECE);
}

static bool has_belts(const strut_code_writer *w) {
  const strut_contact_table *t = &w->model->contacts;
  for (int32_t i = 0; i < t->surfaces; i++)
    if (t->surface[i].belt_speed != 0.0) return true;
  return false;
}

/* The most contacts of one node. */
static int32_t most_touches(const strut_contact_table *t) {
  int32_t most = 1;
  for (int32_t i = 0, first = 0; i < t->count; i++) {
    if (t->at[i] != t->at[first]) first = i;
    if (i + 1 - first > most) most = i + 1 - first;
  }
  return most;
}
static bool has_corners(const strut_code_writer *w) {
  return most_touches(&w->model->contacts) > 1;
}

/* ---- grounds that are shaken ---- */

int32_t strut_code_shake_count(const strut_model *model) {
  const strut_scene *scene = model->scene;
  int32_t count = 0;
  for (size_t g = 0; g < scene->ground_count && model->contacts.moves; g++)
    count += scene->grounds[g].moves[0] + scene->grounds[g].moves[1];
  return count;
}

const strut_ground *strut_code_shaken(const strut_model *model, int32_t n, int *axis) {
  const strut_scene *scene = model->scene;
  for (size_t g = 0; g < scene->ground_count; g++)
    for (*axis = 0; *axis < 2; (*axis)++)
      if (scene->grounds[g].moves[*axis] && n-- == 0) return &scene->grounds[g];
  return NULL;
}

/* The input that moves a ground along an axis; -1: it does not move so. */
static int32_t shake_of(const strut_code_writer *w, int32_t ground, int axis) {
  const strut_scene *scene = w->scene;
  int32_t count = strut_code_shake_count(w->model), own;
  for (int32_t n = 0; n < count; n++)
    if (strut_code_shaken(w->model, n, &own) == &scene->grounds[ground] && own == axis)
      return strut_code_input_count(w->model) - count + n;
  return -1;
}

static bool has_shaken(const strut_code_writer *w) { return strut_code_shake_count(w->model) > 0; }
static bool has_surfaces(const strut_code_writer *w) {
  return w->model->terms & STRUT_TERM_SURFACES;
}

/* ---- contacts ---- */

/* The one straight line at rest. */
static void add_line(strut_code_writer *w) {
  const strut_contact_table *t = &w->model->contacts;
  if (strut_code_holds(w, "slope")) {
    strut_code_add_constant(w, "tangent_x", t->tangent[0]);
    strut_code_add_constant(w, "tangent_y", t->tangent[1]);
    strut_code_add_constant(w, "normal_x", t->normal[0]);
    strut_code_add_constant(w, "normal_y", t->normal[1]);
  }
  strut_code_add_constant(w, "height", t->height);
  if (strut_code_holds(w, "friction") && t->belt_speed != 0.0)
    strut_code_add_constant(w, "belt_speed", t->belt_speed);
}

/* ---- laws ---- */

static const char *const friction_names[] = {
#define STRUT_NAME(NAME, name, ...) #name,
    STRUT_FRICTION_LAWS(STRUT_NAME)
#undef STRUT_NAME
};

/* The first law from k on that some contact has; STRUT_FRICTION_LAW_COUNT: none. */
static int law_from(const strut_code_writer *w, int k) {
  const strut_contact_table *c = &w->model->contacts;
  int first = STRUT_FRICTION_LAW_COUNT;
  for (int32_t i = 0; i < c->count; i++) {
    int law = (int)c->entry[i].friction.law;
    if (law >= k && law < first) first = law;
  }
  return first;
}

enum { LAWS = STRUT_FRICTION_LAW_COUNT };

static bool has_band_of(int law) { return strut_friction_has_band((strut_friction_law)law); }

static bool has_bands(const strut_code_writer *w) {
  bool any = false;
  for (int k = law_from(w, 0); k < LAWS; k = law_from(w, k + 1)) any = any || has_band_of(k);
  return any && strut_code_holds(w, "friction");
}

const strut_code_condition strut_code_ground_conditions[] = {
    {"surfaces", has_surfaces},        {"shaken", has_shaken}, {"circles", strut_code_has_circles},
    {"pieces", strut_code_has_pieces}, {"facets", has_facets}, {"belts", has_belts},
    {"corners", has_corners},          {"band", has_bands},    {NULL, NULL},
};

/* The constant that stands for a law, behind some text. */
static void add_law_name(strut_code_writer *w, const char *before, int law) {
  strut_buffer_add(&w->text, "%sFRICTION_", before);
  for (const char *c = friction_names[law]; *c; c++)
    strut_buffer_add(&w->text, "%c", toupper((unsigned char)*c));
}

void strut_code_add_ground_law(strut_code_writer *w) {
  strut_code_add_law(w, "ground_spring");
  strut_code_add_law(w, "ground_damper");
}

static void add_choice_of_friction(strut_code_writer *w, bool directional) {
  const char *of = directional ? "&towards" : "&c->friction";
  strut_buffer_add(&w->text, "  switch (c->law) {\n");
  for (int k = law_from(w, 0); k < LAWS; k = law_from(w, k + 1)) {
    add_law_name(w, "    case ", k);
    strut_buffer_add(&w->text, ": return friction_%s(%s, normal, slip, applied);\n",
                     friction_names[k], of);
  }
  strut_buffer_add(&w->text, "  }\n  return 0;\n}\n\n");
}

/* The contacts that may stick, where several touch one node. */
static void add_bands(strut_code_writer *w) {
  strut_buffer_add(&w->text, "static int has_band(const contact *c) {\n  switch (c->law) {\n");
  for (int k = law_from(w, 0); k < LAWS; k = law_from(w, k + 1)) {
    add_law_name(w, "    case ", k);
    strut_buffer_add(&w->text, ": return %d;\n", has_band_of(k));
  }
  strut_buffer_add(&w->text, "  }\n  return 0;\n}\n\n");
  strut_code_add_law(w, "friction_holding");
  strut_code_add_law(w, "friction_sliding");
}

void strut_code_add_friction(strut_code_writer *w) {
  bool directional = strut_code_holds(w, "directional");
  char name[64];
  for (int k = law_from(w, 0); k < LAWS; k = law_from(w, k + 1)) {
    snprintf(name, sizeof name, "friction_%s", friction_names[k]);
    strut_code_add_law(w, name);
  }
  if (directional) strut_code_add_law(w, "friction_towards");
  strut_buffer_add(&w->text,
                   "/* Friction under the normal force, at a sliding speed, where the other "
                   "forces along the ground are `applied`. */\n"
                   "static real friction_of(const contact *c, real normal, real slip, "
                   "real applied) {\n");
  if (directional)
    strut_buffer_add(
        &w->text,
        "  mask moves = magnitude(slip) >= c->friction.stick_velocity && magnitude(slip) > 0;\n"
        "  const friction_numbers towards = friction_towards(&c->friction, (moves ? slip : "
        "applied) "
        "< 0);\n");
  add_choice_of_friction(w, directional);
  if (has_bands(w) && has_corners(w)) add_bands(w);
}

/* Do directions have coefficients of their own, or does the text that holds corners read them? */
static bool has_backward(const strut_code_writer *w) {
  return strut_code_holds(w, "directional") || (has_bands(w) && has_corners(w));
}

/* Does a law in use, or the choice among directions, read number p? The latter reads what the law with a band does. */
static bool has_number(const strut_code_writer *w, int p) {
  bool reads = has_backward(w) && strut_friction_needs(STRUT_FRICTION_KARNOPP, p);
  for (int k = law_from(w, 0); k < LAWS; k = law_from(w, k + 1))
    reads = reads || strut_friction_needs((strut_friction_law)k, p);
  return reads;
}

static void add_friction_numbers(strut_code_writer *w) {
  strut_buffer_add(&w->text,
                   "/* What the laws below read. */\ntypedef struct friction_numbers {\n");
  for (int p = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++)
    if (has_number(w, p)) strut_buffer_add(&w->text, "  real %s;\n", strut_friction_key(p));
  if (has_backward(w))
    strut_buffer_add(&w->text,
                     "  real mu_static_backward, mu_kinetic_backward; /* towards -x */\n");
  strut_buffer_add(&w->text, "} friction_numbers;\n\nenum {");
  for (int k = law_from(w, 0); k < LAWS; k = law_from(w, k + 1))
    add_law_name(w, k == law_from(w, 0) ? " " : ", ", k);
  strut_buffer_add(&w->text, " };\n\n");
}

static void add_contact_type(strut_code_writer *w) {
  bool friction = strut_code_holds(w, "friction"), surfaces = strut_code_holds(w, "surfaces");
  strut_code_add_law(w, "ground_numbers");
  if (friction) add_friction_numbers(w);
  strut_buffer_add(&w->text,
                   "typedef struct contact {\n"
                   "  index_type at; /* where the x of its node stands */\n%s"
                   "  ground_numbers ground;\n%s} contact;\n\n",
                   surfaces ? "  index_type surface; /* which of surfaces */\n" : "",
                   friction ? "  friction_numbers friction;\n  int law; /* of friction */\n" : "");
}

static void add_contact(strut_code_writer *w, int32_t i) {
  const strut_contact_table *t = &w->model->contacts;
  const strut_contact_entry *e = &t->entry[i];
  const strut_friction *f = &e->friction;
  strut_buffer_add(&w->text, "    {%u", t->at[i]);
  if (strut_code_holds(w, "surfaces")) strut_buffer_add(&w->text, ", %d", t->surface_of[i]);
  strut_buffer_add(&w->text, ", {");
  strut_code_add_real(w, -e->stiffness);
  strut_code_add_field(w, -e->damping);
  strut_code_add_field(w, e->dissipation);
  strut_buffer_add(&w->text, "}");
  if (strut_code_holds(w, "friction")) {
    strut_buffer_add(&w->text, ", {");
    for (int p = 0, any = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++) {
      if (!has_number(w, p)) continue;
      if (any++) strut_buffer_add(&w->text, ", ");
      strut_code_add_real(w, strut_friction_value(f, p));
    }
    if (has_backward(w)) strut_code_add_field(w, strut_friction_static(f, -1.0));
    if (has_backward(w)) strut_code_add_field(w, strut_friction_kinetic(f, -1.0));
    add_law_name(w, "}, ", (int)f->law);
  }
  strut_code_end_row(w, strut_contact_name(w->scene, (size_t)i));
}

void strut_code_add_contacts(strut_code_writer *w) {
  const strut_contact_table *t = &w->model->contacts;
  if (!strut_code_holds(w, "contact")) return;
  if (!strut_code_holds(w, "surfaces")) add_line(w);
  add_contact_type(w);
  strut_buffer_add(&w->text, "static const contact contacts[] = {\n");
  for (int32_t i = 0; i < t->count; i++) add_contact(w, i);
  strut_buffer_add(&w->text, "};\n\n");
}

/* ---- surfaces ---- */

static void add_facet(strut_code_writer *w, const strut_surface *s, int32_t k) {
  const strut_facet *f = &s->facet[k];
  strut_buffer_add(&w->text, "    {");
  strut_code_add_real(w, f->point[0]);
  strut_code_add_field(w, f->point[1]);
  strut_code_add_field(w, f->axes.tangent[0]);
  strut_code_add_field(w, f->axes.tangent[1]);
  strut_code_add_field(w, f->axes.normal[0]);
  strut_code_add_field(w, f->axes.normal[1]);
  strut_code_add_field(w, f->length < HUGE_VAL ? f->length : 0.0);
  strut_code_end_row(w, w->scene->grounds[s->ground].name);
}

static void add_reach(strut_code_writer *w, const strut_surface *s, double reach) {
  if (shape_of(s) != PIECE || reach < HUGE_VAL)
    strut_code_add_field(w, shape_of(s) == PIECE ? reach : 0.0);
  else
    strut_buffer_add(&w->text, ", (real)HUGE_VAL");
}

/* The fields of struct surface in grounds.c.in. */
static void add_surface(strut_code_writer *w, const strut_surface *s, int32_t first) {
  static const char *const names[] = {"LINE", "PIECE", "CIRCLE"};
  strut_buffer_add(&w->text, "    {%s, %d, %d", names[shape_of(s)], first, s->facets);
  add_reach(w, s, s->before);
  add_reach(w, s, s->beyond);
  if (strut_code_has_circles(w)) {
    strut_code_add_field(w, s->centre[0]);
    strut_code_add_field(w, s->centre[1]);
    strut_code_add_field(w, s->radius);
    strut_code_add_field(w, s->inside ? -1.0 : 1.0);
  }
  if (has_belts(w)) strut_code_add_field(w, s->belt_speed);
  if (w->model->contacts.moves)
    strut_buffer_add(&w->text, ", %d, %d", shake_of(w, s->ground, 0), shake_of(w, s->ground, 1));
  strut_code_end_row(w, w->scene->grounds[s->ground].name);
}

void strut_code_add_surfaces(strut_code_writer *w) {
  const strut_contact_table *t = &w->model->contacts;
  int32_t first = 0;
  if (has_facets(w)) {
    strut_buffer_add(&w->text, "static const facet facets[] = {\n");
    for (int32_t i = 0; i < t->surfaces; i++)
      for (int32_t k = 0; k < t->surface[i].facets; k++) add_facet(w, &t->surface[i], k);
    strut_buffer_add(&w->text, "};\n\n");
  }
  strut_buffer_add(&w->text, "static const surface surfaces[] = {\n");
  for (int32_t i = 0; i < t->surfaces; first += t->surface[i++].facets)
    add_surface(w, &t->surface[i], first);
  strut_buffer_add(&w->text, "};\n\nenum { MOST_TOUCHES = %d }; /* of one node */\n\n",
                   most_touches(t));
}
