/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/physics/slow_world.h"

#include "tests/physics/slow_expression.h"
#include "tests/support/check.h"

enum { NONE = SLOW_STATES };
static const strut_law LINEAR = {.kind = STRUT_LAW_LINEAR};

/* ---- signals, sensors, states ---- */

typedef struct where {
  const slow_world *w;
  const slow_instant *at;
} where;

static long double number_of(void *context, const char *name, int rate);
static long double sensor_value(const slow_world *w, const slow_instant *at, const strut_sensor *s);

static long double expression_of(const slow_world *w, const slow_instant *at, const char *name) {
  where here = {w, at};
  for (size_t i = 0; i < w->text_count; i++)
    if (name && !strcmp(w->texts[i].name, name))
      return slow_expression(w->texts[i].text, number_of, &here);
  fail_msg("no expression of '%s' is known", name ? name : "?");
  return 0;
}

/* Before its lag. */
static long double direct_value(const slow_world *w, const slow_instant *at, int32_t i) {
  const strut_signal *s = &w->scene->signals[i];
  long double value = 0, rate;
  if (s->kind == STRUT_EXPRESSION) return expression_of(w, at, s->name);
  if (s->kind != STRUT_SUM) {
    slow_signal(s, at->t, &value, &rate);
    return value;
  }
  if (at->t < s->start || at->t >= s->stop) return 0;
  for (size_t k = 0; k < s->term_count; k++) value += slow_world_signal(w, at, s->terms[k]);
  return value;
}

static long double lagged_value(const slow_world *w, const slow_instant *at, int32_t i) {
  return w->lag_of[i] != NONE ? at->z[w->lag_of[i]] : direct_value(w, at, i);
}

long double slow_world_signal(const slow_world *w, const slow_instant *at, int32_t i) {
  return w->scene->signals[i].every > 0 ? w->held[i] : lagged_value(w, at, i);
}

/* Rates of the states that the scene names and of lags. */
static void rate_states(const slow_world *w, const slow_instant *at, long double *z) {
  for (size_t k = 0; k < w->scene->state_count; k++)
    z[k] = expression_of(w, at, w->scene->states[k].name);
  for (size_t i = 0; i < w->scene->signal_count; i++)
    if (w->lag_of[i] != NONE)
      z[w->lag_of[i]] =
          (direct_value(w, at, (int32_t)i) - at->z[w->lag_of[i]]) / w->scene->signals[i].lag;
}

/* A little later, with the velocities as they are. */
static slow_instant later(const slow_world *w, const slow_instant *at, long double h) {
  long double z[SLOW_STATES] = {0};
  slow_instant next = *at;
  rate_states(w, at, z);
  next.t += h;
  for (size_t i = 0; i < w->n; i++) next.q[i] += h * at->v[i];
  for (size_t k = 0; k < SLOW_STATES; k++) next.z[k] += h * z[k];
  return next;
}

/* Slope at the first of five points one apart, of fourth order: signals begin with a corner. */
static long double from_the_right(const long double *f) {
  return (-25 * f[0] + 48 * f[1] - 36 * f[2] + 16 * f[3] - 3 * f[4]) / 12;
}

typedef long double function_of_time(const slow_world *w, const slow_instant *at, const void *what);

static long double rate_along(const slow_world *w, const slow_instant *at, function_of_time *f,
                              const void *what) {
  const long double h = 1e-6L; /* beyond it there may be a kink */
  long double value[5];
  for (int k = 0; k < 5; k++) {
    slow_instant near = later(w, at, h * k);
    value[k] = f(w, &near, what);
  }
  return from_the_right(value) / h;
}

static long double signal_at(const slow_world *w, const slow_instant *at, const void *signal) {
  return slow_world_signal(w, at, *(const int32_t *)signal);
}

static long double sensor_at(const slow_world *w, const slow_instant *at, const void *sensor) {
  return sensor_value(w, at, sensor);
}

long double slow_world_signal_rate(const slow_world *w, const slow_instant *at, int32_t i) {
  const strut_signal *s = &w->scene->signals[i];
  long double value = 0, rate;
  if (s->every > 0) return 0;
  if (w->lag_of[i] != NONE || s->kind == STRUT_EXPRESSION) return rate_along(w, at, signal_at, &i);
  if (s->kind == STRUT_SUM) {
    if (at->t < s->start || at->t >= s->stop) return 0;
    for (size_t k = 0; k < s->term_count; k++) value += slow_world_signal_rate(w, at, s->terms[k]);
    return value;
  }
  slow_signal(s, at->t, &value, &rate);
  return rate;
}

static long double number_of(void *context, const char *name, int rate) {
  const where *here = context;
  const strut_scene *scene = here->w->scene;
  if (!strcmp(name, "t")) return here->at->t;
  for (size_t i = 0; i < scene->sensor_count; i++)
    if (!strcmp(name, scene->sensors[i].name))
      return rate ? rate_along(here->w, here->at, sensor_at, &scene->sensors[i])
                  : sensor_value(here->w, here->at, &scene->sensors[i]);
  for (size_t i = 0; i < scene->state_count; i++)
    if (!strcmp(name, scene->states[i].name)) return here->at->z[i];
  for (size_t i = 0; i < scene->signal_count; i++)
    if (scene->signals[i].name && !strcmp(name, scene->signals[i].name))
      return slow_world_signal(here->w, here->at, (int32_t)i);
  fail_msg("nothing is called '%s'", name);
  return 0;
}

/* ---- mass ---- */

