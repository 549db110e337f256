/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes of a scene whose effect is known without any oracle: other units, mirror, other order. */
#include "engine/integrate/limit/step_limit.h"
#include "tests/physics/random_scene.h"
#include "tests/support/random.h"
#include "tests/support/structures.h"
#include "tests/support/widening.h"

enum { RANDOM_SCENES = 60 };
static const double FACTOR = 1024;

/* Case 0 is the crawler, the others are random scenes; each gets an initial motion. */
static void make(strut_setup *setup, uint64_t number) {
  if (number == 0) {
    strut_setup_init(setup);
    structure_crawler(&setup->scene, 10, 1e-4, 0.1, false);
    return;
  }
  strut_setup_init(setup);
  random_scene(&setup->scene, number);
  double *q = calloc(4 * setup->scene.node_count, sizeof *q), *v = q + 2 * setup->scene.node_count,
         t;
  assert_non_null(q);
  random_motion(&setup->scene, number, &t, q, v);
  for (size_t i = 0; i < 2 * setup->scene.node_count; i++) {
    setup->scene.nodes[i / 2].start[i % 2] = q[i];
    setup->scene.nodes[i / 2].velocity[i % 2] = v[i];
  }
  free(q);
}

/* A power of two well below the step limit: the random scenes are stiffer than one another. */
static double stable_step(const strut_setup *setup) {
  strut_step_limit limit;
  OWN_POINTER(strut_model) model = motion_compile(&setup->scene);
  assert_ok(strut_step_limit_estimate(model, &limit, NULL));
  return exp2(floor(log2(0.3 * limit.limit)));
}

static motion run(const strut_setup *setup, const char *method, double step, int64_t steps) {
  motion m = motion_begin_by(setup, method, step);
  m.state->balance = true;
  motion_steps(&m, steps);
  for (size_t i = 0; i < 2 * setup->scene.node_count; i++) assert_true(isfinite(m.state->q[i]));
  return m;
}

static void scale_lengths(strut_setup *s, double by) {
  for (size_t i = 0; i < s->scene.node_count; i++)
    for (int c = 0; c < 2; c++) {
      s->scene.nodes[i].position[c] *= by;
      s->scene.nodes[i].start[c] *= by;
      s->scene.nodes[i].velocity[c] *= by;
    }
  for (size_t j = 0; j < s->scene.member_count; j++) {
    strut_member *m = &s->scene.members[j];
    m->axial_stiffness *= by;
    if (m->rest_kind == STRUT_REST_LENGTH || m->rest_kind == STRUT_REST_PRETENSION)
      m->rest_value *= by;
  }
  for (int c = 0; c < 2; c++) s->scene.gravity[c] *= by;
  s->scene.ground.height *= by, s->scene.ground.belt_speed *= by;
  for (size_t i = 0; i < s->scene.contact_count; i++)
    s->scene.contacts[i].friction.stick_velocity *= by;
  /* Strokes are lengths; loads on a signal take their factor from it, constant ones from here. */
  for (size_t i = 0; i < s->scene.signal_count; i++) {
    s->scene.signals[i].amplitude *= by;
    for (size_t k = 0; k < s->scene.signals[i].point_count; k++)
      ((double *)s->scene.signals[i].value)[k] *= by;
  }
  for (size_t i = 0; i < s->scene.load_count; i++)
    for (int c = 0; c < 2 && s->scene.loads[i].signal < 0; c++) s->scene.loads[i].force[c] *= by;
}

static void scale_masses(strut_setup *s, double by) {
  for (size_t i = 0; i < s->scene.node_count; i++) s->scene.nodes[i].mass *= by;
  for (size_t j = 0; j < s->scene.member_count; j++) {
    strut_member *m = &s->scene.members[j];
    m->stiffness *= by, m->axial_stiffness *= by, m->damping *= by, m->mass *= by;
    if (m->rest_kind == STRUT_REST_PRETENSION || m->rest_kind == STRUT_REST_FORCE_DENSITY)
      m->rest_value *= by;
  }
  for (size_t i = 0; i < s->scene.contact_count; i++)
    s->scene.contacts[i].stiffness *= by, s->scene.contacts[i].damping *= by;
  for (size_t i = 0; i < s->scene.load_count; i++)
    for (int c = 0; c < 2; c++) s->scene.loads[i].force[c] *= by;
}

