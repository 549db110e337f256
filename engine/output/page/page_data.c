/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/page/page.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/output/buffer.h"
#include "engine/output/result_values.h"
#include "engine/output/run_report.h"
#include "engine/scene/profile.h"

/* The data of a page. First its cards: the choice of equilibria. */

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

static int by_rank(const void *first, const void *second) {
  const choice *self = first, *y = second;
  if (self->rank != y->rank) return self->rank < y->rank ? -1 : 1;
  if (self->energy != y->energy) return self->energy < y->energy ? -1 : 1;
  return (self->index > y->index) - (self->index < y->index);
}

static bool is_saddle(const strut_equilibrium *equilibrium) {
  return equilibrium->point.label == STRUT_SADDLE || equilibrium->point.label == STRUT_MAXIMUM;
}

/* ENDS: stable on the ground, or another equilibrium comes to rest there. */
static int rank_of(const strut_equilibrium *equilibrium) {
  if (is_saddle(equilibrium)) return SADDLES;
  if (equilibrium->outcome == STRUT_OUTCOME_BELOW_GROUND) return BELOW_GROUND;
  if (equilibrium->outcome != STRUT_OUTCOME_STANDS) return ELSEWHERE;
  return equilibrium->configured ? NAMED : ENDS;
}

/* Every equilibrium with its rank, the best first. */
static void rank_all(const strut_equilibria *all, choice *choices) {
  for (size_t i = 0; i < all->count; i++) {
    const strut_equilibrium *equilibrium = &all->list[i];
    choices[i] = (choice){(int32_t)i, rank_of(equilibrium), equilibrium->energy};
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

/* ---- values ---- */

/* What a page shows, put together. */
typedef struct content {
  const strut_page *page;
  size_t card_count; /* of the choices */
  choice *choices;
  int32_t *place; /* see choose_cards */
  strut_shown parameters, summary;
  char *yaml;
  strut_arena *arena;
  double middle[2], far; /* how far outlines of grounds are drawn */
} content;

/* Contact forces in the shape that is shown; of held contacts their reactions. */
static bool rests(const strut_equilibrium *equilibrium) {
  return equilibrium->outcome == STRUT_OUTCOME_STANDS || !equilibrium->supports;
}

static const strut_equilibrium *equilibrium_of(const strut_result_object *of) {
  const content *self = strut_result_whole(of);
  return &self->page->equilibria->list[((const choice *)of->at)->index];
}

static strut_value pressing(const strut_result_object *of, size_t i) {
  const strut_equilibrium *equilibrium = equilibrium_of(of);
  const double *up = ((const content *)of->outer->at)->page->model->contacts.normal;
  const double *reaction =
      rests(equilibrium) ? up : equilibrium->reaction[equilibrium->supports->node[i]];
  double normal =
      rests(equilibrium) ? equilibrium->normal[i] : reaction[0] * up[0] + reaction[1] * up[1];
  return STRUT_VALUE_AS_ROUNDED(DIGITS, NUMBER(normal));
}

#define CARD(X)                                                                                    \
  X("name", "", TEXT(e->name), "its name")                                                         \
  X("label", "", TEXT(strut_stability_name(point->label)), "stable, saddle, ...")                  \
  X("fate", "", TEXT(strut_outcome_name(e->outcome)), "what becomes of it on the real ground")     \
  X("verdict", "", TEXT(e->verdict), "a sentence")                                                 \
  X("energy", "J", NUMBER(e->energy), "at rest")                                                   \
  X("stands", "", FLAG(e->outcome == STRUT_OUTCOME_STANDS), "whether it does")                     \
  X("position", "m", ROUNDED(DIGITS, NUMBERS(point->q, 2 * model->node_count)), "of nodes")        \
  X("force", "N", ROUNDED(DIGITS, NUMBERS(e->member_force, model->members.count)), "of members")   \
  X("contacts", "", INDICES(rests(e) ? e->contacts : e->supports->node, contacts), "node indices") \
  X("normal", "N", ARRAY(contacts, pressing), "of the ground, or of supports")                     \
  X("lowest", "N/m",                                                                               \
    NUMBER(first < point->eigenvalue_count ? point->eigenvalues[first] : (double)NAN),             \
    "eigenvalue")
STRUT_VALUES_HERE(card_values, CARD, const strut_equilibrium *e = equilibrium_of(of);
                  const strut_model *model = ((const content *)of->outer->at)->page->model;
                  const strut_critical_point *point = &e->point;
                  int32_t first = point->label == STRUT_STABLE ? point->zero
                                                               : 0; /* free motions apart */
                  size_t contacts = rests(e) ? (size_t)e->contact_count : e->supports->count)

#define BARRIER(X)                                                                                 \
  X("from", "", COUNT(place[barrier->from]), "index into equilibria")                              \
  X("to", "", COUNT(place[barrier->to]), "likewise")                                               \
  X("height", "J", NUMBER(barrier->height), "above it")
STRUT_VALUES_HERE(barrier_values, BARRIER, const strut_barrier *barrier = of->at;
                  const int32_t *place = ((const content *)of->outer->at)->place)

static bool has_barrier(const strut_result_object *of, size_t i) {
  const content *self = of->at;
  const strut_barrier *b = &self->page->equilibria->barriers[i];
  return self->place[b->from] >= 0 && self->place[b->to] >= 0;
}

static strut_value fixed_of(const strut_result_object *of, size_t k) {
  return STRUT_VALUE_AS_FLAG(((const strut_node *)of->at)->fixed[k]);
}

#define NODE(X)                                                                                    \
  X("name", "", TEXT(node->name), "its name") X("fixed", "", ARRAY(2, fixed_of), "along x and y")
STRUT_VALUES_HERE(node_values, NODE, const strut_node *node = of->at)

#define MEMBER(X)                                                                                  \
  X("name", "", TEXT(m->name), "its name")                                                         \
  X("from", "", COUNT(m->node[0]), "node index")                                                   \
  X("to", "", COUNT(m->node[1]), "node index")                                                     \
  X("kind", "", TEXT(strut_member_kind_name(m->kind)), "bar, spring or cable")                     \
  X("guides", "", IF(m->guide_count, INDICES(m->guides, m->guide_count)), "node indices")
STRUT_VALUES_HERE(member_values, MEMBER, const strut_member *m = of->at)

#define HINGE(X)                                                                                   \
  X("name", "", TEXT(hinge->name), "its name")                                                     \
  X("nodes", "", INDICES(hinge->node, 3), "indices")                                               \
  X("rest_angle", "rad", NUMBER(strut_hinge_rest(of->scene, of->index)), "without moment")
STRUT_VALUES_HERE(hinge_values, HINGE, const strut_hinge *hinge = of->at)

#define CELL(X)                                                                                    \
  X("name", "", TEXT(cell->name), "its name")                                                      \
  X("nodes", "", INDICES(cell->node, cell->node_count), "indices")
STRUT_VALUES_HERE(cell_values, CELL, const strut_cell *cell = of->at)

#define COLLISION(X)                                                                               \
  X("name", "", TEXT(c->name), "its name")                                                         \
  X("thickness", "m", NUMBER(c->thickness), "of both together")                                    \
  X("nodes", "", INDICES(c->node, 2), "indices")                                                   \
  X("members", "", INDICES(c->member, 2), "indices")
STRUT_VALUES_HERE(collision_values, COLLISION, const strut_collision *c = of->at)

#define GROUND(X)                                                                                  \
  X("height", "m", NUMBER(ground->height), "at x = 0")                                             \
  X("slope", "rad", NUMBER(ground->slope), "of it")                                                \
  X("belt_speed", "m/s", NUMBER(ground->belt_speed), "along it")
STRUT_VALUES_HERE(ground_values, GROUND, const strut_ground *ground = of->at)

#define SHOWN(X) X("label", "", TEXT(row->label), "text") X("value", "", TEXT(row->value), "text")
STRUT_VALUES_HERE(shown_values, SHOWN, const strut_shown_row *row = of->at)

static strut_value contact_name(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_TEXT(strut_contact_name(of->scene, i));
}

static strut_value contact_node(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_COUNT(of->scene->contacts[i].node);
}

static strut_value contact_ground(const strut_result_object *of, size_t i) {
  return STRUT_VALUE_AS_COUNT(of->scene->contacts[i].ground);
}

/* The outline of one of several grounds, the solid to the right of its direction. */
static strut_value surface_of(const strut_result_object *of, size_t g) {
  const content *self = of->at;
  const strut_ground *ground = &of->scene->grounds[g];
  double(*points)[2] =
      strut_arena_allocate(self->arena, strut_outline_most(ground), sizeof *points);
  size_t count = points ? strut_outline_of(ground, NULL, self->middle, self->far, points) : 0;
  return STRUT_VALUE_AS_ROUNDED(DIGITS, TABLE(points, count, 2));
}

/* Everything but the motion: see page.h. */
#define PAGE(X)                                                                                    \
  X("strut", "", TEXT(STRUT_VERSION), "version")                                                   \
  X("name", "", TEXT(s->name), "of the scene")                                                     \
  X("description", "", TEXT(s->description), "of the scene")                                       \
  X("source", "", TEXT(s->source), "of the scene")                                                 \
  X("label", "", TEXT(page->label ? page->label : ""), "tells two runs on a page apart, or empty") \
  X("nodes", "", LIST(s->nodes, s->node_count), "all", .rows = &node_values)                       \
  X("members", "", LIST(s->members, s->member_count), "all", .rows = &member_values)               \
  X("hinges", "", LIST(s->hinges, s->hinge_count), "all", .rows = &hinge_values)                   \
  X("cells", "", LIST(s->cells, s->cell_count), "all", .rows = &cell_values)                       \
  X("collisions", "", LIST(s->collisions, s->collision_count), "", .rows = &collision_values)      \
  X("contacts", "", ARRAY(contacts, contact_node), "node indices")                                 \
  X("contact_names", "", IF(grounds, ARRAY(contacts, contact_name)), "of several grounds")         \
  X("contact_surfaces", "", IF(grounds, ARRAY(contacts, contact_ground)), "index into surfaces")   \
  X("surfaces", "", IF(grounds, ARRAY(grounds, surface_of)), "outlines, the solid to their right") \
  X("ground", "", KNOWN(s->ground.present, PART(&s->ground)), "one line", .rows = &ground_values)  \
  X("start", "m", NUMBERS(m->start, 2 * m->node_count), "x and y of all nodes at t = 0")           \
  X("size", "m", NUMBER(m->size), "largest extent")                                                \
  X("equilibria", "", KNOWN(c->place, LIST(c->choices, c->card_count)), "", .rows = &card_values)  \
  X("equilibria_remark", "", TEXT(remark ? remark : ""), "may be empty")                           \
  X("equilibria_left_out", "", COUNT(c->place ? all->count - c->card_count : 0), "for size")       \
  X("barriers", "", LIST_WHERE(all->barriers, c->place ? all->barrier_count : 0, has_barrier),     \
    "between those that are listed", .rows = &barrier_values)                                      \
  X("parameters", "", LIST(c->parameters.list, c->parameters.count), "", .rows = &shown_values)    \
  X("summary", "", LIST(c->summary.list, c->summary.count), "", .rows = &shown_values)             \
  X("yaml", "", TEXT(c->yaml), "text of the scene")                                                \
  X("study", "", TEXT(NULL), "null")
static const strut_equilibria no_equilibria;
STRUT_VALUES_HERE(page_values, PAGE, const content *c = of->at; const strut_page *page = c->page;
                  const strut_scene *s = of->scene; const strut_model *m = page->model;
                  size_t grounds = s->ground_count, contacts = s->contact_count;
                  const strut_equilibria *all = page->equilibria ? page->equilibria
                                                                 : &no_equilibria;
                  const char *remark = c->place || all->remark[0] ? all->remark : page->remark)

/* ---- the object put together, safe inside <script> ---- */

static const size_t MOST_BYTES = 4000000, MOST_YAML = 600000;

/* Parameters as they were used, with the method and step of a run. */
static void list_parameters(strut_shown *rows, const strut_scene *scene,
                            const strut_experiment *experiment, bool run) {
  char text[32];
  for (size_t i = 0; i < scene->parameter_count; i++)
    strut_show(rows, scene->parameters[i].name, scene->parameters[i].text);
  if (!run) return;
  if (experiment->accuracy > 0) { /* chooses both */
    snprintf(text, sizeof text, "%g %%", 100.0 * experiment->accuracy);
    strut_show(rows, "accuracy", text);
    return;
  }
  strut_show(rows, "integration method", experiment->integrator);
  if (experiment->step > 0)
    strut_show(rows, "integration step", strut_quantity_of(experiment->step, 4, "s").text);
}

/* The scene's text; of a very long one its beginning, up to the end of a line. */
static char *shown_yaml(const char *yaml) {
  size_t length = strlen(yaml), kept = length;
  if (length > MOST_YAML) {
    kept = MOST_YAML;
    while (kept > 0 && yaml[kept - 1] != '\n') kept--;
  }
  strut_buffer text = {0};
  strut_buffer_add(&text, "%.*s", (int)kept, yaml);
  if (kept < length)
    strut_buffer_add(&text, "# ... and %zu bytes more, which are left out here\n", length - kept);
  return strut_buffer_take(&text);
}

/* Around all nodes at the start. */
static void find_extent(content *self, const strut_scene *scene) {
  double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {-HUGE_VAL, -HUGE_VAL};
  for (size_t i = 0; i < 2 * scene->node_count; i++) {
    double x = scene->nodes[i / 2].start[i % 2];
    low[i % 2] = fmin(low[i % 2], x), high[i % 2] = fmax(high[i % 2], x);
  }
  for (int k = 0; k < 2; k++) self->middle[k] = 0.5 * (low[k] + high[k]);
  self->far = FAR * fmax(fmax(high[0] - low[0], high[1] - low[1]), LEAST_SIZE);
}

/* Everything but the motion. */
static char *still_data(const strut_page *page) {
  const strut_scene *scene = page->model->scene;
  strut_arena arena = {0};
  content c = {.page = page, .arena = &arena, .yaml = shown_yaml(page->yaml)};
  bool good = c.yaml;
  find_extent(&c, scene);
  list_parameters(&c.parameters, scene, page->experiment, page->motion != NULL);
  strut_summary_rows(&c.summary, page->summary, page->experiment, scene);
  if (page->equilibria && page->equilibria->count) {
    c.choices = strut_arena_allocate(&arena, page->equilibria->count, sizeof *c.choices);
    c.place = strut_arena_allocate(&arena, page->equilibria->count, sizeof *c.place);
    good = good && c.choices && c.place;
    if (good) c.card_count = choose_cards(page->equilibria, page->model, c.choices, c.place);
  }
  strut_json json = strut_json_begin();
  if (good)
    strut_json_values(&json, json.root, &page_values, &(strut_result_object){&c, NULL, scene, 0});
  json.failed = json.failed || !good || c.parameters.failed || c.summary.failed;
  strut_shown_free(&c.parameters);
  strut_shown_free(&c.summary);
  strut_release(c.yaml);
  strut_arena_free(&arena);
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
  char *still = still_data(page), *motion = NULL;
  strut_buffer buffer = {0};
  if (still) add_safe(&buffer, still);
  if (still && !buffer.failed) {
    size_t room = most > 2 * buffer.length ? most - buffer.length : most / 2;
    buffer.text[--buffer.length] = '\0'; /* its last brace; the motion comes before it */
    strut_buffer_add(&buffer, ",\"motion\":");
    motion = strut_page_motion(page, room, frames);
    if (motion) add_safe(&buffer, motion);
    strut_buffer_add(&buffer, "}\n");
  }
  buffer.failed = buffer.failed || !motion;
  strut_release(still);
  strut_release(motion);
  return strut_buffer_take(&buffer);
}

char *strut_page_data(const strut_page *page, strut_page_frames *frames, strut_error *error) {
  strut_page_frames taken = {0};
  char *data = write_data(page, &taken);
  if (!data) strut_no_memory(error, "for the page");
  if (frames) *frames = taken;
  return data;
}