/* Lumped masses of nodes, which weigh. */
static void weigh(const strut_scene *scene, bool members, long double *mass) {
  for (size_t i = 0; i < scene->node_count; i++) mass[i] = scene->nodes[i].mass;
  for (size_t i = 0; i < scene->unbalance_count; i++)
    mass[scene->unbalances[i].node] += scene->unbalances[i].mass;
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *m = &scene->members[j];
    slow_strain path = slow_path_of(m);
    long double length[SLOW_MOST], whole = 0;
    if (!members && path.count == 2) continue;
    for (size_t k = 0; k + 1 < path.count; k++) {
      const double *a = scene->nodes[path.node[k]].position;
      const double *b = scene->nodes[path.node[k + 1]].position;
      whole += length[k] = hypotl((long double)b[0] - a[0], (long double)b[1] - a[1]);
    }
    for (size_t k = 0; k + 1 < path.count; k++)
      for (size_t end = 0; end < 2; end++)
        mass[path.node[k + end]] += m->mass * length[k] / whole / 2;
  }
}

void slow_world_mass(const strut_scene *scene, long double m[SLOW_NODES][SLOW_NODES]) {
  long double lumped[SLOW_NODES];
  bool consistent = scene->mass_model == STRUT_MASS_CONSISTENT;
  memset(m, 0, scene->node_count * sizeof *m);
  weigh(scene, !consistent, lumped);
  for (size_t i = 0; i < scene->node_count; i++) m[i][i] = lumped[i];
  for (size_t j = 0; j < scene->member_count && consistent; j++) {
    const strut_member *rod = &scene->members[j];
    int32_t a = rod->node[0], b = rod->node[1];
    if (rod->guide_count) continue;
    m[a][a] += rod->mass / 3.0L, m[b][b] += rod->mass / 3.0L;
    m[a][b] += rod->mass / 6.0L, m[b][a] += rod->mass / 6.0L;
  }
}

/* ---- members and hinges ---- */

static int sign_of(strut_carries carries) {
  return carries == STRUT_CARRIES_TENSION ? 1 : carries == STRUT_CARRIES_COMPRESSION ? -1 : 0;
}

static long double rate_of(const slow_strain *s, const long double *b, const long double *v) {
  long double rate = 0;
  for (size_t k = 0; k < 2 * s->count; k++) rate += b[k] * v[2 * (size_t)s->node[k / 2] + k % 2];
  return rate;
}

static void pull(const slow_strain *s, const long double *b, long double t, long double *force) {
  for (size_t k = 0; k < 2 * s->count; k++) force[2 * (size_t)s->node[k / 2] + k % 2] -= t * b[k];
}

/* Signals of actuators of a member (0), hinge (1) or cell (2), and their rates. */
typedef struct drive {
  long double value, rate;
} drive;

static drive drive_of(const slow_world *w, const slow_instant *at, int what, size_t item,
                      bool force) {
  drive sum = {0, 0};
  for (size_t i = 0; i < w->scene->actuator_count; i++) {
    const strut_actuator *a = &w->scene->actuators[i];
    int32_t mine = what == 0 ? a->member : what == 1 ? a->hinge : a->cell;
    bool kind = what == 0 || (a->member < 0 && (what == 1 || a->hinge < 0));
    if (!kind || mine != (int32_t)item || (a->force != 0) != force) continue;
    sum.value += slow_world_signal(w, at, a->signal);
    if (!force) sum.rate += slow_world_signal_rate(w, at, a->signal);
  }
  return sum;
}

/* The stiffness that damping counts with: at the natural strain. */
static long double first_stiffness(const strut_law *law, long double k) {
  return law->kind == STRUT_LAW_POLYNOMIAL ? (long double)law->force[0] : k;
}

/* An elastic-plastic spring is one that yields beside one that does not. */
static long double yielding_force(const strut_law *law, long double k, long double x,
                                  long double plastic) {
  long double first = k - law->second_stiffness, most = law->yield * first / k;
  long double t = first * (x - plastic);
  t = t > most ? most : t < -most ? -most : t;
  return t + law->second_stiffness * x;
}

/* A spring of that law with a damper that may be one-sided; x: beyond its natural strain, rate: of x. */
static long double element_force(const strut_law *law, long double k, long double damping,
                                 long double natural, long double x, long double rate, int carries,
                                 long double plastic) {
  long double t = law->kind == STRUT_LAW_ELASTIC_PLASTIC
                      ? yielding_force(law, k, x, plastic)
                      : slow_law_force(law, k, natural + x, natural);
  t += damping * rate;
  return carries && !(carries * x > 0 && carries * t > 0) ? 0 : t;
}

/* 2 zeta sqrt(stiffness / sum |de/dq|^2 / m) as drawn. */
static long double ratio_damping(const slow_world *w, const strut_member *m, long double k) {
  long double drawn[SLOW_PLACES], mass[SLOW_NODES], b[2 * SLOW_MOST], sum = 0;
  slow_strain path = slow_path_of(m);
  for (size_t i = 0; i < w->n; i++) drawn[i] = w->scene->nodes[i / 2].position[i % 2];
  weigh(w->scene, true, mass);
  slow_strain_gradient(&path, drawn, b);
  for (size_t i = 0; i < 2 * path.count; i++)
    if (!w->scene->nodes[path.node[i / 2]].fixed[i % 2])
      sum += b[i] * b[i] / mass[path.node[i / 2]];
  return sum > 0 ? 2 * m->damping_ratio * sqrtl(k / sum) : 0;
}

/* A member in its motion. */
typedef struct stretched {
  slow_strain path;
  long double b[2 * SLOW_MOST], e, rate; /* strain, its gradient and rate */
  long double natural, winding;          /* driven rest length, and its rate */
  long double stiffness, damping;        /* at the start */
  long double present;                   /* stiffness at the driven rest length, */
  long double least;                     /* which has no effect on it below this one */
} stretched;

