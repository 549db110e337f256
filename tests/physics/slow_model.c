/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/physics/slow_model.h"

#include "tests/support/check.h"

static long double *zeros(size_t count) {
  long double *block = calloc(count ? count : 1, sizeof *block);
  assert_non_null(block);
  return block;
}

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

void slow_signal(const strut_scene *scene, int32_t signal, long double t, long double *value,
                 long double *rate) {
  const strut_signal *s = &scene->signals[signal];
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
  } else if (s->kind == STRUT_SUM) {
    for (size_t i = 0; i < s->term_count && on; i++) {
      long double part, part_rate;
      slow_signal(scene, s->terms[i], t, &part, &part_rate);
      *value += part, *rate += part_rate;
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

/* EA over the present rest length, down to a millionth of that at the start. */
static long double slow_axial(const strut_member *m, long double start, long double present) {
  return m->axial_stiffness / fmaxl(present, 1e-6L * start);
}

/* (1), (2), (6): the pull between the two ends of member j. */
static void add_member(slow_model *slow, const strut_scene *scene, size_t j, double t,
                       const double *q, const double *v) {
  const strut_member *m = &scene->members[j];
  size_t a = 2 * (size_t)m->node[0], b = 2 * (size_t)m->node[1];
  long double x = (long double)q[b] - q[a], y = (long double)q[b + 1] - q[a + 1];
  long double vx = (long double)v[b] - v[a], vy = (long double)v[b + 1] - v[a + 1];
  long double length = hypotl(x, y), rate = (vx * x + vy * y) / length;
  long double rest, stiffness, s = 0, s_rate = 0;
  slow_member_rest(scene, m, &rest, &stiffness);
  for (size_t i = 0; i < scene->actuator_count; i++) {
    if (scene->actuators[i].member != (int32_t)j) continue;
    long double value, value_rate;
    slow_signal(scene, scene->actuators[i].signal, t, &value, &value_rate);
    s += value, s_rate += value_rate;
  }
  bool axial = m->axial_stiffness > 0, slack = m->kind == STRUT_CABLE && length <= rest + s;
  if (axial) stiffness = slow_axial(m, rest, rest + s);
  long double elastic = stiffness * (length - rest - s), tension = elastic;
  tension += m->damping * (rate - s_rate);
  if (axial && !slack && rest + s > 1e-6L * rest) /* EA x^2 / (2 L0) also falls as L0 grows */
    slow->drive -= 0.5L * elastic * (length - rest - s) / (rest + s) * s_rate;
  if (slack) elastic = tension = 0;
  if (m->kind == STRUT_CABLE && tension < 0) tension = 0;
  long double pull[2] = {tension * x / length, tension * y / length};
  for (size_t c = 0; c < 2; c++) slow->force[a + c] += pull[c], slow->force[b + c] -= pull[c];
  slow->tension[j] = tension;
  slow->drive -= tension * s_rate;
  slow->members += (tension - elastic) * (rate - s_rate);
}

/* (7) and the loads. */
static void add_loads(slow_model *slow, const strut_scene *scene, double t, const double *v) {
  for (size_t i = 0; i < scene->node_count; i++)
    for (size_t c = 0; c < 2; c++)
      slow->force[2 * i + c] += (long double)scene->nodes[i].mass * scene->gravity[c];
  for (size_t j = 0; j < scene->member_count; j++)
    for (size_t end = 0; end < 2; end++)
      for (size_t c = 0; c < 2; c++)
        slow->force[2 * (size_t)scene->members[j].node[end] + c] +=
            0.5L * scene->members[j].mass * scene->gravity[c];
  for (size_t i = 0; i < scene->load_count; i++) {
    const strut_load *load = &scene->loads[i];
    long double factor = 1, rate;
    if (load->signal >= 0) slow_signal(scene, load->signal, t, &factor, &rate);
    for (size_t c = 0; c < 2; c++) {
      size_t at = 2 * (size_t)load->node + c;
      slow->force[at] += factor * load->force[c];
      if (load->signal >= 0) slow->load += factor * load->force[c] * v[at];
    }
  }
}

/* (8) and (9) in the ground's own axes, after every other force on the node. */
static void add_contact(slow_model *slow, const strut_scene *scene, size_t i, const double *q,
                        const double *v) {
  const strut_contact *c = &scene->contacts[i];
  const strut_ground *ground = &scene->ground;
  size_t at = 2 * (size_t)c->node;
  long double cosine = cosl(ground->slope), sine = sinl(ground->slope);
  long double *f = slow->force + at;
  long double depth = -((q[at + 1] - (long double)ground->height) * cosine - q[at] * sine);
  if (depth <= 0) return;
  long double up = v[at + 1] * cosine - v[at] * sine;
  long double slip = v[at] * cosine + v[at + 1] * sine - ground->belt_speed;
  long double normal = c->stiffness * depth, rub = 0;
  if (up < 0) normal += c->damping * -up, slow->contact += c->damping * up * up;
  if (c->friction.law == STRUT_FRICTION_KARNOPP) {
    long double others = f[0] * cosine + f[1] * sine;
    bool sliding = fabsl(slip) >= c->friction.stick_velocity;
    bool breaking = fabsl(others) >= c->friction.mu_static * normal;
    long double against = sliding ? slip : others;
    rub = sliding || breaking ? -copysignl(c->friction.mu_kinetic * normal, against) : -others;
  }
  f[0] += rub * cosine - normal * sine;
  f[1] += rub * sine + normal * cosine;
  slow->normal[i] = normal, slow->friction[i] = rub;
  slow->rubbed -= rub * slip, slow->belt += rub * ground->belt_speed;
}

static void assemble_mass(slow_model *slow, const strut_scene *scene) {
  size_t n = slow->n;
  long double own = scene->mass_model == STRUT_MASS_LUMPED ? 0.5L : 1.0L / 3;
  long double shared = scene->mass_model == STRUT_MASS_LUMPED ? 0 : 1.0L / 6;
  for (size_t c = 0; c < 2; c++) {
    for (size_t i = 0; i < scene->node_count; i++)
      slow->mass[(2 * i + c) * n + 2 * i + c] += scene->nodes[i].mass;
    for (size_t j = 0; j < scene->member_count; j++) {
      const strut_member *m = &scene->members[j];
      size_t a = 2 * (size_t)m->node[0] + c, b = 2 * (size_t)m->node[1] + c;
      slow->mass[a * n + a] += own * m->mass, slow->mass[b * n + b] += own * m->mass;
      slow->mass[a * n + b] += shared * m->mass, slow->mass[b * n + a] += shared * m->mass;
    }
  }
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

/* M a = F of the free coordinates. */
static void solve(slow_model *slow, const strut_scene *scene) {
  size_t n = slow->n, width = n + 1;
  long double *a = zeros(n * width);
  for (size_t i = 0; i < n; i++) {
    bool fixed_row = scene->nodes[i / 2].fixed[i % 2];
    for (size_t j = 0; j < n; j++) {
      bool fixed = fixed_row || scene->nodes[j / 2].fixed[j % 2];
      a[i * width + j] = fixed ? i == j : slow->mass[i * n + j];
    }
    a[i * width + n] = fixed_row ? 0 : slow->force[i];
  }
  slow_solve(a, n, slow->acceleration);
  free(a);
}

void slow_evaluate(slow_model *slow, const strut_scene *scene, double t, const double *q,
                   const double *v) {
  size_t n = 2 * scene->node_count;
  *slow = (slow_model){.n = n};
  slow->mass = zeros(n * n), slow->force = zeros(n), slow->acceleration = zeros(n);
  slow->tension = zeros(scene->member_count);
  slow->normal = zeros(scene->contact_count), slow->friction = zeros(scene->contact_count);
  for (size_t j = 0; j < scene->member_count; j++) add_member(slow, scene, j, t, q, v);
  add_loads(slow, scene, t, v);
  for (size_t i = 0; i < scene->contact_count; i++) add_contact(slow, scene, i, q, v);
  assemble_mass(slow, scene);
  solve(slow, scene);
}

void slow_free(slow_model *slow) {
  free(slow->mass);
  free(slow->force);
  free(slow->acceleration);
  free(slow->tension);
  free(slow->normal);
  free(slow->friction);
}

double slow_largest(const long double *x, size_t n) {
  long double most = 0;
  for (size_t i = 0; i < n; i++) most = fmaxl(most, fabsl(x[i]));
  return (double)most;
}
