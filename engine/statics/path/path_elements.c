/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/statics/path/path_elements.h"

#include <assert.h>
#include <math.h>

#include "engine/statics/path/system.h"

static const double APART =
    1e-5; /* relative: natural strains whose difference gives a derivative */

/* A kink that matters: it lies where the element can act. */
static bool is_kink_felt(const strut_element *e, double kink) {
  return !e->carries || e->carries * kink > 0.0;
}

static int32_t count_switches(const strut_element_table *t) {
  int32_t count = 0;
  for (int32_t i = 0; i < t->count; i++)
    count +=
        (t->element[i].carries != 0) + strut_law_kinks(t->element[i].law, &t->element[i].numbers);
  return count;
}

bool strut_path_elements_create(const strut_model *model, strut_arena *arena,
                                strut_path_elements *p) {
  const strut_element_table *t = &model->elements;
  *p = (strut_path_elements){0};
  if (t->count == 0) return true;
  p->element = strut_arena_allocate(arena, (size_t)t->count, sizeof *p->element);
  p->switches = strut_arena_allocate(arena, (size_t)count_switches(t) + 1, sizeof *p->switches);
  if (!p->element || !p->switches) return false;
  for (int32_t i = 0; i < t->count; i++) {
    const strut_element *e = &t->element[i];
    int kinks = strut_law_kinks(e->law, &e->numbers);
    p->element[i] = (strut_path_element){.turn = (double)NAN, .acts = true};
    if (e->carries) p->switches[p->switch_count++] = (strut_path_element_switch){i, -1};
    for (int k = 0; k < kinks; k++) {
      double kink = strut_law_kink(e->law, &e->numbers, k);
      p->switches[p->switch_count++] = (strut_path_element_switch){i, k};
      p->element[i].piece += !is_kink_felt(e, kink) && kink <= 0.0; /* above it wherever it acts */
    }
  }
  return true;
}

/* Natural strain where the parameter has its present value, or in other terms. */
static double natural_in(const strut_path_terms *terms, int32_t i) {
  const strut_element *e = &terms->laws->elements.element[i];
  return strut_element_natural(e, terms->rest);
}

/* Law, numbers and natural strain of some terms, at a strain. */
static strut_law_response respond(const strut_path_terms *terms, int32_t i, double strain,
                                  double natural, int piece) {
  const strut_element *e = &terms->laws->elements.element[i];
  return strut_law_respond(e->law, &e->numbers, strain, natural, piece);
}

/* How the force changes with the parameter where the strain does not. */
static double find_rate(const strut_path_system *s, int32_t i) {
  const strut_path_parameter *p = &s->parameter;
  const strut_path_element *own = &s->elements.element[i];
  const strut_element *e = &s->model->elements.element[i];
  double strain = own->pose.strain, natural = own->pose.natural;
  if (p->options->over == STRUT_PATH_OVER_SCENE) {
    double low = respond(&p->low, i, strain, natural_in(&p->low, i), own->piece).force;
    double high = respond(&p->high, i, strain, natural_in(&p->high, i), own->piece).force;
    return (high - low) / p->apart;
  }
  double rate = e->slot >= 0 ? s->rates.rest[e->slot] : 0.0;
  if (rate == 0.0) return 0.0;
  double h = APART * fmax(fabs(natural), fabs(strain));
  if (!(h > 0.0)) h = APART;
  double low = respond(&s->terms, i, strain, natural - h, own->piece).force;
  double high = respond(&s->terms, i, strain, natural + h, own->piece).force;
  return rate * (high - low) / (2.0 * h);
}

/* Strain and gradient at system->q, natural strain of its terms, force and slope of its piece. */
static void evaluate_element(strut_path_system *s, int32_t i) {
  strut_path_element *own = &s->elements.element[i];
  strut_element_evaluate(s->model, i, s->terms.rest, s->q, own->turn, &own->pose);
  own->pose.natural = natural_in(&s->terms, i);
  strut_law_response r = respond(&s->terms, i, own->pose.strain, own->pose.natural, own->piece);
  own->pose.force = own->acts ? r.force : 0.0;
  own->pose.slope = own->acts ? r.slope : 0.0;
  own->rate = own->acts ? find_rate(s, i) : 0.0;
}

static uint32_t place_of(const strut_path_system *s, const strut_element *e, int32_t k) {
  return s->model->elements.at[e->first + k / 2] + (uint32_t)(k % 2);
}