static stretched stretch_of(const slow_world *w, const slow_instant *at, size_t j) {
  const strut_member *m = &w->scene->members[j];
  stretched s = {.path = slow_path_of(m)};
  drive rest = drive_of(w, at, 0, j, false);
  s.e = slow_strain_value(&s.path, at->q);
  slow_strain_gradient(&s.path, at->q, s.b);
  s.rate = rate_of(&s.path, s.b, at->v);
  slow_member_rest(w->scene, m, &s.natural, &s.stiffness);
  s.least = 1e-6L * s.natural; /* nothing is left of it */
  s.natural += rest.value, s.winding = rest.rate;
  long double first = first_stiffness(&m->law, s.stiffness);
  s.damping = m->damping + w->scene->rayleigh_stiffness * first;
  if (m->damping_ratio > 0) s.damping += ratio_damping(w, m, first);
  s.present = m->axial_stiffness > 0 ? m->axial_stiffness / fmaxl(s.natural, s.least) : s.stiffness;
  return s;
}

/* Of its own spring with its damper, and of its stops. */
static long double spring_force(const slow_world *w, const stretched *s, size_t j) {
  const strut_member *m = &w->scene->members[j];
  long double stop = m->stop_stiffness > 0 ? m->stop_stiffness : 100 * s->stiffness;
  int carries = m->kind == STRUT_CABLE ? 1 : sign_of(m->law.carries);
  if (w->gone[0][j]) return 0;
  long double t = element_force(&m->law, s->present, s->damping, s->natural, s->e - s->natural,
                                s->rate - s->winding, carries, w->plastic[0][j]);
  if (m->longest > 0)
    t += element_force(&LINEAR, stop, m->stop_damping, 0, s->e - m->longest, s->rate, 1, 0);
  if (m->shortest > 0)
    t += element_force(&LINEAR, stop, m->stop_damping, 0, s->e - m->shortest, s->rate, -1, 0);
  return t;
}

/* ---- cables that rub at their guides ---- */

typedef struct rubbing {
  size_t segments;
  long double length[SLOW_MOST], factor[SLOW_MOST]; /* and exp(mu theta) of the guide behind */
  long double material[SLOW_MOST], tension[SLOW_MOST];
  long double ea, whole;
} rubbing;

static long double tension_of(const rubbing *r, size_t k, long double material) {
  return r->ea * (r->length[k] / material - 1);
}

/* Material that flows from segment k to k + 1 until the tensions are within their bounds. */
static long double flow_at(const rubbing *r, size_t k) {
  long double left = tension_of(r, k, r->material[k]);
  long double right = tension_of(r, k + 1, r->material[k + 1]);
  bool forth = right > r->factor[k] * left, back = left > r->factor[k] * right;
  long double low = forth ? 0 : -r->material[k + 1], high = forth ? r->material[k] : 0;
  if (!forth && !back) return 0;
  for (int turn = 0; turn < 200; turn++) { /* the more flows, the less the right one pulls */
    long double middle = (low + high) / 2;
    long double a = tension_of(r, k, r->material[k] - middle);
    long double b = tension_of(r, k + 1, r->material[k + 1] + middle);
    bool more = forth ? b > r->factor[k] * a : r->factor[k] * b > a;
    *(more ? &low : &high) = middle;
  }
  return (low + high) / 2;
}

/*
 * The cable after its materials have given way as far as they must: each guide lets flow what brings its
 * bounds back, or nothing where they hold without, given the flows of the others.
 */
static rubbing rub(const slow_world *w, const stretched *s, size_t j, const long double *q) {
  const strut_member *m = &w->scene->members[j];
  rubbing r = {.segments = s->path.count - 1, .ea = s->present * s->natural, .whole = s->natural};
  long double flow[SLOW_MOST] = {0}, others = 0, sum = 0;
  for (size_t k = 0; k < r.segments; k++) {
    const long double *a = q + 2 * s->path.node[k], *b = q + 2 * s->path.node[k + 1];
    sum += r.length[k] = hypotl(b[0] - a[0], b[1] - a[1]);
    if (k + 1 < r.segments) {
      const long double *c = q + 2 * s->path.node[k + 2];
      long double x = b[0] - a[0], y = b[1] - a[1], x2 = c[0] - b[0], y2 = c[1] - b[1];
      r.factor[k] = expl(m->guide_friction * fabsl(atan2l(x * y2 - y * x2, x * x2 + y * y2)));
    }
  }
  bool fresh = w->material[j][0] == 0, slack = sum <= r.whole;
  for (size_t k = 0; k < r.segments; k++)
    r.material[k] = fresh || slack ? r.whole * r.length[k] / sum : w->material[j][k];
  for (size_t k = 1; k < r.segments; k++) others += r.material[k];
  r.material[0] = r.whole - others; /* what is wound in comes in there */
  for (int sweep = 0; sweep < 2000 && !slack && !fresh; sweep++) {
    long double changed = 0;
    for (size_t k = 0; k + 1 < r.segments; k++) {
      r.material[k] += flow[k], r.material[k + 1] -= flow[k];
      long double now = flow_at(&r, k);
      r.material[k] -= now, r.material[k + 1] += now;
      changed = fmaxl(changed, fabsl(now - flow[k]));
      flow[k] = now;
    }
    if (changed < 1e-19L * r.whole) break;
  }
  for (size_t k = 0; k < r.segments; k++)
    r.tension[k] = slack ? 0 : tension_of(&r, k, r.material[k]);
  return r;
}

/* Its damper acts along the whole cable while all of it is taut, and does not push. */
static long double rubbing_damper(const stretched *s, const rubbing *r) {
  long double least = r->tension[0], damper = s->damping * (s->rate - s->winding);
  for (size_t k = 1; k < r->segments; k++) least = fminl(least, r->tension[k]);
  return least > 0 ? fmaxl(damper, -least) : 0;
}

