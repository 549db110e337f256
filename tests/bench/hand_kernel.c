/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The crawler by hand, the way one would write it down: one scalar variable for each coordinate,
 * one line for each member, no loops.
 */
#include "tests/bench/hand_kernel.h"

#include <math.h>

#include "engine/base/vec.h"
#include "engine/model/algebra/hot.h"

/* Table 1, and the inverse of the consistent mass: blocks of nodes (1, 2) and (3, 4, 5). */
#define C_BAR 1e6
#define C_SOFT 3000.0
#define C_STRONG 1e4
#define K 0.2
#define W_LONG 40.0
#define W_LONG_OFF -20.0
#define W_SHORT 175.0
#define W_SHORT_OFF 25.0
#define W_SHORT_5 -50.0
#define W_5 100.0
#define G_1 (-0.5 * 9.81 * 0.1)
#define G_3 (-0.5 * 9.81 * 0.02)
#define G_5 (-0.5 * 9.81 * 0.04)
#define C_GROUND 1e5
#define K_GROUND 100.0
#define STICK 1e-4

typedef struct nodes {
  double x1, x2, x3, x4, x5, y1, y2, y3, y4, y5;
} nodes;

typedef struct pull {
  double x, y;
} pull;

/* (1), (2), (6): what the member pulls node i1 with; shift and rate are of the drive. */
STRUT_INLINE pull member(double dx, double dy, double vx, double vy, double c, double rest,
                         double rate) {
  double inverse = 1.0 / sqrt(dx * dx + dy * dy);
  double along = (vx * dx + vy * dy) * inverse - rate;
  double density = (c - c * rest * inverse) + K * along * inverse;
  return (pull){density * dx, density * dy};
}

/* (8), (9): adds the contact of a node to its force. */
STRUT_INLINE void contact(double y, double vx, double vy, double mu, double *fx, double *fy) {
  if (y >= 0) return;
  double normal = vy >= 0 ? -C_GROUND * y : -C_GROUND * y - K_GROUND * vy, limit = mu * normal;
  double resultant = *fx;
  *fy += normal;
  if (fabs(vx) >= STICK)
    *fx = resultant - copysign(limit, vx);
  else if (fabs(resultant) >= limit)
    *fx = resultant - (resultant > 0 ? limit : resultant < 0 ? -limit : 0.0);
  else
    *fx = 0.0;
}

/* (10) */
STRUT_INLINE void acceleration(const nodes *q, const nodes *v, double s, double rate, double mu,
                               nodes *out) {
#define MEMBER(i1, i2, c, rest, speed)                                                             \
  member(q->x##i2 - q->x##i1, q->y##i2 - q->y##i1, v->x##i2 - v->x##i1, v->y##i2 - v->y##i1, c,    \
         rest, speed)
  pull m1 = MEMBER(1, 2, C_BAR, 0.10, 0.0), m2 = MEMBER(3, 5, C_BAR, 0.02, 0.0);
  pull m3 = MEMBER(4, 5, C_BAR, 0.02, 0.0), m4 = MEMBER(1, 3, C_SOFT, 0.02, 0.0);
  pull m5 = MEMBER(2, 3, C_SOFT, 0.02, 0.0), m6 = MEMBER(2, 4, C_SOFT, 0.02, 0.0);
  pull m7 = MEMBER(1, 4, C_SOFT, 0.02, 0.0), m8 = MEMBER(1, 5, C_STRONG, 0.01 + s, rate);
  pull m9 = MEMBER(2, 5, C_STRONG, 0.01, 0.0);
#undef MEMBER
  double f1 = m1.x + m4.x + m7.x + m8.x, g1 = m1.y + m4.y + m7.y + m8.y + G_1;
  double f2 = m5.x + m6.x + m9.x - m1.x, g2 = m5.y + m6.y + m9.y - m1.y + G_1;
  double f3 = m2.x - m4.x - m5.x, g3 = m2.y - m4.y - m5.y + G_3;
  double f4 = m3.x - m6.x - m7.x, g4 = m3.y - m6.y - m7.y + G_3;
  double f5 = -(m2.x + m3.x) - (m8.x + m9.x), g5 = G_5 - (m2.y + m3.y) - (m8.y + m9.y);
  contact(q->y1, v->x1, v->y1, mu, &f1, &g1);
  contact(q->y2, v->x2, v->y2, mu, &f2, &g2);
  contact(q->y3, v->x3, v->y3, mu, &f3, &g3);
  contact(q->y4, v->x4, v->y4, mu, &f4, &g4);
  contact(q->y5, v->x5, v->y5, mu, &f5, &g5);
  out->x1 = W_LONG * f1 + W_LONG_OFF * f2, out->x2 = W_LONG_OFF * f1 + W_LONG * f2;
  out->y1 = W_LONG * g1 + W_LONG_OFF * g2, out->y2 = W_LONG_OFF * g1 + W_LONG * g2;
  out->x3 = W_SHORT * f3 + W_SHORT_OFF * f4 + W_SHORT_5 * f5;
  out->y3 = W_SHORT * g3 + W_SHORT_OFF * g4 + W_SHORT_5 * g5;
  out->x4 = W_SHORT_OFF * f3 + W_SHORT * f4 + W_SHORT_5 * f5;
  out->y4 = W_SHORT_OFF * g3 + W_SHORT * g4 + W_SHORT_5 * g5;
  out->x5 = W_SHORT_5 * (f3 + f4) + W_5 * f5;
  out->y5 = W_SHORT_5 * (g3 + g4) + W_5 * g5;
}

#define EACH(X) X(x1) X(x2) X(x3) X(x4) X(x5) X(y1) X(y2) X(y3) X(y4) X(y5)

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

/* No clones for wider registers: there is nothing here to put into them, and gcc 12's are slower. */
double hand_crawler_run(long long steps) {
  const double dt = 1e-4, f = 10.0, a = 1e-4, mu = 0.1;
  const double half = 0.5 * dt, sixth = dt / 6.0, speed = 6.283185307179586 * f * a;
  nodes q = {0, 0.0965109, 0.0526668, 0.0602933, 0.0434758, 0, 0.0238714, 0.0283691, 0, 0.0106875};
  nodes v = {0};
  double s = 0.0, c = 1.0, s_half, c_half;
  for (long long n = 0; n < steps; n++) {
    nodes a1, a2, a3, a4, q2, v2, v3, v4;
    strut_sincos_turns(f * (((double)n + 0.5) * dt), &s_half, &c_half);
    acceleration(&q, &v, a * s, speed * c, mu, &a1);
    add(&q, half, &v, &q2), add(&v, half, &a1, &v2);
    acceleration(&q2, &v2, a * s_half, speed * c_half, mu, &a2);
    add(&q, half, &v2, &q2), add(&v, half, &a2, &v3);
    acceleration(&q2, &v3, a * s_half, speed * c_half, mu, &a3);
    add(&q, dt, &v3, &q2), add(&v, dt, &a3, &v4);
    strut_sincos_turns(f * ((double)(n + 1) * dt), &s, &c);
    acceleration(&q2, &v4, a * s, speed * c, mu, &a4);
    add_mean(&q, sixth, &v, &v2, &v3, &v4);
    add_mean(&v, sixth, &a1, &a2, &a3, &a4);
  }
  return q.x1;
}
