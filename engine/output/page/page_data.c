/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/page/page.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/output/buffer.h"
#include "engine/output/report/reports.h"
#include "engine/output/run_report.h"
#include "engine/scene/profile.h"

/* The data of a page. First its cards: the choice of equilibria and their data. */

struct cJSON;

/* Most cards, saddles among them, and numbers in all cards. */
enum { MOST_CARDS = 40, MOST_SADDLES = 12, MOST_NUMBERS = 60000 };

/* How far lines are drawn, in sizes of the structure at the start, which count as this at least [m]. */
static const double FAR = 100.0, LEAST_SIZE = 0.1;

/* Digits of positions and forces: more than a screen shows. */
static const int DIGITS = 9;

/* Ranks of equilibria; lower ones are shown first. */
enum { NAMED, ENDS, ELSEWHERE, BELOW_GROUND, SADDLES };

typedef struct choice {
  int32_t index;
  int rank; /* of the kinds below */
  double energy;
} choice;

static int by_rank(const void *a, const void *b) {
  const choice *x = a, *y = b;
  if (x->rank != y->rank) return x->rank < y->rank ? -1 : 1;
  if (x->energy != y->energy) return x->energy < y->energy ? -1 : 1;
  return (x->index > y->index) - (x->index < y->index);
}

static bool is_saddle(const strut_equilibrium *e) {
  return e->point.label == STRUT_SADDLE || e->point.label == STRUT_MAXIMUM;
}

/* ENDS: stable on the ground, or another equilibrium comes to rest there. */
static int rank_of(const strut_equilibrium *e) {
  if (is_saddle(e)) return SADDLES;
  if (e->outcome == STRUT_OUTCOME_BELOW_GROUND) return BELOW_GROUND;
  if (e->outcome != STRUT_OUTCOME_STANDS) return ELSEWHERE;
  return e->configured ? NAMED : ENDS;
}

/* Every equilibrium with its rank, the best first. */
static void rank_all(const strut_equilibria *all, choice *choices) {
  for (size_t i = 0; i < all->count; i++) {
    const strut_equilibrium *e = &all->list[i];
    choices[i] = (choice){(int32_t)i, rank_of(e), e->energy};
  }
  for (size_t i = 0; i < all->count; i++) {
    int32_t end = all->list[i].ends_as;
    if (end >= 0 && choices[end].rank > ENDS && choices[end].rank < SADDLES)
      choices[end].rank = ENDS;
  }
  qsort(choices, all->count, sizeof *choices, by_rank);
}

/* Moves the equilibria with cards to the front and returns their number; place[i] is the card of
   the i-th equilibrium, or -1. */
static size_t choose_cards(const strut_equilibria *all, const strut_model *model, choice *choices,
                           int32_t *place) {
  size_t each = 2 * (size_t)model->node_count + (size_t)model->members.count, saddles = 0;
  size_t most = each * MOST_CARDS > MOST_NUMBERS ? MOST_NUMBERS / each : MOST_CARDS, count = 0;
  if (most < 2) most = 2;
  rank_all(all, choices);
  for (size_t i = 0; i < all->count; i++) saddles += choices[i].rank == SADDLES;
  for (size_t i = 0; i < all->count; i++) place[i] = -1;
  for (size_t i = 0; i < all->count && i < most; i++)
    if (choices[i].rank < SADDLES || saddles <= MOST_SADDLES)
      place[choices[i].index] = (int32_t)count++;
  return count;
}

static double rounded(double value) {
  if (value == 0 || !isfinite(value)) return value;
  double unit = pow(10, DIGITS - 1 - floor(log10(fabs(value))));
  double result = round(value * unit) / unit;
  return isfinite(result) ? result : value;
}

static void add_numbers(strut_json *json, struct cJSON *to, const char *key, const double *values,
                        size_t count) {
  struct cJSON *array = strut_json_array(json, to, key);
  for (size_t i = 0; i < count; i++) strut_json_number(json, array, NULL, rounded(values[i]));
}