static void pull_rubbing(const slow_world *w, const slow_instant *at, const stretched *s, size_t j,
                         long double *force) {
  rubbing r = rub(w, s, j, at->q);
  long double damper = rubbing_damper(s, &r), b[4];
  for (size_t k = 0; k < r.segments; k++) {
    slow_strain part = {.count = 2, .node = {s->path.node[k], s->path.node[k + 1]}};
    slow_strain_gradient(&part, at->q, b);
    pull(&part, b, r.tension[k] + damper, force);
  }
}

/* ---- all of them ---- */

static bool rubs(const strut_member *m) { return m->guide_count && m->guide_friction > 0; }

static long double maxwell_damping(const strut_maxwell *m) {
  return m->damping > 0 ? m->damping : m->stiffness * m->time;
}

long double slow_world_member(const slow_world *w, const slow_instant *at, size_t j) {
  stretched s = stretch_of(w, at, j);
  long double t = drive_of(w, at, 0, j, true).value;
  if (w->maxwell_of[j] != NONE) t += at->z[w->maxwell_of[j]];
  if (!rubs(&w->scene->members[j])) return t + spring_force(w, &s, j);
  rubbing r = rub(w, &s, j, at->q);
  return t + r.tension[0] + rubbing_damper(&s, &r);
}

static void add_members(const slow_world *w, const slow_instant *at, slow_rates *r) {
  for (size_t j = 0; j < w->scene->member_count; j++) {
    const strut_member *m = &w->scene->members[j];
    stretched s = stretch_of(w, at, j);
    long double t = drive_of(w, at, 0, j, true).value;
    if (rubs(m) && !w->gone[0][j])
      pull_rubbing(w, at, &s, j, r->force);
    else
      t += spring_force(w, &s, j);
    if (w->maxwell_of[j] != NONE) {
      long double tension = at->z[w->maxwell_of[j]];
      r->z[w->maxwell_of[j]] =
          m->maxwell.stiffness * (s.rate - s.winding - tension / maxwell_damping(&m->maxwell));
      t += tension;
    }
    pull(&s.path, s.b, t, r->force);
  }
}

static slow_strain angle_of(const slow_world *w, size_t i) {
  slow_strain s = {.kind = SLOW_ANGLE, .count = 3, .near = w->turn[i]};
  for (int k = 0; k < 3; k++) s.node[k] = w->scene->hinges[i].node[k];
  return s;
}

static long double hinge_damping(const slow_world *w, const strut_hinge *h) {
  return h->damping + w->scene->rayleigh_stiffness * first_stiffness(&h->law, h->stiffness);
}

static void add_hinges(const slow_world *w, const slow_instant *at, slow_rates *r) {
  for (size_t i = 0; i < w->scene->hinge_count; i++) {
    const strut_hinge *h = &w->scene->hinges[i];
    slow_strain s = angle_of(w, i);
    drive rest = drive_of(w, at, 1, i, false);
    long double b[6], e = slow_strain_value(&s, at->q), natural = w->rest_angle[i] + rest.value;
    long double damping = hinge_damping(w, h);
    slow_strain_gradient(&s, at->q, b);
    long double t = w->gone[1][i] ? 0
                                  : element_force(&h->law, h->stiffness, damping, natural,
                                                  e - natural, rate_of(&s, b, at->v) - rest.rate,
                                                  sign_of(h->law.carries), w->plastic[1][i]);
    pull(&s, b, t + drive_of(w, at, 1, i, true).value, r->force);
  }
}

/* ---- cells and collisions ---- */

static void add_cells(const slow_world *w, const slow_instant *at, slow_rates *r) {
  for (size_t i = 0; i < w->scene->cell_count; i++) {
    const strut_cell *c = &w->scene->cells[i];
    slow_strain s = {.kind = SLOW_AREA, .count = c->node_count, .near = 1};
    long double b[2 * SLOW_MOST], drawn[SLOW_PLACES], pressure = c->pressure;
    memcpy(s.node, c->node, c->node_count * sizeof *s.node);
    for (size_t k = 0; k < w->n; k++) drawn[k] = w->scene->nodes[k / 2].position[k % 2];
    s.near = slow_strain_value(&s, drawn);
    long double first = fabsl(s.near), now = slow_strain_value(&s, at->q);
    slow_strain_gradient(&s, at->q, b);
    if (now < first / 100) r->undecided = true; /* a run ends where a cell collapses */
    if (strut_cell_is_elastic(c)) {
      long double natural = isnan(c->rest_area) ? first : (long double)c->rest_area;
      pull(&s, b,
           element_force(&c->elastic, c->stiffness, c->damping, natural, now - natural,
                         rate_of(&s, b, at->v), sign_of(c->elastic.carries), 0),
           r->force);
      continue;
    }
    if (c->law == STRUT_LAW_ISOTHERMAL) pressure *= first / now;
    if (c->law == STRUT_LAW_ISENTROPIC) pressure *= powl(first / now, c->exponent);
    pressure += drive_of(w, at, 2, i, false).value - c->outside;
    pull(&s, b, -pressure, r->force);
  }
}

static void add_touch(const strut_collision *c, const slow_strain *s, const slow_instant *at,
                      slow_rates *r) {
  long double b[6], e = slow_strain_value(s, at->q);
  slow_strain_gradient(s, at->q, b);
  long double push = c->stiffness * (c->thickness - e) - c->damping * rate_of(s, b, at->v);
  if (e < c->thickness && push > 0) pull(s, b, -push, r->force);
  if (e < 1e-3L) r->undecided = true;
}

static slow_strain reach_of(int32_t node, const strut_member *m) {
  return (slow_strain){.kind = SLOW_REACH, .count = 3, .node = {node, m->node[0], m->node[1]}};
}

