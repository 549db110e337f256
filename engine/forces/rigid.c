/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/forces/rigid.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "engine/model/mass.h"
#include "engine/model/pose.h"

/* Lengths are put right until they are so near, relative to themselves and to the coordinates. */
static const double NEAR = 1e-13, ROUNDING = 4.5e-16;
/* What a step may leave at worst. */
static const double FAR = 1e-9;

/* Rows of constraints, the matrix J M^-1 J' between them and its Cholesky factor. See rigid.h. */

/* A pivot this small against its diagonal is what rounding leaves of a dependent row. */
static const double DEPENDENT = 1e-11;
/* Contacts give way by so much, so that friction is shared where rigid bars join stuck nodes. */
static const double SHARING = 1e-9;

/* Rows of all bars at q. */
static void rigid_rows(strut_rigid *rigid, const double *q) {
  rigid->rows = rigid->bars;
  for (int32_t r = 0; r < rigid->bars; r++) {
    const double *a = q + rigid->at[rigid->end[r][0]], *b = q + rigid->at[rigid->end[r][1]];
    strut_vec2 span = strut_vec2_between(a, b);
    rigid->row[r][0] = rigid->end[r][0], rigid->row[r][1] = rigid->end[r][1];
    rigid->direction[r] = strut_vec2_unit(span, strut_vec2_length(span));
  }
}

/* Appends the tangent of a contact. */
static void rigid_add_foot(const strut_model *model, strut_rigid *rigid, int32_t contact) {
  assert(contact >= 0 && contact < model->contacts.count);
  int32_t r = rigid->rows++;
  rigid->row[r][0] = -1, rigid->row[r][1] = rigid->foot[contact];
  rigid->direction[r] = (strut_vec2){model->contacts.tangent[0], model->contacts.tangent[1]};
}

/* J x of row r. */
static double rigid_along(const strut_rigid *rigid, int32_t r, const double *x) {
  assert(r >= 0 && r < rigid->most);
  const strut_vec2 u = rigid->direction[r];
  const double *b = x + rigid->at[rigid->row[r][1]];
  double sum = b[0] * u.x + b[1] * u.y;
  if (rigid->row[r][0] < 0) return sum;
  const double *a = x + rigid->at[rigid->row[r][0]];
  return sum - (a[0] * u.x + a[1] * u.y);
}

/* The entry of J M^-1 J' between two rows. */
static double between(const strut_rigid *rigid, int32_t r, int32_t s) {
  assert(r >= 0 && r < rigid->most && s >= 0 && s < rigid->most);
  const strut_vec2 u = rigid->direction[r], w = rigid->direction[s];
  double sum = 0.0;
  for (int e = 0; e < 2; e++)
    for (int f = 0; f < 2; f++) {
      int32_t i = rigid->row[r][e], j = rigid->row[s][f];
      if (i < 0 || j < 0) continue;
      size_t place = (size_t)i * (size_t)rigid->nodes + (size_t)j;
      double part = u.x * w.x * rigid->inverse[0][place] + u.y * w.y * rigid->inverse[1][place];
      sum += e == f ? part : -part;
    }
  return sum;
}

/* Builds and factorises J M^-1 J'. -1, or the bar whose row depends on the ones before it. */
static int32_t rigid_factorise(strut_rigid *rigid) {
  size_t n = (size_t)rigid->most;
  double *m = rigid->matrix;
  for (int32_t r = 0; r < rigid->rows; r++) {
    double *row = m + (size_t)r * n;
    double whole = between(rigid, r, r), pivot = r < rigid->bars ? whole : whole * (1.0 + SHARING);
    for (int32_t s = 0; s < r; s++) {
      const double *other = m + (size_t)s * n;
      double sum = between(rigid, r, s);
      for (int32_t k = 0; k < s; k++) sum -= row[k] * other[k];
      row[s] = other[s] > 0.0 ? sum / other[s] : 0.0;
      pivot -= row[s] * row[s];
    }
    bool fine = pivot > DEPENDENT * whole;
    row[r] = fine ? sqrt(pivot) : 0.0; /* of a contact: it gets no friction */
    if (!fine && r < rigid->bars) return r;
  }
  return -1;
}