/* Contact forces in the shape that is shown; of held contacts their reactions. */
static void add_contacts(strut_json *json, struct cJSON *to, const strut_model *model,
                         const strut_equilibrium *e) {
  const double *up = model->contacts.normal;
  struct cJSON *contacts = strut_json_array(json, to, "contacts");
  struct cJSON *normal = strut_json_array(json, to, "normal");
  bool rests = e->outcome == STRUT_OUTCOME_STANDS || !e->supports;
  size_t count = rests ? (size_t)e->contact_count : e->supports->count;
  for (size_t i = 0; i < count; i++) {
    int32_t node = rests ? e->contacts[i] : e->supports->node[i];
    strut_json_integer(json, contacts, NULL, node);
    const double *reaction = e->reaction[node];
    double pressing = rests ? e->normal[i] : reaction[0] * up[0] + reaction[1] * up[1];
    strut_json_number(json, normal, NULL, rounded(pressing));
  }
}

static void add_card(strut_json *json, struct cJSON *to, const strut_model *model,
                     const strut_equilibrium *e) {
  const strut_critical_point *point = &e->point;
  int32_t first = point->label == STRUT_STABLE ? point->zero : 0; /* free motions apart */
  strut_json_text(json, to, "name", e->name);
  strut_json_text(json, to, "label", strut_stability_name(point->label));
  strut_json_text(json, to, "fate", strut_outcome_name(e->outcome));
  strut_json_text(json, to, "verdict", e->verdict);
  strut_json_number(json, to, "energy", e->energy);
  strut_json_bool(json, to, "stands", e->outcome == STRUT_OUTCOME_STANDS);
  add_numbers(json, to, "position", point->q, 2 * (size_t)model->node_count);
  add_numbers(json, to, "force", e->member_force, (size_t)model->members.count);
  add_contacts(json, to, model, e);
  strut_json_number(json, to, "lowest",
                    first < point->eigenvalue_count ? point->eigenvalues[first] : (double)NAN);
}

static void add_barriers(strut_json *json, const strut_equilibria *all, const int32_t *place) {
  struct cJSON *barriers = strut_json_array(json, json->root, "barriers");
  for (size_t i = 0; i < all->barrier_count; i++) {
    const strut_barrier *b = &all->barriers[i];
    if (place[b->from] < 0 || place[b->to] < 0) continue;
    struct cJSON *row = strut_json_object(json, barriers, NULL);
    strut_json_integer(json, row, "from", place[b->from]);
    strut_json_integer(json, row, "to", place[b->to]);
    strut_json_number(json, row, "height", b->height);
  }
}

static void add_no_equilibria(strut_json *json, const strut_page *page) {
  const strut_equilibria *all = page->equilibria;
  const char *remark = all && all->remark[0] ? all->remark : page->remark;
  strut_json_text(json, json->root, "equilibria", NULL);
  strut_json_text(json, json->root, "equilibria_remark", remark ? remark : "");
  strut_json_integer(json, json->root, "equilibria_left_out", 0);
  strut_json_array(json, json->root, "barriers");
}

static bool add_equilibria(strut_json *json, const strut_page *page) {
  const strut_equilibria *all = page->equilibria;
  if (!all || all->count == 0) {
    add_no_equilibria(json, page);
    return true;
  }
  choice *choices = strut_allocate(all->count, sizeof *choices);
  int32_t *place = strut_allocate(all->count, sizeof *place);
  bool good = choices && place;
  if (good) {
    size_t count = choose_cards(all, page->model, choices, place);
    struct cJSON *cards = strut_json_array(json, json->root, "equilibria");
    for (size_t i = 0; i < count; i++)
      add_card(json, strut_json_object(json, cards, NULL), page->model,
               &all->list[choices[i].index]);
    strut_json_text(json, json->root, "equilibria_remark", all->remark);
    strut_json_integer(json, json->root, "equilibria_left_out", (int64_t)(all->count - count));
    add_barriers(json, all, place);
  }
  strut_release(choices);
  strut_release(place);
  return good;
}