static void add_collisions(const slow_world *w, const slow_instant *at, slow_rates *r) {
  for (size_t i = 0; i < w->scene->collision_count; i++) {
    const strut_collision *c = &w->scene->collisions[i];
    const strut_member *members = w->scene->members;
    slow_strain s = {.count = 2, .node = {c->node[0], c->node[1]}};
    if (c->node[0] >= 0 && c->node[1] >= 0) add_touch(c, &s, at, r);
    for (int end = 0; end < 2 && c->member[1] >= 0; end++)
      for (int k = 0; k < 2; k++) {
        s = reach_of(members[c->member[k]].node[end], &members[c->member[1 - k]]);
        add_touch(c, &s, at, r);
      }
    if (c->node[0] < 0 || c->member[0] < 0) continue;
    s = reach_of(c->node[0], &members[c->member[0]]);
    add_touch(c, &s, at, r);
  }
}

static void add_distances(const slow_world *w, const slow_instant *at, slow_rates *r) {
  for (size_t i = 0; i < w->scene->distance_count; i++) {
    const strut_distance_spring *d = &w->scene->distances[i];
    slow_strain s = {
        .kind = SLOW_ALONG, .count = 2, .node = {d->node[0], d->node[1]}, .near = d->along};
    if (d->line[0] >= 0)
      s = (slow_strain){
          .kind = SLOW_OFFSET, .count = 3, .node = {d->node[0], d->line[0], d->line[1]}};
    long double b[6], drawn[SLOW_PLACES], e = slow_strain_value(&s, at->q);
    for (size_t k = 0; k < w->n; k++) drawn[k] = w->scene->nodes[k / 2].position[k % 2];
    long double natural = isnan(d->rest_distance) ? slow_strain_value(&s, drawn) : d->rest_distance;
    slow_strain_gradient(&s, at->q, b);
    pull(&s, b,
         element_force(&d->law, d->stiffness, d->damping, natural, e - natural,
                       rate_of(&s, b, at->v), sign_of(d->law.carries), 0),
         r->force);
  }
}

/* ---- loads, weights, rotating masses, damping by mass ---- */

static void add_loads(const slow_world *w, const slow_instant *at, slow_rates *r) {
  const strut_scene *scene = w->scene;
  long double mass[SLOW_NODES], m[SLOW_NODES][SLOW_NODES];
  weigh(scene, true, mass);
  slow_world_mass(scene, m);
  for (size_t i = 0; i < w->n; i++) {
    r->force[i] += mass[i / 2] * scene->gravity[i % 2];
    for (size_t k = 0; k < scene->node_count; k++)
      r->force[i] -= scene->rayleigh_mass * m[i / 2][k] * at->v[2 * k + i % 2];
  }
  for (size_t i = 0; i < scene->load_count; i++) {
    const strut_load *load = &scene->loads[i];
    long double factor = load->signal < 0 ? 1 : slow_world_signal(w, at, load->signal);
    for (size_t c = 0; c < 2; c++) r->force[2 * (size_t)load->node + c] += factor * load->force[c];
  }
}

/* The rate of a signal of the time alone, by differences of its rate. */
static long double bend_of(const slow_world *w, const slow_instant *at, int32_t signal) {
  const long double h = 1e-5L;
  long double rate[5];
  for (int k = 0; k < 5; k++) {
    slow_instant near = *at;
    near.t += h * k;
    rate[k] = slow_world_signal_rate(w, &near, signal);
  }
  return from_the_right(rate) / h;
}

static void add_unbalances(const slow_world *w, const slow_instant *at, slow_rates *r) {
  for (size_t i = 0; i < w->scene->unbalance_count; i++) {
    const strut_unbalance *u = &w->scene->unbalances[i];
    long double angle = u->phase + u->speed * at->t, rate = u->speed, bend = 0;
    long double arm = u->mass * (long double)u->radius, *force = r->force + 2 * u->node;
    if (u->signal >= 0) {
      angle += slow_world_signal(w, at, u->signal);
      rate = slow_world_signal_rate(w, at, u->signal), bend = bend_of(w, at, u->signal);
    }
    /* minus the acceleration of r (cos, sin) */
    force[0] += arm * (rate * rate * cosl(angle) + bend * sinl(angle));
    force[1] += arm * (rate * rate * sinl(angle) - bend * cosl(angle));
  }
}

/* ---- contacts ---- */

/* A contact in its motion: against the ground, and against its belt. */
typedef struct touch {
  long double gap, n[2], t[2], into, slip;
} touch;

static touch touch_of(const slow_world *w, const slow_instant *at, size_t i) {
  const strut_contact *c = &w->scene->contacts[i];
  const strut_ground *g =
      w->scene->ground.present ? &w->scene->ground : &w->scene->grounds[c->ground];
  size_t node = 2 * (size_t)c->node;
  long double p[2], u[2];
  touch k;
  for (size_t a = 0; a < 2; a++) {
    p[a] = at->q[node + a], u[a] = at->v[node + a];
    if (!g->moves[a]) continue;
    p[a] -= slow_world_signal(w, at, g->motion[a]);
    u[a] -= slow_world_signal_rate(w, at, g->motion[a]);
  }
  k.gap = slow_ground_gap(w->scene, c, p, k.n);
  k.t[0] = k.n[1], k.t[1] = -k.n[0];
  k.into = u[0] * k.n[0] + u[1] * k.n[1];
  k.slip = u[0] * k.t[0] + u[1] * k.t[1] - g->belt_speed;
  return k;
}