/* right becomes (J M^-1 J')^-1 right. */
static void rigid_solve(strut_rigid *rigid) {
  size_t n = (size_t)rigid->most;
  double *x = rigid->right;
  for (int32_t r = 0; r < rigid->rows; r++) {
    const double *row = rigid->matrix + (size_t)r * n;
    double sum = x[r];
    for (int32_t k = 0; k < r; k++) sum -= row[k] * x[k];
    x[r] = row[r] > 0.0 ? sum / row[r] : 0.0;
  }
  for (int32_t r = rigid->rows - 1; r >= 0; r--) {
    double sum = x[r];
    for (int32_t k = r + 1; k < rigid->rows; k++)
      sum -= rigid->matrix[(size_t)k * n + (size_t)r] * x[k];
    double pivot = rigid->matrix[(size_t)r * n + (size_t)r];
    x[r] = pivot > 0.0 ? sum / pivot : 0.0;
  }
}

/* force += J' right. */
static void rigid_spread(const strut_rigid *rigid, double *force) {
  for (int32_t r = 0; r < rigid->rows; r++)
    for (int e = 0; e < 2; e++) {
      if (rigid->row[r][e] < 0) continue;
      double *f = force + rigid->at[rigid->row[r][e]],
             push = e ? rigid->right[r] : -rigid->right[r];
      f[0] += push * rigid->direction[r].x;
      f[1] += push * rigid->direction[r].y;
    }
}

static bool is_rigid(const strut_model *model, int32_t j) {
  assert(j >= 0 && j < model->members.count);
  return model->scene->members[j].kind == STRUT_BAR;
}

/* Numbers the nodes of bars and contacts; index: (node_count) scratch of zeros. */
static void number_nodes(const strut_model *model, strut_rigid *g, int32_t *index) {
  const strut_member_table *t = &model->members;
  g->bars = g->nodes = 0;
  for (int32_t j = 0; j < t->count; j++) {
    if (!is_rigid(model, j)) continue;
    uint32_t at[2] = {t->from[j], t->to[j]};
    for (int e = 0; e < 2; e++) {
      if (!index[at[e] / 2]) g->at[g->nodes] = at[e], index[at[e] / 2] = ++g->nodes;
      g->end[g->bars][e] = index[at[e] / 2] - 1;
    }
    g->member[g->bars++] = j;
  }
  for (int32_t i = 0; i < model->contacts.count; i++) {
    uint32_t at = model->contacts.at[i];
    if (!index[at / 2]) g->at[g->nodes] = at, index[at / 2] = ++g->nodes;
    g->foot[i] = index[at / 2] - 1;
  }
}

/* M^-1 between the nodes, a column at a time. */
static void invert_mass(const strut_model *model, strut_rigid *g, double *scratch) {
  size_t bytes = (size_t)model->length * sizeof(double), n = (size_t)g->nodes;
  for (int c = 0; c < 2; c++)
    for (size_t j = 0; j < n; j++) {
      memset(g->free, 0, bytes);
      memset(g->push, 0, bytes);
      g->push[g->at[j] + (uint32_t)c] = 1.0;
      strut_mass_solve(model, g->push, g->free, scratch);
      for (size_t i = 0; i < n; i++) g->inverse[c][i * n + j] = g->free[g->at[i] + (uint32_t)c];
    }
  memset(g->free, 0, bytes);
}