static void add_element(strut_path_system *s, int32_t i) {
  const strut_element *e = &s->model->elements.element[i];
  const strut_path_element *own = &s->elements.element[i];
  double k[STRUT_MOST_GRADIENT * STRUT_MOST_GRADIENT];
  int32_t n = 2 * e->nodes;
  strut_element_stiffness(s->model, i, &own->pose, s->q, k);
  for (int32_t a = 0; a < n; a++) {
    int32_t row = s->potential->row_of[place_of(s, e, a)];
    if (row < 0) continue;
    double pull = own->pose.force * own->pose.b[a], slope = own->rate * own->pose.b[a];
    s->forces = fmax(s->forces, fabs(pull));
    for (int32_t b = 0; b < n; b++) {
      uint32_t at = place_of(s, e, b);
      int32_t column = s->potential->row_of[at];
      if (column >= 0)
        *gsl_matrix_ptr(s->hessian, (size_t)row, (size_t)column) += k[a * n + b];
      else
        slope += k[a * n + b] * s->rates.position[at];
    }
    s->g[row] += pull;
    s->slope[row] += slope;
  }
}

void strut_path_add_elements(strut_path_system *s) {
  for (int32_t i = 0; i < s->model->elements.count; i++) {
    evaluate_element(s, i);
    if (s->elements.element[i].acts) add_element(s, i);
  }
}

void strut_path_element_reactions(const strut_path_system *s, double *reaction) {
  for (int32_t i = 0; i < s->model->elements.count; i++) {
    const strut_element *e = &s->model->elements.element[i];
    const strut_element_pose *pose = &s->elements.element[i].pose;
    for (int32_t k = 0; k < 2 * e->nodes; k++)
      reaction[place_of(s, e, k)] += pose->force * pose->b[k];
  }
}

void strut_path_keep_turns(strut_path_system *s) {
  for (int32_t i = 0; i < s->model->elements.count; i++)
    s->elements.element[i].turn = s->elements.element[i].pose.strain;
}

double strut_path_element_tension(const strut_path_system *s, int32_t member) {
  const strut_element_table *t = &s->model->elements;
  const strut_element *e = strut_element_of_member(t, member);
  double sum = 0.0;
  for (; e; e = e->sibling >= 0 ? &t->element[e->sibling] : NULL) {
    double force = s->elements.element[e - t->element].pose.force;
    if (e->carries) force = e->carries * fmax(e->carries * force, 0.0); /* at a kink, rounding */
    sum += force;
  }
  return sum;
}

void strut_path_moments(const strut_path_system *s, double *moment) {
  const strut_element_table *t = &s->model->elements;
  for (int32_t i = 0; i < t->count; i++)
    if (t->element[i].role == STRUT_ELEMENT_HINGE)
      moment[t->element[i].item] = s->elements.element[i].pose.force + 0.0; /* no -0 */
}

void strut_path_pressures(const strut_path_system *s, double *pressure) {
  const strut_element_table *t = &s->model->elements, *now = &s->terms.laws->elements;
  for (int32_t i = 0; i < t->count; i++)
    if (t->element[i].role == STRUT_ELEMENT_CELL)
      pressure[t->element[i].item] =
          now->element[i].numbers.outside - s->elements.element[i].pose.force;
}

/*
 * One that carries one sign acts where both its strain beyond the natural one and its force have
 * it: the nearer of the two to zero decides. Angles are turned into lengths by the size.
 */
double strut_path_element_switch_value(const strut_path_system *s, int32_t which) {
  const strut_path_element_switch *w = &s->elements.switches[which];
  const strut_element *e = &s->terms.laws->elements.element[w->element];
  const strut_path_element *own = &s->elements.element[w->element];
  strut_element_pose pose;
  strut_element_evaluate(s->model, w->element, s->terms.rest, s->q, own->turn, &pose);
  double natural = natural_in(&s->terms, w->element), x = pose.strain - natural;
  double unit = e->strain == STRUT_STRAIN_ANGLE ? s->size : 1.0;
  if (w->kink >= 0) {
    double kink = strut_law_kink(e->law, &e->numbers, w->kink);
    return is_kink_felt(e, kink) ? unit * (x - kink) : -HUGE_VAL;
  }
  double beyond = e->carries * x;
  strut_law_response r = respond(&s->terms, w->element, pose.strain, natural, -1);
  double slope = fmax(fabs(r.slope), e->numbers.stiffness);
  if (beyond > 0.0 && r.force != 0.0 && slope > 0.0)
    beyond = fmin(beyond, e->carries * r.force / slope);
  return unit * beyond;
}

bool strut_path_element_switch_is_on(const strut_path_system *s, int32_t which) {
  const strut_path_element_switch *w = &s->elements.switches[which];
  const strut_path_element *own = &s->elements.element[w->element];
  return w->kink < 0 ? own->acts : own->piece > w->kink;
}

void strut_path_element_switch_set(strut_path_system *s, int32_t which, bool on) {
  const strut_path_element_switch *w = &s->elements.switches[which];
  strut_path_element *own = &s->elements.element[w->element];
  if (w->kink < 0)
    own->acts = on;
  else if (on)
    own->piece = own->piece > w->kink ? own->piece : w->kink + 1;
  else
    own->piece = own->piece > w->kink ? w->kink : own->piece;
}