static long double normal_of(const slow_world *w, size_t i, const touch *k) {
  const strut_contact *c = &w->scene->contacts[i];
  const strut_ground *g =
      w->scene->ground.present ? &w->scene->ground : &w->scene->grounds[c->ground];
  long double depth = -k->gap, spring = c->stiffness * depth;
  if (depth <= 0) return 0;
  if (g->damping_law == STRUT_DAMPING_HUNT_CROSSLEY)
    return fmaxl(0, spring * (1 - c->dissipation * k->into));
  return spring + (k->into < 0 ? -c->damping * k->into : 0);
}

/* Under the other forces on the node along the ground. */
static long double friction_of(const strut_friction *f, long double normal, long double slip,
                               long double others) {
  bool stribeck = f->law == STRUT_FRICTION_STRIBECK;
  bool slides = stribeck || f->law == STRUT_FRICTION_SMOOTH || fabsl(slip) >= f->stick_velocity;
  long double towards = slides && slip != 0 ? slip : others;
  bool back = f->directional && towards < 0;
  long double held = back ? f->mu_static_backward : f->mu_static;
  long double mu = back ? f->mu_kinetic_backward : f->mu_kinetic;
  if (f->law == STRUT_FRICTION_NONE) return 0;
  if (stribeck) { /* half way at the speed of decay */
    long double v2 = (long double)f->decay_velocity * f->decay_velocity;
    mu = (held * v2 + mu * slip * slip) / (v2 + slip * slip);
  }
  if (stribeck || f->law == STRUT_FRICTION_SMOOTH)
    return -mu * normal * slip / sqrtl(slip * slip + (long double)f->width * f->width);
  if (!slides && fabsl(others) < held * normal) return -others;
  return -copysignl(mu * normal, towards);
}

/* Within its stick band, and held or, `loose`, not. */
static bool in_band(const strut_friction *f, long double slip, long double normal,
                    long double friction, bool loose) {
  long double least = fminl(f->mu_kinetic, f->directional ? f->mu_kinetic_backward : HUGE_VALL);
  if (f->law != STRUT_FRICTION_KARNOPP || !(normal > 0)) return false;
  if (!(fabsl(slip) < f->stick_velocity)) return false;
  return !loose || fabsl(friction) >= least * normal * (1 - 1e-12L);
}

/* Where static friction is above kinetic, either of two contacts in their bands may be the one that holds. */
static bool is_open(const strut_scene *scene, size_t first, size_t end, const touch *touches,
                    const slow_rates *r) {
  int bands = 0, loose = 0;
  for (size_t i = first; i < end; i++) {
    const strut_friction *f = &scene->contacts[i].friction;
    bands += in_band(f, touches[i].slip, r->normal[i], r->friction[i], false);
    loose += f->mu_static != f->mu_kinetic &&
             in_band(f, touches[i].slip, r->normal[i], r->friction[i], true);
  }
  return bands > 1 && loose > 0;
}

/* Friction of all contacts of a node, until they agree. */
static void rub_node(const strut_scene *scene, size_t first, size_t end, const touch *touches,
                     long double *f, slow_rates *r) {
  for (int sweep = 0; sweep < 5000; sweep++) {
    long double changed = 0, size = 1;
    for (size_t i = first; i < end; i++) {
      const touch *k = &touches[i];
      if (!(r->normal[i] > 0)) continue;
      long double others = f[0] * k->t[0] + f[1] * k->t[1] - r->friction[i];
      long double now = friction_of(&scene->contacts[i].friction, r->normal[i], k->slip, others);
      changed = fmaxl(changed, fabsl(now - r->friction[i]));
      size = fmaxl(size, fabsl(others));
      for (int c = 0; c < 2; c++) f[c] += (now - r->friction[i]) * k->t[c];
      r->friction[i] = now;
    }
    if (changed >= 1e-16L * size) continue;
    if (is_open(scene, first, end, touches, r)) break;
    return;
  }
  r->undecided = true;
}

static void add_contacts(const slow_world *w, const slow_instant *at, slow_rates *r) {
  const strut_scene *scene = w->scene;
  touch touches[SLOW_ITEMS];
  for (size_t first = 0, end; first < scene->contact_count; first = end) {
    long double *f = r->force + 2 * scene->contacts[first].node;
    for (end = first; end < scene->contact_count; end++) {
      if (scene->contacts[end].node != scene->contacts[first].node) break;
      touches[end] = touch_of(w, at, end);
      r->normal[end] = normal_of(w, end, &touches[end]);
      for (int c = 0; c < 2; c++) f[c] += r->normal[end] * touches[end].n[c];
    }
    rub_node(scene, first, end, touches, f, r);
  }
}

static long double sensor_value(const slow_world *w, const slow_instant *at,
                                const strut_sensor *s) {
  long double sum = 0, m[SLOW_NODES][SLOW_NODES];
  slow_strain strain;
  switch ((int)s->kind) {
    case STRUT_COLUMN_LENGTH:
      strain = slow_path_of(&w->scene->members[s->item]);
      return slow_strain_value(&strain, at->q);
    case STRUT_COLUMN_HINGE_ANGLE:
      strain = angle_of(w, (size_t)s->item);
      return slow_strain_value(&strain, at->q);
    case STRUT_COLUMN_NODE_X: return at->q[2 * (uint32_t)s->item + s->along];
    case STRUT_COLUMN_NODE_VX: return at->v[2 * (uint32_t)s->item + s->along];
    case STRUT_COLUMN_FORCE: /* without what an actuator adds, which may follow it */
      return slow_world_member(w, at, (size_t)s->item) -
             drive_of(w, at, 0, (size_t)s->item, true).value;
    case STRUT_COLUMN_TOUCHES:
      for (size_t i = 0; i < w->scene->contact_count; i++)
        if (w->scene->contacts[i].node == s->item && touch_of(w, at, i).gap < 0) return 1;
      return 0;
    case STRUT_COLUMN_KINETIC:
      assert_int_equal(s->energy, 0);
      slow_world_mass(w->scene, m);
      for (size_t i = 0; i < w->n; i++)
        for (size_t k = 0; k < w->scene->node_count; k++)
          sum += m[i / 2][k] * at->v[i] * at->v[2 * k + i % 2] / 2;
      return sum;
    case STRUT_COLUMN_NORMAL:
      for (size_t i = 0; i < w->scene->contact_count; i++) {
        const touch k = touch_of(w, at, i);
        if (w->scene->contacts[i].node == s->item) sum += normal_of(w, i, &k);
      }
      return sum;
    default: break; /* as columns of cells, distances and collisions: tests/cli/feedback_test.sh */
  }
  fail_msg("no such sensor");
  return 0;
}