static strut_rigid *create(const strut_model *model, strut_arena *arena, double *scratch) {
  size_t feet = (size_t)model->contacts.count, bars = 0;
  for (int32_t j = 0; j < model->members.count; j++) bars += is_rigid(model, j);
  size_t nodes = 2 * bars + feet, most = bars + feet;
  strut_rigid *g = strut_arena_allocate(arena, 1, sizeof *g);
  int32_t *index = strut_arena_allocate(arena, (size_t)model->node_count, sizeof *index);
  if (!g || !index) return NULL;
  g->most = (int32_t)most;
  g->member = strut_arena_allocate(arena, bars, sizeof *g->member);
  g->length = strut_arena_allocate(arena, bars, sizeof(double));
  g->tension = strut_arena_allocate(arena, bars, sizeof(double));
  g->at = strut_arena_allocate(arena, nodes, sizeof *g->at);
  g->end = strut_arena_allocate(arena, bars, sizeof *g->end);
  g->foot = strut_arena_allocate(arena, feet, sizeof *g->foot);
  g->row = strut_arena_allocate(arena, most, sizeof *g->row);
  g->direction = strut_arena_allocate(arena, most, sizeof *g->direction);
  g->matrix = strut_arena_allocate(arena, most * most, sizeof(double));
  g->right = strut_arena_allocate(arena, most, sizeof(double));
  g->stuck = strut_arena_allocate(arena, feet, sizeof *g->stuck);
  g->free = strut_arena_allocate(arena, (size_t)model->length, sizeof(double));
  g->push = strut_arena_allocate(arena, (size_t)model->length, sizeof(double));
  if (!g->member || !g->length || !g->tension || !g->at || !g->end || !g->foot || !g->row ||
      !g->direction || !g->matrix || !g->right || !g->stuck || !g->free || !g->push)
    return NULL;
  number_nodes(model, g, index);
  for (int c = 0; c < 2; c++) {
    size_t n = (size_t)g->nodes;
    g->inverse[c] = strut_arena_allocate(arena, n * n, sizeof(double));
    if (!g->inverse[c]) return NULL;
  }
  invert_mass(model, g, scratch);
  return g;
}

bool strut_rigid_create(const strut_model *model, strut_state *state) {
  state->rigid = create(model, &state->arena, state->buffers->mass_solve);
  if (state->rigid) strut_rigid_begin(model, state);
  return state->rigid;
}

static double distance(const strut_rigid *g, int32_t r, const double *q) {
  assert(r >= 0 && r < g->most);
  const double *a = q + g->at[g->end[r][0]], *b = q + g->at[g->end[r][1]];
  return strut_distance(a, b);
}

/* x += M^-1 J' right. */
static void move(const strut_model *model, double *scratch, strut_rigid *g, double *x) {
  size_t bytes = (size_t)model->length * sizeof(double);
  memset(g->push, 0, bytes);
  memset(g->free, 0, bytes);
  rigid_spread(g, g->push);
  strut_mass_solve(model, g->push, g->free, scratch);
  for (int32_t i = 0; i < 2 * model->node_count; i++) x[i] += g->free[i];
}

void strut_rigid_filter(const strut_model *model, strut_rigid *g, double *v, double *scratch) {
  for (int32_t r = 0; r < g->rows; r++) g->right[r] = -rigid_along(g, r, v);
  rigid_solve(g);
  move(model, scratch, g, v);
}

strut_rigid *strut_rigid_standing(const strut_model *model, const double *q, strut_arena *arena) {
  double *scratch = strut_arena_allocate(arena, (size_t)model->length, sizeof *scratch);
  strut_rigid *g = scratch ? create(model, arena, scratch) : NULL;
  if (!g) return NULL;
  rigid_rows(g, q);
  rigid_factorise(g);
  return g;
}

void strut_rigid_begin(const strut_model *model, strut_state *state) {
  strut_rigid *g = state->rigid;
  for (int32_t r = 0; r < g->bars; r++) g->length[r] = distance(g, r, state->q);
  memset(g->tension, 0, (size_t)g->bars * sizeof(double));
  g->failed = false;
  rigid_rows(g, state->q);
  if (rigid_factorise(g) >= 0)
    state->trouble = STRUT_FAILURE_RIGID;
  else
    strut_rigid_filter(model, g, state->v, state->buffers->mass_solve);
}

