/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The crawler by hand, with the structure's own shape used to fill the vector registers: nodes 1 to
 * 4 stand in one, members 8, 9, 2, 3 run from them to node 5, members 4 to 7 from the nodes 1 and 2
 * to 3 and 4. Contact and friction are computed for all four nodes without a branch.
 */
#include <math.h>
#include <stdint.h>

#include "engine/base/vec.h"
#include "engine/model/hot.h"
#include "tests/bench/hand_kernel.h"

typedef strut_lanes v4;
typedef strut_lane_mask m4;

/* Nodes 1 to 4 in vectors, node 5 beside them. */
typedef struct nodes {
  v4 x, y;
  double x5, y5;
} nodes;

#define SHUFFLE(a, ...) __builtin_shufflevector(a, a, __VA_ARGS__)
#define SPLAT(s) ((v4){s, s, s, s})
#define SQRT4(a) ((v4){sqrt((a)[0]), sqrt((a)[1]), sqrt((a)[2]), sqrt((a)[3])})
#define SELECT(mask, a, b) ((v4)(((mask) & (m4)(a)) | (~(mask) & (m4)(b))))

#define C_BAR 1e6
#define C_SOFT 3000.0
#define C_STRONG 1e4
#define K 0.2
#define STICK 1e-4

/* Force densities of members 8, 9, 2, 3 (b), of 4, 7, 5, 6 (a) and of 1 (d), times their vectors.
 */
typedef struct pulls {
  v4 bx, by, ax, ay;
  double dx, dy;
} pulls;

/* (1), (2), (6) */
STRUT_INLINE void members(const nodes *q, const nodes *v, double s, double rate, pulls *out) {
  v4 bx = q->x5 - q->x, by = q->y5 - q->y, bu = v->x5 - v->x, bw = v->y5 - v->y;
  v4 ax = SHUFFLE(q->x, 2, 3, 2, 3) - SHUFFLE(q->x, 0, 0, 1, 1);
  v4 ay = SHUFFLE(q->y, 2, 3, 2, 3) - SHUFFLE(q->y, 0, 0, 1, 1);
  v4 au = SHUFFLE(v->x, 2, 3, 2, 3) - SHUFFLE(v->x, 0, 0, 1, 1);
  v4 aw = SHUFFLE(v->y, 2, 3, 2, 3) - SHUFFLE(v->y, 0, 0, 1, 1);
  double dx = q->x[1] - q->x[0], dy = q->y[1] - q->y[0];
  double du = v->x[1] - v->x[0], dw = v->y[1] - v->y[0];
  v4 b2 = bx * bx + by * by, a2 = ax * ax + ay * ay;
  v4 b = SPLAT(1.0) / SQRT4(b2), a = SPLAT(1.0) / SQRT4(a2);
  double d = 1.0 / sqrt(dx * dx + dy * dy);
  const v4 stiffness = {C_STRONG, C_STRONG, C_BAR, C_BAR};
  v4 rest = {0.01 + s, 0.01, 0.02, 0.02}, driven = {rate, 0, 0, 0};
  v4 fb = (stiffness - stiffness * rest * b) + K * b * ((bu * bx + bw * by) * b - driven);
  v4 fa = (C_SOFT - C_SOFT * 0.02 * a) + K * a * ((au * ax + aw * ay) * a);
  double fd = (C_BAR - C_BAR * 0.1 * d) + K * d * ((du * dx + dw * dy) * d);
  *out = (pulls){fb * bx, fb * by, fa * ax, fa * ay, fd * dx, fd * dy};
}

/* (8), (9) for nodes 1 to 4. Within the band, (9) is a force of min(|F_res|, mu F_N). */
STRUT_INLINE void contacts(const nodes *q, const nodes *v, double mu, v4 *fx, v4 *fy) {
  const m4 magnitude = {INT64_MAX, INT64_MAX, INT64_MAX, INT64_MAX};
  m4 touch = q->y < 0.0, down = v->y < 0.0;
  v4 normal = (v4)(touch & (m4)(-1e5 * q->y - (v4)(down & (m4)(100.0 * v->y))));
  v4 limit = mu * normal, resultant = (v4)((m4)*fx & magnitude);
  m4 slide = (v4)((m4)v->x & magnitude) >= STICK, stick = resultant < limit;
  v4 size = SELECT(slide | ~stick, limit, resultant), against = SELECT(slide, v->x, *fx);
  *fx -= (v4)((m4)size | ((m4)against & ~magnitude));
  *fy += normal;
}

/* The same for node 5, which touches the ground in state III only. */
STRUT_INLINE void contact_5(const nodes *q, const nodes *v, double mu, double *fx, double *fy) {
  if (q->y5 >= 0) return;
  double normal = v->y5 < 0 ? -1e5 * q->y5 - 100.0 * v->y5 : -1e5 * q->y5, limit = mu * normal;
  int slide = fabs(v->x5) >= STICK;
  *fx -= copysign(slide || fabs(*fx) >= limit ? limit : fabs(*fx), slide ? v->x5 : *fx);
  *fy += normal;
}