/* ---- motion ---- */

static int32_t signal_that_moves(const slow_world *w, size_t i) {
  for (size_t k = 0; k < w->scene->support_motion_count; k++) {
    const strut_support_motion *m = &w->scene->support_motions[k];
    if (2 * (size_t)m->node + (size_t)m->axis == i) return m->signal;
  }
  return -1;
}

/* -M_fc a_c: what supports that move push by the mass that free nodes share with them. */
static void add_pushes(const slow_world *w, const slow_instant *at, slow_rates *r) {
  long double m[SLOW_NODES][SLOW_NODES];
  slow_world_mass(w->scene, m);
  for (size_t k = 0; k < w->n; k++) {
    int32_t signal = signal_that_moves(w, k);
    if (signal < 0) continue;
    for (size_t i = k % 2; i < w->n; i += 2)
      if (!w->scene->nodes[i / 2].fixed[i % 2])
        r->force[i] -= m[i / 2][k / 2] * bend_of(w, at, signal);
  }
}

/* M a = F of the free coordinates. */
static void accelerate(const slow_world *w, slow_rates *r) {
  static long double a[SLOW_PLACES * (SLOW_PLACES + 1)];
  long double m[SLOW_NODES][SLOW_NODES];
  size_t n = w->n, width = n + 1;
  slow_world_mass(w->scene, m);
  memset(a, 0, n * width * sizeof *a);
  for (size_t i = 0; i < n; i++) {
    bool fixed = w->scene->nodes[i / 2].fixed[i % 2];
    for (size_t k = i % 2; k < n; k += 2)
      if (!fixed && !w->scene->nodes[k / 2].fixed[k % 2]) a[i * width + k] = m[i / 2][k / 2];
    if (fixed) a[i * width + i] = 1;
    a[i * width + n] = fixed ? 0 : r->force[i];
  }
  slow_solve(a, n, r->a);
}

void slow_world_rates(const slow_world *w, const slow_instant *at, slow_rates *r) {
  *r = (slow_rates){.force = {0}};
  rate_states(w, at, r->z);
  add_loads(w, at, r);
  add_members(w, at, r);
  add_hinges(w, at, r);
  add_cells(w, at, r);
  add_collisions(w, at, r);
  add_distances(w, at, r);
  add_unbalances(w, at, r);
  add_pushes(w, at, r);
  add_contacts(w, at, r);
  accelerate(w, r);
}

/* What a drive does to a spring of EA x^2 / (2 L0), beside pulling: that falls as L0 grows. */
static long double softening(const stretched *s, long double elastic) {
  if (elastic == 0 || s->natural <= s->least) return 0;
  return -elastic * (s->e - s->natural) / (2 * s->natural) * s->winding;
}

void slow_world_powers(const slow_world *w, const slow_instant *at, const slow_rates *r,
                       long double *power) {
  const strut_scene *scene = w->scene;
  memset(power, 0, STRUT_POWER_EXCHANGED * sizeof *power);
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *m = &scene->members[j];
    stretched s = stretch_of(w, at, j);
    bool slack = m->kind == STRUT_CABLE && s.e <= s.natural;
    long double t = slow_world_member(w, at, j);
    long double elastic = slack ? 0 : s.present * (s.e - s.natural);
    power[STRUT_POWER_DRIVE] -= t * s.winding;
    if (m->axial_stiffness > 0) power[STRUT_POWER_DRIVE] += softening(&s, elastic);
    power[STRUT_POWER_MEMBERS] += (t - elastic) * (s.rate - s.winding);
  }
  for (size_t i = 0; i < scene->load_count; i++) {
    const strut_load *load = &scene->loads[i];
    const long double *v = at->v + 2 * load->node;
    if (load->signal >= 0)
      power[STRUT_POWER_LOAD] +=
          slow_world_signal(w, at, load->signal) * (load->force[0] * v[0] + load->force[1] * v[1]);
  }
  for (size_t i = 0; i < scene->contact_count; i++) {
    touch k = touch_of(w, at, i);
    long double damper = r->normal[i] > 0 && k.into < 0 ? scene->contacts[i].damping : 0;
    power[STRUT_POWER_CONTACT] += damper * k.into * k.into;
    power[STRUT_POWER_FRICTION] -= r->friction[i] * k.slip;
    power[STRUT_POWER_BELT] += r->friction[i] * scene->ground.belt_speed;
  }
}

void slow_world_place(const slow_world *w, slow_instant *at) {
  for (size_t i = 0; i < w->n; i++) {
    int32_t signal = signal_that_moves(w, i);
    if (signal < 0) continue;
    at->q[i] = w->scene->nodes[i / 2].position[i % 2] + slow_world_signal(w, at, signal);
    at->v[i] = slow_world_signal_rate(w, at, signal);
  }
}