/* The object put together, safe inside <script>. */

static const size_t MOST_BYTES = 4000000, MOST_YAML = 600000;

static void add_row(strut_json *json, struct cJSON *rows, const char *label, const char *value) {
  struct cJSON *row = strut_json_object(json, rows, NULL);
  strut_json_text(json, row, "label", label);
  strut_json_text(json, row, "value", value);
}

static void add_nodes(strut_json *json, const strut_scene *scene) {
  struct cJSON *nodes = strut_json_array(json, json->root, "nodes");
  for (size_t i = 0; i < scene->node_count; i++) {
    struct cJSON *node = strut_json_object(json, nodes, NULL);
    strut_json_text(json, node, "name", scene->nodes[i].name);
    struct cJSON *fixed = strut_json_array(json, node, "fixed");
    for (int c = 0; c < 2; c++) strut_json_bool(json, fixed, NULL, scene->nodes[i].fixed[c]);
  }
}

static void add_members(strut_json *json, const strut_scene *scene) {
  struct cJSON *members = strut_json_array(json, json->root, "members");
  for (size_t i = 0; i < scene->member_count; i++) {
    const strut_member *member = &scene->members[i];
    struct cJSON *to = strut_json_object(json, members, NULL);
    strut_json_text(json, to, "name", member->name);
    strut_json_integer(json, to, "from", member->node[0]);
    strut_json_integer(json, to, "to", member->node[1]);
    strut_json_text(json, to, "kind", strut_member_kind_name(member->kind));
    if (!member->guide_count) continue;
    struct cJSON *guides = strut_json_array(json, to, "guides");
    for (size_t k = 0; k < member->guide_count; k++)
      strut_json_integer(json, guides, NULL, member->guides[k]);
  }
}

static void add_hinges(strut_json *json, const strut_scene *scene) {
  struct cJSON *hinges = strut_json_array(json, json->root, "hinges");
  for (size_t i = 0; i < scene->hinge_count; i++) {
    struct cJSON *to = strut_json_object(json, hinges, NULL);
    strut_json_text(json, to, "name", scene->hinges[i].name);
    struct cJSON *nodes = strut_json_array(json, to, "nodes");
    for (int k = 0; k < 3; k++) strut_json_integer(json, nodes, NULL, scene->hinges[i].node[k]);
    strut_json_number(json, to, "rest_angle", strut_hinge_rest(scene, i));
  }
}

static void add_cells(strut_json *json, const strut_scene *scene) {
  struct cJSON *cells = strut_json_array(json, json->root, "cells");
  for (size_t i = 0; i < scene->cell_count; i++) {
    const strut_cell *cell = &scene->cells[i];
    struct cJSON *to = strut_json_object(json, cells, NULL);
    strut_json_text(json, to, "name", cell->name);
    struct cJSON *nodes = strut_json_array(json, to, "nodes");
    for (size_t k = 0; k < cell->node_count; k++)
      strut_json_integer(json, nodes, NULL, cell->node[k]);
  }
}

static void add_collisions(strut_json *json, const strut_scene *scene) {
  struct cJSON *collisions = strut_json_array(json, json->root, "collisions");
  for (size_t i = 0; i < scene->collision_count; i++) {
    const strut_collision *c = &scene->collisions[i];
    struct cJSON *to = strut_json_object(json, collisions, NULL);
    strut_json_text(json, to, "name", c->name);
    strut_json_number(json, to, "thickness", c->thickness);
    struct cJSON *nodes = strut_json_array(json, to, "nodes");
    struct cJSON *members = strut_json_array(json, to, "members");
    for (int k = 0; k < 2; k++) {
      if (c->node[k] >= 0) strut_json_integer(json, nodes, NULL, c->node[k]);
      if (c->member[k] >= 0) strut_json_integer(json, members, NULL, c->member[k]);
    }
  }
}