/* Everything takes `by` times as long. */
static void scale_times(strut_setup *s, double by) {
  for (size_t i = 0; i < s->scene.node_count; i++)
    for (int c = 0; c < 2; c++) s->scene.nodes[i].velocity[c] /= by;
  for (size_t j = 0; j < s->scene.member_count; j++) {
    strut_member *m = &s->scene.members[j];
    m->stiffness /= by * by, m->axial_stiffness /= by * by, m->damping /= by;
    if (m->rest_kind == STRUT_REST_PRETENSION || m->rest_kind == STRUT_REST_FORCE_DENSITY)
      m->rest_value /= by * by;
  }
  for (int c = 0; c < 2; c++) s->scene.gravity[c] /= by * by;
  s->scene.ground.belt_speed /= by;
  for (size_t i = 0; i < s->scene.contact_count; i++) {
    strut_contact *c = &s->scene.contacts[i];
    c->stiffness /= by * by, c->damping /= by, c->friction.stick_velocity /= by;
  }
  for (size_t i = 0; i < s->scene.signal_count; i++) {
    strut_signal *signal = &s->scene.signals[i];
    signal->frequency /= by, signal->start *= by, signal->stop *= by;
    for (size_t k = 0; k < signal->point_count; k++) ((double *)signal->time)[k] *= by;
  }
  for (size_t i = 0; i < s->scene.load_count; i++)
    for (int c = 0; c < 2; c++) s->scene.loads[i].force[c] /= by * by;
}

static void mirror(strut_setup *s) {
  for (size_t i = 0; i < s->scene.node_count; i++) {
    s->scene.nodes[i].position[0] *= -1;
    s->scene.nodes[i].start[0] *= -1;
    s->scene.nodes[i].velocity[0] *= -1;
  }
  for (size_t i = 0; i < s->scene.load_count; i++) s->scene.loads[i].force[0] *= -1;
  s->scene.gravity[0] *= -1, s->scene.ground.slope *= -1, s->scene.ground.belt_speed *= -1;
}

/* What the changed scene's motion must be of the first one's, times these. */
typedef struct factors {
  double x, y, energy, time;
} factors;

static void compare_bits(const motion *a, const motion *b, size_t nodes, factors f) {
  for (size_t i = 0; i < 2 * nodes; i++) {
    double by = i % 2 ? f.y : f.x; /* adding 0 makes -0 the same as 0 */
    assert_same_bits(b->state->q[i] + 0.0, a->state->q[i] * by + 0.0);
    assert_same_bits(b->state->v[i] + 0.0, a->state->v[i] * (by / f.time) + 0.0);
  }
  for (int p = 0; p < STRUT_POWER_COUNT; p++)
    assert_same_bits(b->state->work[p] + 0.0, a->state->work[p] * f.energy + 0.0);
}

static void check_scene(void (*change)(strut_setup *), factors f, const char *method,
                        uint64_t number, int64_t steps) {
  strut_setup first, second;
  make(&first, number);
  make(&second, number);
  change(&second);
  double step = number ? stable_step(&first) : 1e-4;
  if (strcmp(method, "rk4") != 0) step /= 16; /* the least stable of them is half as stable */
  first.experiment.step = step, second.experiment.step = step * f.time;
  OWN(motion) a = run(&first, method, step, steps);
  OWN(motion) b = run(&second, method, step * f.time, steps);
  compare_bits(&a, &b, first.scene.node_count, f);
  strut_setup_free(&first);
  strut_setup_free(&second);
}

static void check_change(void (*change)(strut_setup *), factors f) {
  for (uint64_t number = 0; number <= RANDOM_SCENES; number++)
    check_scene(change, f, "rk4", number, number ? 500 : 20000);
}

/* The same by methods with events: switches fall on the same bits. */
static void check_events(void (*change)(strut_setup *), factors f) {
  static const char *const methods[] = {"rk4-events", "verlet-events", "euler-events"};
  for (int k = 0; k < 3; k++)
    for (uint64_t number = 0; number <= RANDOM_SCENES; number++)
      check_scene(change, f, methods[k], number, number ? 200 : 5000);
}

static void larger(strut_setup *setup) { scale_lengths(setup, FACTOR); }
static void smaller(strut_setup *setup) { scale_lengths(setup, 1 / FACTOR); }
static void heavier(strut_setup *setup) { scale_masses(setup, FACTOR); }
static void lighter(strut_setup *setup) { scale_masses(setup, 1 / FACTOR); }

TEST(other_lengths_scale_every_bit) {
  check_change(larger, (factors){FACTOR, FACTOR, FACTOR * FACTOR, 1});
  check_change(smaller, (factors){1 / FACTOR, 1 / FACTOR, 1 / (FACTOR * FACTOR), 1});
}

TEST(other_masses_scale_every_bit) {
  check_change(heavier, (factors){1, 1, FACTOR, 1});
  check_change(lighter, (factors){1, 1, 1 / FACTOR, 1});
}

static void slower(strut_setup *setup) { scale_times(setup, FACTOR); }
static void faster(strut_setup *setup) { scale_times(setup, 1 / FACTOR); }

TEST(other_times_scale_every_bit) {
  check_change(slower, (factors){1, 1, 1 / (FACTOR * FACTOR), FACTOR});
  check_change(faster, (factors){1, 1, FACTOR * FACTOR, 1 / FACTOR});
}

