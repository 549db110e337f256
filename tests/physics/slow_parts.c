/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Signals of the time alone, rest lengths, linear equations. */
#include "tests/physics/slow_world.h"

/* The waveform of one kind at tau = t - start, were it not for its stop. */
static void waveform(const strut_signal *s, long double tau, long double *value,
                     long double *rate) {
  long double omega = 2 * acosl(-1) * s->frequency, cycles = tau * s->frequency + s->phase;
  long double angle = 2 * acosl(-1) * cycles;
  switch (s->kind) {
    case STRUT_CONSTANT: *value = s->amplitude; break;
    case STRUT_SQUARE:
      *value = cycles - floorl(cycles) < 0.5L ? s->amplitude : -s->amplitude;
      break;
    case STRUT_HALF_SINE:
      if (cycles >= 0.5L) break;
      *value = s->amplitude * sinl(angle), *rate = s->amplitude * omega * cosl(angle);
      break;
    default: *value = s->amplitude * sinl(angle), *rate = s->amplitude * omega * cosl(angle);
  }
}

void slow_signal(const strut_signal *s, long double t, long double *value, long double *rate) {
  bool on = t >= s->start && t < s->stop;
  *value = *rate = 0;
  if (s->kind == STRUT_RAMP) {
    long double span = (long double)s->stop - s->start;
    *value = t < s->start ? 0 : on ? s->amplitude * (t - s->start) / span : s->amplitude;
    *rate = on ? s->amplitude / span : 0;
  } else if (s->kind == STRUT_TABLE) {
    size_t last = s->point_count - 1;
    *value = t < s->time[0] ? s->value[0] : s->value[last];
    for (size_t i = 0; i < last; i++) {
      if (t < s->time[i] || t >= s->time[i + 1]) continue;
      *rate =
          ((long double)s->value[i + 1] - s->value[i]) / ((long double)s->time[i + 1] - s->time[i]);
      *value = s->value[i] + *rate * (t - s->time[i]);
    }
  } else if (on) {
    waveform(s, t - s->start, value, rate);
  }
}

void slow_member_rest(const strut_scene *scene, const strut_member *m, long double *rest,
                      long double *stiffness) {
  long double drawn = 0;
  for (size_t k = 0; k <= m->guide_count; k++) {
    const double *a = scene->nodes[k ? m->guides[k - 1] : m->node[0]].position;
    const double *b = scene->nodes[k < m->guide_count ? m->guides[k] : m->node[1]].position;
    drawn += hypotl((long double)b[0] - a[0], (long double)b[1] - a[1]);
  }
  long double force = m->rest_value, ea = m->axial_stiffness;
  if (m->rest_kind == STRUT_REST_FORCE_DENSITY) force *= drawn;
  if (m->rest_kind == STRUT_REST_LENGTH)
    *rest = m->rest_value;
  else if (m->rest_kind == STRUT_REST_RATIO)
    *rest = m->rest_value * drawn;
  else if (ea > 0) /* force = EA (drawn - rest) / rest */
    *rest = drawn / (1 + force / ea);
  else
    *rest = force == 0 ? drawn : drawn - force / m->stiffness;
  *stiffness = ea > 0 ? ea / *rest : m->stiffness;
}

/* By Gauss elimination with row exchanges. */
void slow_solve(long double *a, size_t n, long double *x) {
  size_t width = n + 1;
  for (size_t p = 0; p < n; p++) {
    size_t best = p;
    for (size_t i = p + 1; i < n; i++)
      if (fabsl(a[i * width + p]) > fabsl(a[best * width + p])) best = i;
    for (size_t j = 0; j < width; j++) {
      long double other = a[best * width + j];
      a[best * width + j] = a[p * width + j], a[p * width + j] = other;
    }
    for (size_t i = 0; i < n; i++) {
      if (i == p || a[i * width + p] == 0) continue;
      long double factor = a[i * width + p] / a[p * width + p];
      for (size_t j = p; j < width; j++) a[i * width + j] -= factor * a[p * width + j];
    }
  }
  for (size_t i = 0; i < n; i++) x[i] = a[i * width + n] / a[i * width + i];
}

double slow_largest(const long double *x, size_t n) {
  long double most = 0;
  for (size_t i = 0; i < n; i++) most = fmaxl(most, fabsl(x[i]));
  return (double)most;
}