/* (10); the last lines are the inverses of the consistent mass of nodes (1, 2) and (3, 4, 5). */
STRUT_INLINE void acceleration(const nodes *q, const nodes *v, double s, double rate, double mu,
                               nodes *out) {
  pulls p;
  members(q, v, s, rate, &p);
  const v4 sign = {1, 1, -1, -1};
  v4 ax = SHUFFLE(p.ax, 0, 2, 0, 1) + SHUFFLE(p.ax, 1, 3, 2, 3);
  v4 ay = SHUFFLE(p.ay, 0, 2, 0, 1) + SHUFFLE(p.ay, 1, 3, 2, 3);
  v4 fx = p.bx + sign * ax + (v4){p.dx, -p.dx, 0, 0};
  v4 fy = p.by + sign * ay + (v4){p.dy, -p.dy, 0, 0};
  fy += (v4){-0.05 * 9.81, -0.05 * 9.81, -0.01 * 9.81, -0.01 * 9.81};
  double f5 = -((p.bx[0] + p.bx[1]) + (p.bx[2] + p.bx[3]));
  double g5 = -((p.by[0] + p.by[1]) + (p.by[2] + p.by[3])) - 0.02 * 9.81;
  contacts(q, v, mu, &fx, &fy);
  contact_5(q, v, mu, &f5, &g5);
  const v4 diagonal = {40, 40, 175, 175}, beside = {-20, -20, 25, 25}, to5 = {0, 0, -50, -50};
  out->x = diagonal * fx + beside * SHUFFLE(fx, 1, 0, 3, 2) + to5 * f5;
  out->y = diagonal * fy + beside * SHUFFLE(fy, 1, 0, 3, 2) + to5 * g5;
  out->x5 = 100.0 * f5 - 50.0 * (fx[2] + fx[3]);
  out->y5 = 100.0 * g5 - 50.0 * (fy[2] + fy[3]);
}

#define EACH(X) X(x) X(y) X(x5) X(y5)
STRUT_INLINE void add(const nodes *a, double h, const nodes *b, nodes *out) {
#define ADD(n) out->n = a->n + h * b->n;
  EACH(ADD)
#undef ADD
}
STRUT_INLINE void add_mean(nodes *z, double sixth, const nodes *a, const nodes *b, const nodes *c,
                           const nodes *d) {
#define MEAN(n) z->n += sixth * (a->n + d->n + 2.0 * (b->n + c->n));
  EACH(MEAN)
#undef MEAN
}

/* Local, because clang 14 names the clones of a public function otherwise than gcc. */
STRUT_CLONES
static void run(hand_crawler_state *state, double dt, double f, double a, double mu,
                long long steps) {
  const double *x = state->x, *y = state->y, *u = state->vx, *w = state->vy;
  nodes q = {{x[0], x[1], x[2], x[3]}, {y[0], y[1], y[2], y[3]}, x[4], y[4]};
  nodes v = {{u[0], u[1], u[2], u[3]}, {w[0], w[1], w[2], w[3]}, u[4], w[4]};
  long long n = state->n, end = n + steps;
  const double half = 0.5 * dt, sixth = dt / 6.0, speed = 6.283185307179586 * f * a;
  double s, c, s_half, c_half;
  strut_sincos_turns(f * ((double)n * dt), &s, &c);
  for (; n < end; n++) {
    nodes a1, a2, a3, a4, q2, w2, w3, w4;
    strut_sincos_turns(f * (((double)n + 0.5) * dt), &s_half, &c_half);
    acceleration(&q, &v, a * s, speed * c, mu, &a1);
    add(&q, half, &v, &q2), add(&v, half, &a1, &w2);
    acceleration(&q2, &w2, a * s_half, speed * c_half, mu, &a2);
    add(&q, half, &w2, &q2), add(&v, half, &a2, &w3);
    acceleration(&q2, &w3, a * s_half, speed * c_half, mu, &a3);
    add(&q, dt, &w3, &q2), add(&v, dt, &a3, &w4);
    strut_sincos_turns(f * ((double)(n + 1) * dt), &s, &c);
    acceleration(&q2, &w4, a * s, speed * c, mu, &a4);
    add_mean(&q, sixth, &v, &w2, &w3, &w4);
    add_mean(&v, sixth, &a1, &a2, &a3, &a4);
  }
  *state = (hand_crawler_state){{q.x[0], q.x[1], q.x[2], q.x[3], q.x5},
                                {q.y[0], q.y[1], q.y[2], q.y[3], q.y5},
                                {v.x[0], v.x[1], v.x[2], v.x[3], v.x5},
                                {v.y[0], v.y[1], v.y[2], v.y[3], v.y5},
                                n};
}

void hand_crawler_run(hand_crawler_state *state, double dt, double f, double a, double mu,
                      long long steps) {
  run(state, dt, f, a, mu, steps);
}