TEST(events_scale_with_lengths) {
  check_events(larger, (factors){FACTOR, FACTOR, FACTOR * FACTOR, 1});
}

TEST(events_scale_with_masses) { check_events(heavier, (factors){1, 1, FACTOR, 1}); }

TEST(events_scale_with_times) {
  check_events(slower, (factors){1, 1, 1 / (FACTOR * FACTOR), FACTOR});
}

TEST(the_mirror_image_moves_as_the_mirror_image) { check_change(mirror, (factors){-1, 1, 1, 1}); }

/* The same scene with nodes and members in another order: new_of[i] is where node i has gone. */
static void shuffle(const strut_setup *from, strut_setup *to, int32_t *new_of, uint64_t *r) {
  size_t n = from->scene.node_count, m = from->scene.member_count;
  FREED int32_t *place = calloc(m, sizeof *place);
  assert_non_null(place);
  for (size_t i = 0; i < n; i++) new_of[i] = (int32_t)i;
  for (size_t j = 0; j < m; j++) place[j] = (int32_t)j;
  for (size_t i = n - 1; i > 0; i--) {
    size_t k = (size_t)random_below(r, (int32_t)i + 1);
    int32_t other = new_of[k];
    new_of[k] = new_of[i], new_of[i] = other;
  }
  for (size_t j = m - 1; j > 0; j--) {
    size_t k = (size_t)random_below(r, (int32_t)j + 1);
    int32_t other = place[k];
    place[k] = place[j], place[j] = other;
  }
  for (size_t i = 0; i < n; i++) to->scene.nodes[new_of[i]] = from->scene.nodes[i];
  for (size_t j = 0; j < m; j++) {
    strut_member *member = &to->scene.members[place[j]];
    *member = from->scene.members[j];
    for (int e = 0; e < 2; e++) member->node[e] = new_of[member->node[e]];
  }
  for (size_t i = 0; i < from->scene.actuator_count; i++)
    to->scene.actuators[i].member = place[from->scene.actuators[i].member];
  for (size_t i = 0; i < from->scene.load_count; i++)
    to->scene.loads[i].node = new_of[from->scene.loads[i].node];
  size_t count = 0;
  for (int32_t node = 0; node < (int32_t)n; node++)
    for (size_t i = 0; i < from->scene.contact_count; i++) {
      if (new_of[from->scene.contacts[i].node] != node) continue;
      to->scene.contacts[count] = from->scene.contacts[i];
      to->scene.contacts[count++].node = node;
    }
}

TEST(another_order_agrees_to_rounding) {
  uint64_t r = 7;
  for (uint64_t number = 0; number <= RANDOM_SCENES; number++) {
    OWN(strut_setup) first, second;
    make(&first, number);
    make(&second, number);
    FREED int32_t *new_of = calloc(first.scene.node_count, sizeof *new_of);
    assert_non_null(new_of);
    shuffle(&first, &second, new_of, &r);
    double step = number ? stable_step(&first) : 1e-4;
    OWN(motion) a = run(&first, "rk4", step, 100);
    OWN(motion) b = run(&second, "rk4", step, 100);
    double length = 0, speed = 0;
    for (size_t i = 0; i < 2 * first.scene.node_count; i++) {
      length = fmax(length, fabs(a.state->q[i]));
      speed = fmax(speed, fabs(a.state->v[i]));
    }
    for (size_t i = 0; i < 2 * first.scene.node_count; i++) {
      size_t k = 2 * (size_t)new_of[i / 2] + i % 2;
      assert_near(b.state->q[k], a.state->q[i], 1e-12 * length);
      assert_near(b.state->v[k], a.state->v[i], 1e-10 * speed);
    }
  }
}

/* sin(2 pi f t) in long double, t itself as the engine must have it: n dt. */
static double drive(double frequency, double step, double n) {
  long double turns = (long double)frequency * (n * step);
  return (double)sinl(2 * acosl(-1) * (turns - floorl(turns)));
}

/* One step after a million periods, none of which was a whole number of steps. */
TEST(a_drive_does_not_drift) {
  const double frequency = 7.3, step = 1e-4, n = 1369863014; /* 1e6 periods and a little */
  OWN(strut_setup) setup = build_setup();
  build_mass(&setup.scene, 0, 0, 1);
  build_load(&setup.scene, 0, 1, 0, build_sine(&setup.scene, 1, frequency));
  OWN(motion) m = motion_begin(&setup.scene, step);
  m.state->step = (int64_t)n;
  motion_steps(&m, 1);
  double expected = drive(frequency, step, n) + 4 * drive(frequency, step, n + 0.5) +
                    drive(frequency, step, n + 1);
  assert_near(m.state->v[0], expected * step / 6, 1e-9 * step);
  assert_int_equal(m.state->step, (int64_t)n + 1);
}
