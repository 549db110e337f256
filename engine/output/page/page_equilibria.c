/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cards of the page: which equilibria are worth one, and what stands on it. */
#include <math.h>
#include <stdlib.h>

#include "engine/base/memory.h"
#include "engine/output/page/page_parts.h"
#include "engine/output/report/equilibria_report.h"

struct cJSON;

/* So many cards, saddles among them, and numbers on all of them together. */
enum { MOST_CARDS = 40, MOST_SADDLES = 12, MOST_NUMBERS = 60000 };

/* Digits of places and forces: more than a screen and its figures show. */
static const int DIGITS = 9;

/* What people want to see first. */
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

/* ENDS: it stands, or another comes to rest there. */
static int rank_of(const strut_equilibrium *e) {
  if (is_saddle(e)) return SADDLES;
  if (e->fate == STRUT_OUTCOME_BELOW_GROUND) return BELOW_GROUND;
  if (e->fate != STRUT_OUTCOME_STANDS) return ELSEWHERE;
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

/* Puts those that get a card in front and says how many there are; place[i] is the card of the i-th
   equilibrium, or -1. */
static size_t choose(const strut_equilibria *all, const strut_model *model, choice *choices,
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

/* What presses on the ground in the shape that is shown: on held contacts their reactions. */
static void add_contacts(strut_json *json, struct cJSON *to, const strut_model *model,
                         const strut_equilibrium *e) {
  const double *up = model->contacts.normal;
  struct cJSON *contacts = strut_json_array(json, to, "contacts");
  struct cJSON *normal = strut_json_array(json, to, "normal");
  bool rests = e->fate == STRUT_OUTCOME_STANDS || !e->supports;
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
  strut_json_text(json, to, "fate", strut_outcome_name(e->fate));
  strut_json_text(json, to, "verdict", e->verdict);
  strut_json_number(json, to, "energy", e->energy);
  strut_json_bool(json, to, "stands", e->fate == STRUT_OUTCOME_STANDS);
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

static void add_none(strut_json *json, const strut_page *page) {
  const strut_equilibria *all = page->equilibria;
  const char *remark = all && all->remark[0] ? all->remark : page->remark;
  strut_json_text(json, json->root, "equilibria", NULL);
  strut_json_text(json, json->root, "equilibria_remark", remark ? remark : "");
  strut_json_integer(json, json->root, "equilibria_left_out", 0);
  strut_json_array(json, json->root, "barriers");
}

bool strut_page_add_equilibria(strut_json *json, const strut_page *page) {
  const strut_equilibria *all = page->equilibria;
  if (!all || all->count == 0) {
    add_none(json, page);
    return true;
  }
  choice *choices = strut_allocate(all->count, sizeof *choices);
  int32_t *place = strut_allocate(all->count, sizeof *place);
  bool good = choices && place;
  if (good) {
    size_t count = choose(all, page->model, choices, place);
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