/* Outlines of several grounds, the solid to the right of their direction, and which one a contact is with. */
static void add_surfaces(strut_json *json, const strut_scene *scene) {
  struct cJSON *names = strut_json_array(json, json->root, "contact_names");
  struct cJSON *of = strut_json_array(json, json->root, "contact_surfaces");
  struct cJSON *surfaces = strut_json_array(json, json->root, "surfaces");
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < scene->contact_count; i++) {
    strut_json_text(json, names, NULL, strut_contact_name(scene, i));
    strut_json_integer(json, of, NULL, scene->contacts[i].ground);
  }
  for (size_t i = 0; i < 2 * scene->node_count; i++) {
    double x = scene->nodes[i / 2].start[i % 2];
    low[i % 2] = fmin(low[i % 2], x), high[i % 2] = fmax(high[i % 2], x);
  }
  const double middle[2] = {0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])};
  double far = FAR * fmax(fmax(high[0] - low[0], high[1] - low[1]), LEAST_SIZE);
  for (size_t g = 0; g < scene->ground_count; g++) {
    strut_arena arena = {0};
    double(*points)[2] =
        strut_arena_allocate(&arena, strut_outline_most(&scene->grounds[g]), sizeof *points);
    size_t count = points ? strut_outline_of(&scene->grounds[g], NULL, middle, far, points) : 0;
    struct cJSON *to = strut_json_array(json, surfaces, NULL);
    for (size_t k = 0; k < count; k++) {
      struct cJSON *point = strut_json_array(json, to, NULL);
      strut_json_number(json, point, NULL, rounded(points[k][0]));
      strut_json_number(json, point, NULL, rounded(points[k][1]));
    }
    strut_arena_free(&arena);
  }
}

static void add_ground(strut_json *json, const strut_scene *scene) {
  struct cJSON *contacts = strut_json_array(json, json->root, "contacts");
  for (size_t i = 0; i < scene->contact_count; i++)
    strut_json_integer(json, contacts, NULL, scene->contacts[i].node);
  if (scene->ground_count) add_surfaces(json, scene);
  if (!scene->ground.present) {
    strut_json_text(json, json->root, "ground", NULL);
    return;
  }
  struct cJSON *ground = strut_json_object(json, json->root, "ground");
  strut_json_number(json, ground, "height", scene->ground.height);
  strut_json_number(json, ground, "slope", scene->ground.slope);
  strut_json_number(json, ground, "belt_speed", scene->ground.belt_speed);
}

/* Parameters as they were used, with the method and step of a run. */
static void add_parameters(strut_json *json, const strut_scene *scene,
                           const strut_experiment *experiment, bool run) {
  struct cJSON *rows = strut_json_array(json, json->root, "parameters");
  for (size_t i = 0; i < scene->parameter_count; i++)
    add_row(json, rows, scene->parameters[i].name, scene->parameters[i].text);
  if (!run) return;
  if (experiment->accuracy > 0) { /* chooses both */
    char text[32];
    snprintf(text, sizeof text, "%g", experiment->accuracy);
    add_row(json, rows, "accuracy", text);
    return;
  }
  add_row(json, rows, "integration method", experiment->integrator);
  if (experiment->step > 0)
    add_row(json, rows, "integration step", strut_quantity_of(experiment->step, 4, "s").text);
}

/* The scene's text; of a very long one its beginning, up to the end of a line. */
static bool add_yaml(strut_json *json, const char *yaml) {
  size_t length = strlen(yaml), kept = length;
  if (length > MOST_YAML) {
    kept = MOST_YAML;
    while (kept > 0 && yaml[kept - 1] != '\n') kept--;
  }
  strut_buffer text = {0};
  strut_buffer_add(&text, "%.*s", (int)kept, yaml);
  if (kept < length)
    strut_buffer_add(&text, "# ... and %zu bytes more, which are left out here\n", length - kept);
  char *shown = strut_buffer_take(&text);
  if (shown) strut_json_text(json, json->root, "yaml", shown);
  strut_release(shown);
  return shown;
}