strut_status strut_rigid_check(const strut_model *model, strut_error *error) {
  strut_arena arena = {0};
  int32_t bars = 0, bad = -1;
  for (int32_t j = 0; j < model->members.count; j++) bars += is_rigid(model, j);
  if (bars > STRUT_MOST_RIGID)
    return strut_fail(error, STRUT_USAGE,
                      "%d rigid bars are more than the %d that their dense matrix is made for; use "
                      "bars: elastic",
                      (int)bars, (int)STRUT_MOST_RIGID);
  double *scratch = strut_arena_allocate(&arena, (size_t)model->length, sizeof *scratch);
  strut_rigid *g = scratch ? create(model, &arena, scratch) : NULL;
  strut_status status = g ? STRUT_OK : strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  if (g) {
    rigid_rows(g, model->start);
    bad = rigid_factorise(g);
  }
  if (bad >= 0)
    status = strut_fail(error, STRUT_SINGULAR,
                        "bar '%s' cannot be rigid: supports or other rigid bars hold its ends "
                        "already, always or where they start, as bars in one line do; start "
                        "elsewhere, make it a spring, or use bars: elastic",
                        model->scene->members[g->member[bad]].name);
  strut_arena_free(&arena);
  return status;
}

/* Contacts within Karnopp's band. Returns how many. */
static int32_t find_stuck(const strut_model *model, strut_rigid *g, const double *q,
                          const double *v) {
  const strut_contact_table *c = &model->contacts;
  int32_t count = 0;
  for (int32_t i = 0; i < c->count; i++) {
    if (strut_contact_gap(c, i, q) < 0.0 && strut_friction_has_band(c->entry[i].friction.law) &&
        fabs(strut_contact_slip(c, i, v)) < c->entry[i].friction.stick_velocity)
      g->stuck[count++] = i;
  }
  return count;
}

/* Multipliers of bars and of `stuck` for the acceleration a; false: bars depend on each other. */
static bool hold(const strut_model *model, strut_rigid *g, const double *q, const double *v,
                 const double *a, int32_t stuck) {
  rigid_rows(g, q);
  for (int32_t r = 0; r < g->bars; r++) {
    const double *va = v + g->at[g->end[r][0]], *vb = v + g->at[g->end[r][1]];
    double wx = vb[0] - va[0], wy = vb[1] - va[1];
    double turn = g->direction[r].x * wy - g->direction[r].y * wx, length = distance(g, r, q);
    g->right[r] = -rigid_along(g, r, a) - (length > 0.0 ? turn * turn / length : 0.0);
  }
  for (int32_t k = 0; k < stuck; k++) {
    rigid_add_foot(model, g, g->stuck[k]);
    g->right[g->bars + k] = -rigid_along(g, g->bars + k, a);
  }
  if (rigid_factorise(g) >= 0) return false;
  rigid_solve(g);
  return true;
}

/* The contact whose stick is overtaxed most slides instead, pushed by what held it. */
static bool release(const strut_model *model, const strut_state *state, strut_rigid *g,
                    int32_t *stuck) {
  const strut_contact_table *c = &model->contacts;
  int32_t worst = -1;
  double most = 0.0;
  for (int32_t k = 0; k < *stuck; k++) {
    int32_t i = g->stuck[k];
    double held = g->right[g->bars + k];
    double limit = strut_friction_static(&c->entry[i].friction, -held) * state->latest->normal[i];
    double excess = fabs(held) - limit;
    if (excess >= 0.0 && (worst < 0 || excess > most)) worst = k, most = excess;
  }
  if (worst < 0) return false;
  int32_t i = g->stuck[worst];
  double hold = g->right[g->bars + worst],
         slide = strut_friction_kinetic(&c->entry[i].friction, -hold) * state->latest->normal[i];
  double friction = hold > 0.0 ? slide : hold < 0.0 ? -slide : 0.0;
  state->latest->friction[i] = friction;
  for (int k = 0; k < 2; k++)
    state->latest->force[c->at[i] + (uint32_t)k] += friction * c->tangent[k];
  g->stuck[worst] = g->stuck[--*stuck];
  return true;
}