void slow_world_begin(slow_world *w, const strut_scene *scene, const slow_text *texts,
                      size_t text_count, slow_instant *at) {
  *w = (slow_world){.scene = scene,
                    .texts = texts,
                    .text_count = text_count,
                    .n = 2 * scene->node_count,
                    .states = scene->state_count};
  *at = (slow_instant){.t = 0};
  assert_true(w->n <= SLOW_PLACES && scene->member_count <= SLOW_ITEMS &&
              scene->signal_count <= SLOW_ITEMS && scene->contact_count <= SLOW_ITEMS);
  for (size_t k = 0; k < scene->state_count; k++) at->z[k] = scene->states[k].start;
  for (size_t i = 0; i < scene->signal_count; i++)
    w->lag_of[i] = scene->signals[i].lag > 0 ? w->states++ : NONE;
  for (size_t j = 0; j < scene->member_count; j++) {
    w->maxwell_of[j] = scene->members[j].maxwell.stiffness > 0 ? w->states++ : NONE;
    if (w->maxwell_of[j] != NONE) at->z[w->maxwell_of[j]] = scene->members[j].maxwell.force;
  }
  assert_true(w->states <= SLOW_STATES);
  for (size_t i = 0; i < w->n; i++) {
    at->q[i] = scene->nodes[i / 2].start[i % 2];
    at->v[i] = scene->nodes[i / 2].velocity[i % 2];
  }
  long double drawn[SLOW_PLACES];
  for (size_t i = 0; i < w->n; i++) drawn[i] = scene->nodes[i / 2].position[i % 2];
  for (size_t i = 0; i < scene->hinge_count; i++) {
    slow_strain s = angle_of(w, i); /* as drawn: within half a turn */
    double given = scene->hinges[i].rest_angle;
    w->turn[i] = w->rest_angle[i] = isnan(given) ? slow_strain_value(&s, drawn) : given;
  }
  slow_world_place(w, at);
}

/* At the multiples of their time, those that others use first. */
static void take_samples(slow_world *w, const slow_instant *at, long double h) {
  for (size_t i = 0; i < w->scene->signal_count; i++) {
    long double every = w->scene->signals[i].every;
    if (every > 0 && fabsl(at->t - every * roundl(at->t / every)) < h / 100)
      w->held[i] = lagged_value(w, at, (int32_t)i);
  }
}

static void yield_to(const strut_law *law, long double k, long double x, long double *plastic) {
  long double first = k - law->second_stiffness, most = law->yield / k;
  if (law->kind != STRUT_LAW_ELASTIC_PLASTIC || first == 0) return;
  if (x - *plastic > most) *plastic = x - most;
  if (x - *plastic < -most) *plastic = x + most;
}

/* What has yielded, slipped, broken or is released at the end of a step. */
static void remember(slow_world *w, const slow_instant *at) {
  for (size_t j = 0; j < w->scene->member_count; j++) {
    const strut_member *m = &w->scene->members[j];
    stretched s = stretch_of(w, at, j);
    yield_to(&m->law, s.stiffness, s.e - s.natural, &w->plastic[0][j]);
    if (rubs(m)) memcpy(w->material[j], rub(w, &s, j, at->q).material, sizeof w->material[j]);
    if (m->breaks_at > 0 && spring_force(w, &s, j) >= m->breaks_at) w->gone[0][j] = true;
    if (m->released_at > 0 && at->t >= m->released_at * (1 - 1e-9L)) w->gone[0][j] = true;
  }
  for (size_t i = 0; i < w->scene->hinge_count; i++) {
    const strut_hinge *h = &w->scene->hinges[i];
    slow_strain s = angle_of(w, i);
    drive rest = drive_of(w, at, 1, i, false);
    long double b[6], e = slow_strain_value(&s, at->q);
    long double natural = w->rest_angle[i] + rest.value, x = e - natural;
    w->turn[i] = e;
    slow_strain_gradient(&s, at->q, b);
    yield_to(&h->law, h->stiffness, x, &w->plastic[1][i]);
    long double moment =
        element_force(&h->law, h->stiffness, hinge_damping(w, h), natural, x,
                      rate_of(&s, b, at->v) - rest.rate, sign_of(h->law.carries), w->plastic[1][i]);
    if (h->breaks_at > 0 && fabsl(moment) >= h->breaks_at) w->gone[1][i] = true;
    if (h->released_at > 0 && at->t >= h->released_at * (1 - 1e-9L)) w->gone[1][i] = true;
  }
}

static slow_instant stage(const slow_world *w, const slow_instant *from, const slow_instant *speed,
                          const slow_rates *r, long double h) {
  slow_instant next = *from;
  next.t += h;
  for (size_t i = 0; i < w->n; i++) {
    next.q[i] += h * speed->v[i];
    next.v[i] += h * r->a[i];
  }
  for (size_t k = 0; k < w->states; k++) next.z[k] += h * r->z[k];
  slow_world_place(w, &next);
  return next;
}

bool slow_world_step(slow_world *w, slow_instant *at, long double h) {
  slow_instant x[4] = {*at};
  slow_rates r[4];
  if (at->t == 0) remember(w, at);
  take_samples(w, at, h);
  for (int k = 0; k < 4; k++) {
    slow_world_rates(w, &x[k], &r[k]);
    if (r[k].undecided) return false;
    if (k < 3) x[k + 1] = stage(w, at, &x[k], &r[k], k == 2 ? h : h / 2);
  }
  for (size_t i = 0; i < w->n; i++) {
    at->q[i] += h / 6 * (x[0].v[i] + 2 * x[1].v[i] + 2 * x[2].v[i] + x[3].v[i]);
    at->v[i] += h / 6 * (r[0].a[i] + 2 * r[1].a[i] + 2 * r[2].a[i] + r[3].a[i]);
  }
  for (size_t k = 0; k < w->states; k++)
    at->z[k] += h / 6 * (r[0].z[k] + 2 * r[1].z[k] + 2 * r[2].z[k] + r[3].z[k]);
  at->t += h;
  slow_world_place(w, at);
  remember(w, at);
  return true;
}