/* Everything but the motion. */
static char *still_data(const strut_page *page) {
  const strut_model *model = page->model;
  const strut_scene *scene = model->scene;
  strut_json json = strut_json_begin();
  strut_json_text(&json, json.root, "strut", STRUT_VERSION);
  strut_json_text(&json, json.root, "name", scene->name);
  strut_json_text(&json, json.root, "description", scene->description);
  strut_json_text(&json, json.root, "source", scene->source);
  strut_json_text(&json, json.root, "label", page->label ? page->label : "");
  add_nodes(&json, scene);
  add_members(&json, scene);
  add_hinges(&json, scene);
  add_cells(&json, scene);
  add_collisions(&json, scene);
  add_ground(&json, scene);
  strut_json_numbers(&json, json.root, "start", model->start, 2 * (size_t)model->node_count);
  strut_json_number(&json, json.root, "size", model->size);
  if (!add_equilibria(&json, page)) json.failed = true;
  add_parameters(&json, scene, page->experiment, page->motion != NULL);
  struct cJSON *rows = strut_json_array(&json, json.root, "summary");
  strut_summary_rows(&json, rows, page->summary, page->experiment, scene);
  if (!add_yaml(&json, page->yaml)) json.failed = true;
  strut_json_text(&json, json.root, "study", NULL);
  return strut_json_end(&json);
}

/* The escape for a character that must not occur in <script>, or NULL. */
static const char *escape(const unsigned char *at, size_t *taken) {
  *taken = 1;
  switch (*at) {
    case '<': return "\\u003c";
    case '>': return "\\u003e";
    case '&': return "\\u0026";
    case 0xe2:
      if (at[1] != 0x80 || (at[2] != 0xa8 && at[2] != 0xa9)) return NULL;
      *taken = 3;
      return at[2] == 0xa8 ? "\\u2028" : "\\u2029";
    default: return NULL;
  }
}

/* Appends JSON as it may stand in <script>, without what cJSON puts between things: the end of a
   line and a tab are never within a text. */
static void add_safe(strut_buffer *buffer, const char *json) {
  const char *from = json;
  for (const char *at = json;; at++) {
    size_t taken = 1;
    const char *other = *at == '\n' || *at == '\t' ? "" : escape((const unsigned char *)at, &taken);
    if (*at && !other) continue;
    strut_buffer_add(buffer, "%.*s%s", (int)(at - from), from, other ? other : "");
    if (!*at) return;
    at += taken - 1;
    from = at + 1;
  }
}

/* The object, or NULL when memory is out. */
static char *write_data(const strut_page *page, strut_page_frames *frames) {
  size_t most = page->most_bytes ? page->most_bytes : MOST_BYTES;
  char *still = still_data(page);
  strut_buffer buffer = {0};
  if (!still) return NULL;
  add_safe(&buffer, still);
  strut_release(still);
  if (buffer.failed) {
    strut_release(strut_buffer_take(&buffer));
    return NULL;
  }
  size_t room = most > 2 * buffer.length ? most - buffer.length : most / 2;
  buffer.text[--buffer.length] = '\0'; /* its last brace; the motion comes before it */
  strut_buffer_add(&buffer, ",\"motion\":");
  strut_page_add_motion(&buffer, page, room, frames);
  strut_buffer_add(&buffer, "}\n");
  return strut_buffer_take(&buffer);
}

char *strut_page_data(const strut_page *page, strut_page_frames *frames, strut_error *error) {
  strut_page_frames taken = {0};
  char *data = write_data(page, &taken);
  if (!data) strut_no_memory(error, "for the page");
  if (frames) *frames = taken;
  return data;
}