/* Friction's powers of the contacts within the band, which the kernel has left out. */
static void accumulate(const strut_model *model, const strut_state *state, const double *q,
                       const double *v) {
  const strut_contact_table *c = &model->contacts;
  strut_rigid *g = state->rigid;
  int32_t count = find_stuck(model, g, q, v);
  for (int32_t k = 0; k < count; k++) {
    int32_t i = g->stuck[k];
    double slip = strut_contact_slip(c, i, v), rubbed = -state->latest->friction[i] * slip;
    double belt = state->latest->friction[i] * c->belt_speed;
    state->latest->power[STRUT_POWER_FRICTION] += rubbed;
    state->latest->power[STRUT_POWER_BELT] += belt;
    state->latest->power[STRUT_POWER_EXCHANGED] += fabs(rubbed) + fabs(belt);
  }
}

void strut_rigid_accelerate(const strut_model *model, const strut_state *state, const double *q,
                            const double *v, double *a) {
  strut_rigid *g = state->rigid;
  int32_t stuck = find_stuck(model, g, q, v), before = stuck;
  for (;;) {
    g->failed = !hold(model, g, q, v, a, stuck) || g->failed;
    if (g->failed) return;
    if (!release(model, state, g, &stuck)) break;
    strut_mass_solve(model, state->latest->force, a, state->buffers->mass_solve);
  }
  for (int32_t r = 0; r < g->bars; r++) g->tension[r] = -g->right[r];
  for (int32_t k = 0; k < stuck; k++) state->latest->friction[g->stuck[k]] = g->right[g->bars + k];
  rigid_spread(g, state->latest->force);
  strut_mass_solve(model, state->latest->force, a, state->buffers->mass_solve);
  if (state->balance && before) accumulate(model, state, q, v);
}

void strut_rigid_constrain(const strut_model *model, const strut_state *state, const double *q,
                           const double *v) {
  memset(state->rigid->free, 0, (size_t)model->length * sizeof(double));
  strut_mass_solve(model, state->latest->force, state->rigid->free, state->buffers->mass_solve);
  strut_rigid_accelerate(model, state, q, v, state->rigid->free);
}

/* The largest departure of a length, relative, beyond rounding of the coordinates; fills right. */
static double departure(strut_rigid *g, const double *q) {
  double most = 0.0;
  for (int32_t r = 0; r < g->bars; r++) {
    const double *a = q + g->at[g->end[r][0]], *b = q + g->at[g->end[r][1]];
    double noise = ROUNDING * (fabs(a[0]) + fabs(a[1]) + fabs(b[0]) + fabs(b[1]));
    g->right[r] = g->length[r] - distance(g, r, q);
    double left = fabs(g->right[r]) - noise;
    if (!(left <= most * g->length[r])) most = left / g->length[r];
  }
  return most;
}

bool strut_rigid_project(const strut_model *model, strut_state *state, double *q, double *v) {
  enum { MOST_ROUNDS = 8 };
  strut_rigid *g = state->rigid;
  double left = departure(g, q);
  for (int round = 0; left > NEAR && round < MOST_ROUNDS; round++) {
    rigid_rows(g, q);
    if (rigid_factorise(g) >= 0) break;
    departure(g, q);
    rigid_solve(g);
    move(model, state->buffers->mass_solve, g, q);
    left = departure(g, q);
  }
  rigid_rows(g, q);
  if (g->failed || !(left <= FAR) || rigid_factorise(g) >= 0) {
    state->trouble = STRUT_FAILURE_RIGID;
    return false;
  }
  strut_rigid_filter(model, g, v, state->buffers->mass_solve);
  return true;
}

double strut_rigid_tension(const strut_rigid *rigid, int32_t member) {
  for (int32_t r = 0; r < rigid->bars; r++)
    if (rigid->member[r] == member) return rigid->tension[r];
  return 0.0;
}

void strut_rigid_add_tensions(const strut_rigid *rigid, double *force) {
  for (int32_t r = 0; r < rigid->bars; r++) force[rigid->member[r]] += rigid->tension[r];
}
