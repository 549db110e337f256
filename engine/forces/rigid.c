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
static double rigid_along(const strut_rigid *rigid, int32_t r, const double *vector) {
  assert(r >= 0 && r < rigid->most);
  const strut_vec2 u = rigid->direction[r];
  const double *b = vector + rigid->at[rigid->row[r][1]];
  double sum = b[0] * u.x + b[1] * u.y;
  if (rigid->row[r][0] < 0) return sum;
  const double *a = vector + rigid->at[rigid->row[r][0]];
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
static void number_nodes(const strut_model *model, strut_rigid *rigid, int32_t *index) {
  const strut_member_table *members = &model->members;
  rigid->bars = rigid->nodes = 0;
  for (int32_t j = 0; j < members->count; j++) {
    if (!is_rigid(model, j)) continue;
    uint32_t at[2] = {members->from[j], members->to[j]};
    for (int e = 0; e < 2; e++) {
      if (!index[at[e] / 2]) rigid->at[rigid->nodes] = at[e], index[at[e] / 2] = ++rigid->nodes;
      rigid->end[rigid->bars][e] = index[at[e] / 2] - 1;
    }
    rigid->member[rigid->bars++] = j;
  }
  for (int32_t i = 0; i < model->contacts.count; i++) {
    uint32_t at = model->contacts.at[i];
    if (!index[at / 2]) rigid->at[rigid->nodes] = at, index[at / 2] = ++rigid->nodes;
    rigid->foot[i] = index[at / 2] - 1;
  }
}

/* M^-1 between the nodes, a column at a time. */
static void invert_mass(const strut_model *model, strut_rigid *rigid, double *scratch) {
  size_t bytes = (size_t)model->length * sizeof(double), n = (size_t)rigid->nodes;
  for (int c = 0; c < 2; c++)
    for (size_t j = 0; j < n; j++) {
      memset(rigid->free, 0, bytes);
      memset(rigid->push, 0, bytes);
      rigid->push[rigid->at[j] + (uint32_t)c] = 1.0;
      strut_mass_solve(model, rigid->push, rigid->free, scratch);
      for (size_t i = 0; i < n; i++)
        rigid->inverse[c][i * n + j] = rigid->free[rigid->at[i] + (uint32_t)c];
    }
  memset(rigid->free, 0, bytes);
}

static strut_rigid *create(const strut_model *model, strut_arena *arena, double *scratch) {
  size_t feet = (size_t)model->contacts.count, bars = 0;
  for (int32_t j = 0; j < model->members.count; j++) bars += is_rigid(model, j);
  size_t nodes = 2 * bars + feet, most = bars + feet;
  strut_rigid *rigid = strut_arena_allocate(arena, 1, sizeof *rigid);
  int32_t *index = strut_arena_allocate(arena, (size_t)model->node_count, sizeof *index);
  if (!rigid || !index) return NULL;
  rigid->most = (int32_t)most;
  if (!STRUT_ALLOCATE(arena, STRUT_NEW(rigid->member, bars), STRUT_NEW(rigid->length, bars),
                      STRUT_NEW(rigid->tension, bars), STRUT_NEW(rigid->at, nodes),
                      STRUT_NEW(rigid->end, bars), STRUT_NEW(rigid->foot, feet),
                      STRUT_NEW(rigid->row, most), STRUT_NEW(rigid->direction, most)) ||
      !STRUT_ALLOCATE(arena, STRUT_NEW(rigid->matrix, most * most), STRUT_NEW(rigid->right, most),
                      STRUT_NEW(rigid->stuck, feet), STRUT_NEW(rigid->free, model->length),
                      STRUT_NEW(rigid->push, model->length)))
    return NULL;
  number_nodes(model, rigid, index);
  for (int c = 0; c < 2; c++) {
    size_t n = (size_t)rigid->nodes;
    if (!STRUT_ALLOCATE(arena, STRUT_NEW(rigid->inverse[c], n * n))) return NULL;
  }
  invert_mass(model, rigid, scratch);
  return rigid;
}

bool strut_rigid_create(const strut_model *model, strut_state *state) {
  state->rigid = create(model, &state->arena, state->buffers->mass_solve);
  if (state->rigid) strut_rigid_begin(model, state);
  return state->rigid;
}

static double distance(const strut_rigid *rigid, int32_t r, const double *q) {
  assert(r >= 0 && r < rigid->most);
  const double *a = q + rigid->at[rigid->end[r][0]], *b = q + rigid->at[rigid->end[r][1]];
  return strut_distance(a, b);
}

/* x += M^-1 J' right. */
static void move(const strut_model *model, double *scratch, strut_rigid *rigid, double *vector) {
  size_t bytes = (size_t)model->length * sizeof(double);
  memset(rigid->push, 0, bytes);
  memset(rigid->free, 0, bytes);
  rigid_spread(rigid, rigid->push);
  strut_mass_solve(model, rigid->push, rigid->free, scratch);
  for (int32_t i = 0; i < 2 * model->node_count; i++) vector[i] += rigid->free[i];
}

void strut_rigid_filter(const strut_model *model, strut_rigid *rigid, double *velocity,
                        double *scratch) {
  for (int32_t r = 0; r < rigid->rows; r++) rigid->right[r] = -rigid_along(rigid, r, velocity);
  rigid_solve(rigid);
  move(model, scratch, rigid, velocity);
}

strut_rigid *strut_rigid_standing(const strut_model *model, const double *q, strut_arena *arena) {
  double *scratch = strut_arena_allocate(arena, (size_t)model->length, sizeof *scratch);
  strut_rigid *rigid = scratch ? create(model, arena, scratch) : NULL;
  if (!rigid) return NULL;
  rigid_rows(rigid, q);
  rigid_factorise(rigid);
  return rigid;
}

void strut_rigid_begin(const strut_model *model, strut_state *state) {
  strut_rigid *rigid = state->rigid;
  for (int32_t r = 0; r < rigid->bars; r++) rigid->length[r] = distance(rigid, r, state->q);
  memset(rigid->tension, 0, (size_t)rigid->bars * sizeof(double));
  rigid->failed = false;
  rigid_rows(rigid, state->q);
  if (rigid_factorise(rigid) >= 0)
    state->trouble = STRUT_FAILURE_RIGID;
  else
    strut_rigid_filter(model, rigid, state->v, state->buffers->mass_solve);
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
  strut_rigid *rigid = scratch ? create(model, &arena, scratch) : NULL;
  strut_status status = rigid ? STRUT_OK : strut_fail(error, STRUT_NO_MEMORY, "out of memory");
  if (rigid) {
    rigid_rows(rigid, model->start);
    bad = rigid_factorise(rigid);
  }
  if (bad >= 0)
    status = strut_fail(error, STRUT_SINGULAR,
                        "bar '%s' cannot be rigid: supports or other rigid bars hold its ends "
                        "already, always or where they start, as bars in one line do; start "
                        "elsewhere, make it a spring, or use bars: elastic",
                        model->scene->members[rigid->member[bad]].name);
  strut_arena_free(&arena);
  return status;
}

/* Contacts within Karnopp's band. Returns how many. */
static int32_t find_stuck(const strut_model *model, strut_rigid *rigid, const double *q,
                          const double *velocity) {
  const strut_contact_table *contacts = &model->contacts;
  int32_t count = 0;
  for (int32_t i = 0; i < contacts->count; i++) {
    if (strut_contact_gap(contacts, i, q) < 0.0 &&
        strut_friction_has_band(contacts->entry[i].friction.law) &&
        fabs(strut_contact_slip(contacts, i, velocity)) <
            contacts->entry[i].friction.stick_velocity)
      rigid->stuck[count++] = i;
  }
  return count;
}

/* Multipliers of bars and of `stuck` for the acceleration a; false: bars depend on each other. */
static bool hold(const strut_model *model, strut_rigid *rigid, const double *q,
                 const double *velocity, const double *acceleration, int32_t stuck) {
  rigid_rows(rigid, q);
  for (int32_t r = 0; r < rigid->bars; r++) {
    const double *va = velocity + rigid->at[rigid->end[r][0]],
                 *vb = velocity + rigid->at[rigid->end[r][1]];
    double wx = vb[0] - va[0], wy = vb[1] - va[1];
    double turn = rigid->direction[r].x * wy - rigid->direction[r].y * wx,
           length = distance(rigid, r, q);
    rigid->right[r] =
        -rigid_along(rigid, r, acceleration) - (length > 0.0 ? turn * turn / length : 0.0);
  }
  for (int32_t k = 0; k < stuck; k++) {
    rigid_add_foot(model, rigid, rigid->stuck[k]);
    rigid->right[rigid->bars + k] = -rigid_along(rigid, rigid->bars + k, acceleration);
  }
  if (rigid_factorise(rigid) >= 0) return false;
  rigid_solve(rigid);
  return true;
}

/* The contact whose stick is overtaxed most slides instead, pushed by what held it. */
static bool release(const strut_model *model, const strut_state *state, strut_rigid *rigid,
                    int32_t *stuck) {
  const strut_contact_table *contacts = &model->contacts;
  int32_t worst = -1;
  double most = 0.0;
  for (int32_t k = 0; k < *stuck; k++) {
    int32_t i = rigid->stuck[k];
    double held = rigid->right[rigid->bars + k];
    double limit =
        strut_friction_static(&contacts->entry[i].friction, -held) * state->latest->normal[i];
    double excess = fabs(held) - limit;
    if (excess >= 0.0 && (worst < 0 || excess > most)) worst = k, most = excess;
  }
  if (worst < 0) return false;
  int32_t i = rigid->stuck[worst];
  double hold = rigid->right[rigid->bars + worst],
         slide =
             strut_friction_kinetic(&contacts->entry[i].friction, -hold) * state->latest->normal[i];
  double friction = hold > 0.0 ? slide : hold < 0.0 ? -slide : 0.0;
  state->latest->friction[i] = friction;
  for (int k = 0; k < 2; k++)
    state->latest->force[contacts->at[i] + (uint32_t)k] += friction * contacts->tangent[k];
  rigid->stuck[worst] = rigid->stuck[--*stuck];
  return true;
}

/* Friction's powers of the contacts within the band, which the kernel has left out. */
static void accumulate(const strut_model *model, const strut_state *state, const double *q,
                       const double *velocity) {
  const strut_contact_table *contacts = &model->contacts;
  strut_rigid *rigid = state->rigid;
  int32_t count = find_stuck(model, rigid, q, velocity);
  for (int32_t k = 0; k < count; k++) {
    int32_t i = rigid->stuck[k];
    double slip = strut_contact_slip(contacts, i, velocity),
           rubbed = -state->latest->friction[i] * slip;
    double belt = state->latest->friction[i] * contacts->belt_speed;
    strut_power_add_two(state->latest->power, STRUT_POWER_FRICTION, rubbed, STRUT_POWER_BELT, belt);
  }
}

void strut_rigid_accelerate(const strut_model *model, const strut_state *state, const double *q,
                            const double *velocity, double *acceleration) {
  strut_rigid *rigid = state->rigid;
  int32_t stuck = find_stuck(model, rigid, q, velocity), before = stuck;
  for (;;) {
    rigid->failed = !hold(model, rigid, q, velocity, acceleration, stuck) || rigid->failed;
    if (rigid->failed) return;
    if (!release(model, state, rigid, &stuck)) break;
    strut_mass_solve(model, state->latest->force, acceleration, state->buffers->mass_solve);
  }
  for (int32_t r = 0; r < rigid->bars; r++) rigid->tension[r] = -rigid->right[r];
  for (int32_t k = 0; k < stuck; k++)
    state->latest->friction[rigid->stuck[k]] = rigid->right[rigid->bars + k];
  rigid_spread(rigid, state->latest->force);
  strut_mass_solve(model, state->latest->force, acceleration, state->buffers->mass_solve);
  if (state->balance && before) accumulate(model, state, q, velocity);
}

void strut_rigid_constrain(const strut_model *model, const strut_state *state, const double *q,
                           const double *velocity) {
  memset(state->rigid->free, 0, (size_t)model->length * sizeof(double));
  strut_mass_solve(model, state->latest->force, state->rigid->free, state->buffers->mass_solve);
  strut_rigid_accelerate(model, state, q, velocity, state->rigid->free);
}

/* The largest departure of a length, relative, beyond rounding of the coordinates; fills right. */
static double departure(strut_rigid *rigid, const double *q) {
  double most = 0.0;
  for (int32_t r = 0; r < rigid->bars; r++) {
    const double *a = q + rigid->at[rigid->end[r][0]], *b = q + rigid->at[rigid->end[r][1]];
    double noise = ROUNDING * (fabs(a[0]) + fabs(a[1]) + fabs(b[0]) + fabs(b[1]));
    rigid->right[r] = rigid->length[r] - distance(rigid, r, q);
    double left = fabs(rigid->right[r]) - noise;
    if (!(left <= most * rigid->length[r])) most = left / rigid->length[r];
  }
  return most;
}

bool strut_rigid_project(const strut_model *model, strut_state *state, double *q,
                         double *velocity) {
  enum { MOST_ROUNDS = 8 };
  strut_rigid *rigid = state->rigid;
  double left = departure(rigid, q);
  for (int round = 0; left > NEAR && round < MOST_ROUNDS; round++) {
    rigid_rows(rigid, q);
    if (rigid_factorise(rigid) >= 0) break;
    departure(rigid, q);
    rigid_solve(rigid);
    move(model, state->buffers->mass_solve, rigid, q);
    left = departure(rigid, q);
  }
  rigid_rows(rigid, q);
  if (rigid->failed || !(left <= FAR) || rigid_factorise(rigid) >= 0) {
    state->trouble = STRUT_FAILURE_RIGID;
    return false;
  }
  strut_rigid_filter(model, rigid, velocity, state->buffers->mass_solve);
  return true;
}

double strut_rigid_tension(const strut_rigid *rigid, int32_t member) {
  for (int32_t r = 0; r < rigid->bars; r++)
    if (rigid->member[r] == member) return rigid->tension[r];
  return 0.0;
}
