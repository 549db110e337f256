/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Changes of a scene whose effect is known without any oracle: other units, turned, mirror, other order; of random
 * scenes, and of those with cells, collisions, grounds of every shape and elements that remember.
 */
#include "engine/forces/history.h"
#include "engine/integrate/limit/step_limit.h"
#include "engine/scene/profile.h"
#include "tests/models/run_model.h"
#include "tests/physics/random_scene.h"
#include "tests/physics/random_world.h"
#include "tests/support/random.h"
#include "tests/support/structures.h"
#include "tests/support/widening.h"

enum { RANDOM_SCENES = 60, WORLD_STEPS = 120 };
static uint64_t worlds = 12; /* of each kind; more of them: test_invariance WORLDS */
static const double TURN = 0.7, WORLD_STEP = 1e-3;

BEFORE_ALL { worlds = (uint64_t)test_number(1, (double)worlds); }

/* ---- other units ---- */

/* Lengths, masses and times become larger by these powers of two, which keeps every bit of a motion. */
typedef struct units {
  int length, mass, time;
} units;

static int force_of(units by) { return by.length + by.mass - 2 * by.time; }
static int energy_of(units by) { return force_of(by) + by.length; }

static void scale(double *x, size_t count, int power) {
  for (size_t i = 0; i < count; i++) x[i] = ldexp(x[i], power);
}
#define SCALE(power, ...)                                                                          \
  for (double *all[] = {__VA_ARGS__, NULL}, **x = all; *x; x++) scale(*x, 1, power)

/* By powers of its strain and of its force. */
static void scale_law(strut_scene *scene, strut_law *law, int strain, int force) {
  double *c = (double *)build_numbers(scene, law->force, law->count);
  SCALE(strain, &law->knee, &law->gap, &law->scale);
  SCALE(force, &law->yield);
  SCALE(force - strain, &law->second_stiffness);
  for (size_t k = 0; k < law->count; k++) SCALE(force - ((int)k + 1) * strain, &c[k]);
  if (law->kind == STRUT_LAW_POLYNOMIAL) law->force = c;
}

static void scale_elements(strut_scene *s, units by) {
  const int length = by.length, force = force_of(by), energy = energy_of(by);
  const int stiffness = force - length, damping = stiffness + by.time;
  const int rest[] = {[STRUT_REST_LENGTH] = length,
                      [STRUT_REST_PRETENSION] = force,
                      [STRUT_REST_FORCE_DENSITY] = stiffness};
  for (strut_member *m = s->members; m < s->members + s->member_count; m++) {
    SCALE(length, &m->longest, &m->shortest);
    SCALE(force, &m->axial_stiffness, &m->breaks_at);
    SCALE(stiffness, &m->stiffness, &m->stop_stiffness);
    SCALE(damping, &m->damping, &m->stop_damping);
    SCALE(by.mass, &m->mass);
    SCALE(by.time, &m->released_at);
    if (m->rest_kind != STRUT_REST_RATIO) SCALE(rest[m->rest_kind], &m->rest_value);
    scale_law(s, &m->law, length, force);
  }
  for (strut_hinge *h = s->hinges; h < s->hinges + s->hinge_count; h++) {
    SCALE(energy, &h->stiffness, &h->breaks_at);
    SCALE(energy + by.time, &h->damping);
    scale_law(s, &h->law, 0, energy);
  }
  for (strut_cell *c = s->cells; c < s->cells + s->cell_count; c++) { /* pressures are N/m */
    SCALE(stiffness, &c->pressure, &c->outside);
    SCALE(stiffness - 2 * length, &c->stiffness);
    SCALE(damping - 2 * length, &c->damping);
    SCALE(2 * length, &c->rest_area);
    scale_law(s, &c->elastic, 2 * length, stiffness);
  }
  for (strut_collision *c = s->collisions; c < s->collisions + s->collision_count; c++) {
    SCALE(length, &c->thickness);
    SCALE(stiffness, &c->stiffness);
    SCALE(damping, &c->damping);
  }
  for (strut_distance_spring *d = s->distances; d < s->distances + s->distance_count; d++) {
    SCALE(length, &d->rest_distance);
    SCALE(stiffness, &d->stiffness);
    SCALE(damping, &d->damping);
    scale_law(s, &d->law, length, force);
  }
}

static void scale_grounds(strut_scene *s, units by) {
  const int speed = by.length - by.time, stiffness = force_of(by) - by.length;
  SCALE(by.length, &s->ground.height);
  SCALE(speed, &s->ground.belt_speed);
  for (strut_ground *g = s->grounds; g < s->grounds + s->ground_count; g++) {
    SCALE(by.length, &g->height, &g->radius);
    SCALE(speed, &g->belt_speed);
    scale(g->through, 2, by.length), scale(g->centre, 2, by.length);
    scale((double *)g->points, 2 * g->point_count, by.length);
  }
  for (strut_contact *c = s->contacts; c < s->contacts + s->contact_count; c++) {
    strut_friction *f = &c->friction;
    SCALE(stiffness, &c->stiffness);
    SCALE(stiffness + by.time, &c->damping);
    SCALE(-speed, &c->dissipation);
    SCALE(speed, &f->stick_velocity, &f->width, &f->decay_velocity);
  }
}

/* Signals are lengths or, of cells, pressures. Loads on one take their length from it. */
static void scale_drives(strut_scene *s, units by) {
  const int force = force_of(by);
  for (size_t i = 0; i < s->signal_count; i++) {
    strut_signal *signal = &s->signals[i];
    int power = by.length;
    for (strut_actuator *a = s->actuators; a < s->actuators + s->actuator_count; a++)
      if (a->signal == (int32_t)i && a->member < 0) power = force - by.length;
    SCALE(power, &signal->amplitude);
    SCALE(by.time, &signal->start, &signal->stop);
    SCALE(-by.time, &signal->frequency);
    scale((double *)signal->value, signal->point_count, power);
    scale((double *)signal->time, signal->point_count, by.time);
  }
  for (strut_load *l = s->loads; l < s->loads + s->load_count; l++)
    scale(l->force, 2, l->signal < 0 ? force : force - by.length);
}

static void change_units(strut_scene *s, units by) {
  const int speed = by.length - by.time;
  for (strut_node *n = s->nodes; n < s->nodes + s->node_count; n++) {
    scale(n->position, 2, by.length), scale(n->start, 2, by.length), scale(n->velocity, 2, speed);
    SCALE(by.mass, &n->mass);
  }
  scale(s->gravity, 2, speed - by.time);
  scale_elements(s, by);
  scale_grounds(s, by);
  scale_drives(s, by);
}

/* ---- turned, and in the mirror ---- */

static void turn_point(double *p) {
  double x = p[0], y = p[1];
  p[0] = cos(TURN) * x - sin(TURN) * y, p[1] = sin(TURN) * x + cos(TURN) * y;
}

static void mirror_point(double *p) { p[0] = -p[0]; }

static void move_points(strut_scene *scene, void move(double *)) {
  for (size_t i = 0; i < scene->node_count; i++) {
    move(scene->nodes[i].position);
    move(scene->nodes[i].start);
    move(scene->nodes[i].velocity);
  }
  for (size_t i = 0; i < scene->load_count; i++) move(scene->loads[i].force);
  move(scene->gravity);
  for (size_t i = 0; i < scene->ground_count; i++) {
    strut_ground *g = &scene->grounds[i];
    if (!g->placed) g->through[0] = 0, g->through[1] = g->height;
    g->placed = g->shape == STRUT_GROUND_LINE;
    move(g->through);
    move(g->centre);
    for (size_t k = 0; k < g->point_count; k++) move(g->points[k]);
  }
}

static void turn(strut_scene *scene) {
  move_points(scene, turn_point);
  for (size_t i = 0; i < scene->distance_count; i++) scene->distances[i].along += TURN;
  for (size_t i = 0; i < scene->ground_count; i++) scene->grounds[i].slope += TURN;
}

static void swap(double *a, double *b) {
  double keep = *a;
  *a = *b, *b = keep;
}

/* The solid stays to the right of a profile, and pieces are counted from its other end. */
static void mirror_ground(strut_scene *scene, size_t index) {
  strut_ground *g = &scene->grounds[index];
  int32_t last = (int32_t)strut_ground_pieces(g) - 1;
  g->slope = -g->slope, g->belt_speed = -g->belt_speed;
  for (size_t k = 0; k < g->point_count / 2; k++)
    for (int c = 0; c < 2; c++) swap(&g->points[k][c], &g->points[g->point_count - 1 - k][c]);
  for (size_t i = 0; i < scene->contact_count; i++) {
    strut_contact *c = &scene->contacts[i];
    if (c->ground != (int32_t)index) continue;
    c->piece = last - c->piece;
    if (!c->friction.directional) continue;
    swap(&c->friction.mu_static, &c->friction.mu_static_backward);
    swap(&c->friction.mu_kinetic, &c->friction.mu_kinetic_backward);
  }
}

static int by_place(const void *a, const void *b) {
  const strut_contact *x = a, *y = b;
  if (x->node != y->node) return x->node < y->node ? -1 : 1;
  if (x->ground != y->ground) return x->ground < y->ground ? -1 : 1;
  return x->piece < y->piece ? -1 : x->piece > y->piece;
}

/* What is ahead stays ahead; what was left of a line is right of it, so that the line runs the other way. */
static void mirror_distance(strut_distance_spring *d) {
  int32_t first = d->line[0];
  d->along = acos(-1) - d->along;
  d->line[0] = d->line[1], d->line[1] = first;
}

static void mirror(strut_scene *scene) {
  for (size_t i = 0; i < scene->distance_count; i++) mirror_distance(&scene->distances[i]);
  for (size_t i = 0; i < scene->ground_count; i++) mirror_ground(scene, i);
  scene->ground.slope *= -1, scene->ground.belt_speed *= -1;
  if (scene->contact_count)
    qsort(scene->contacts, scene->contact_count, sizeof *scene->contacts, by_place);
  for (size_t i = 0; i < scene->hinge_count; i++) {
    strut_hinge *h = &scene->hinges[i];
    double *c = (double *)build_numbers(scene, h->law.force, h->law.count);
    if (!isnan(h->rest_angle)) h->rest_angle = -h->rest_angle;
    for (size_t k = 0; k < h->law.count; k++) c[k] *= k % 2 ? -1 : 1;
    if (h->law.kind == STRUT_LAW_POLYNOMIAL) h->law.force = c;
  }
  move_points(scene, mirror_point);
}

/* ---- motions of a scene and of the changed one ---- */

static motion run(strut_setup *setup, const char *method, double step, int64_t steps) {
  setup->experiment.step = step;
  motion m = motion_begin_by(setup, method, step);
  m.state->balance = true;
  strut_history_begin(m.model, m.state, 0);
  motion_steps(&m, steps);
  return m;
}

/* Adding 0 makes -0 the same as 0. */
static void compare_bits(const motion *a, const motion *b, bool mirrored, units by) {
  for (int32_t i = 0; i < 2 * a->model->node_count; i++) {
    double q = a->state->q[i], v = a->state->v[i], sign = mirrored && i % 2 == 0 ? -1 : 1;
    assert_same_bits(b->state->q[i] + 0.0, sign * ldexp(q, by.length) + 0.0);
    assert_same_bits(b->state->v[i] + 0.0, sign * ldexp(v, by.length - by.time) + 0.0);
  }
}

/* Case 0 is the crawler, the others are random scenes; each gets an initial motion. */
static strut_setup make(uint64_t number) {
  strut_setup setup = build_setup();
  if (number == 0) {
    structure_crawler(&setup.scene, 10, 1e-4, 0.1, false);
    return setup;
  }
  random_scene(&setup.scene, number);
  double *q = calloc(4 * setup.scene.node_count, sizeof *q), *v = q + 2 * setup.scene.node_count, t;
  assert_non_null(q);
  random_motion(&setup.scene, number, &t, q, v);
  for (size_t i = 0; i < 2 * setup.scene.node_count; i++) {
    setup.scene.nodes[i / 2].start[i % 2] = q[i];
    setup.scene.nodes[i / 2].velocity[i % 2] = v[i];
  }
  return setup;
}

/* A power of two well below the step limit: the random scenes are stiffer than one another. */
static double stable_step(const strut_setup *setup) {
  strut_step_limit limit;
  OWN_POINTER(strut_model) model = motion_compile(&setup->scene);
  assert_ok(strut_step_limit_estimate(model, &limit, NULL));
  return exp2(floor(log2(0.3 * limit.limit)));
}

static void check_scene(bool mirrored, units by, const char *method, uint64_t number,
                        int64_t steps) {
  OWN(strut_setup) first = make(number), second = make(number);
  if (mirrored) mirror(&second.scene);
  change_units(&second.scene, by);
  double step = number ? stable_step(&first) : 1e-4;
  if (strcmp(method, "rk4") != 0) step /= 16; /* the least stable of them is half as stable */
  OWN(motion) a = run(&first, method, step, steps);
  OWN(motion) b = run(&second, method, ldexp(step, by.time), steps);
  for (size_t i = 0; i < 2 * first.scene.node_count; i++) assert_true(isfinite(a.state->q[i]));
  compare_bits(&a, &b, mirrored, by);
  for (int p = 0; p < STRUT_POWER_COUNT; p++)
    assert_same_bits(b.state->work[p] + 0.0, ldexp(a.state->work[p], energy_of(by)) + 0.0);
}

TEST(other_units_scale_every_bit) {
  static const units all[] = {{.length = 10}, {.length = -10}, {.mass = 10},
                              {.mass = -10},  {.time = 10},    {.time = -10}};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    for (uint64_t number = 0; number <= RANDOM_SCENES; number++)
      check_scene(false, all[i], "rk4", number, number ? 500 : 20000);
}

/* The same by methods with events: switches fall on the same bits. */
TEST(events_scale_with_units) {
  static const units all[] = {{.length = 10}, {.mass = 10}, {.time = 10}};
  static const char *const methods[] = {"rk4-events", "verlet-events", "euler-events"};
  for (int i = 0; i < 9; i++)
    for (uint64_t number = 0; number <= RANDOM_SCENES; number++)
      check_scene(false, all[i / 3], methods[i % 3], number, number ? 200 : 5000);
}

TEST(the_mirror_image_moves_as_the_mirror_image) {
  for (uint64_t number = 0; number <= RANDOM_SCENES; number++)
    check_scene(true, (units){0}, "rk4", number, number ? 500 : 20000);
}

/* ---- worlds ---- */

static model_run read_world(uint64_t seed, unsigned parts) {
  static random_world world;
  uint64_t r = seed;
  random_world_make(&world, seed, parts);
  model_run run = model_read_text("random.yaml", world.text, set_none);
  strut_scene *scene = &run.setup.scene;
  for (size_t i = 0; i < scene->ground_count; i++) /* along x and y */
    scene->grounds[i].moves[0] = scene->grounds[i].moves[1] = false;
  for (size_t i = 1; i < scene->node_count; i++)
    for (int c = 0; c < 2; c++) scene->nodes[i].velocity[c] = random_between(&r, -1, 1);
  return run;
}

static void check_world(uint64_t seed, unsigned parts, const char *method) {
  static const units by = {.length = 2, .mass = 5, .time = -3};
  OWN(model_run) plain = read_world(seed, parts), turned = read_world(seed, parts);
  OWN(model_run) mirrored = read_world(seed, parts), scaled = read_world(seed, parts);
  turn(&turned.setup.scene);
  mirror(&mirrored.setup.scene);
  change_units(&scaled.setup.scene, by);
  OWN(motion) a = run(&plain.setup, method, WORLD_STEP, WORLD_STEPS);
  OWN(motion) b = run(&turned.setup, method, WORLD_STEP, WORLD_STEPS);
  OWN(motion) c = run(&mirrored.setup, method, WORLD_STEP, WORLD_STEPS);
  OWN(motion) d = run(&scaled.setup, method, ldexp(WORLD_STEP, by.time), WORLD_STEPS);
  assert_all_equal(b.state->trouble, a.state->trouble, c.state->trouble, a.state->trouble,
                   d.state->trouble, a.state->trouble);
  if (a.state->trouble) return;
  compare_bits(&a, &d, false, by);
  for (int p = 0; p < STRUT_POWER_COUNT; p++)
    assert_same_bits(d.state->work[p], ldexp(a.state->work[p], energy_of(by)));
  for (int32_t i = 0; i < a.model->node_count; i++) {
    double p[2] = {a.state->q[2 * i], a.state->q[2 * i + 1]};
    assert_all_near(1e-9, c.state->q[2 * i], -p[0], c.state->q[2 * i + 1], p[1]);
    turn_point(p);
    assert_all_near(1e-9, b.state->q[2 * i], p[0], b.state->q[2 * i + 1], p[1]);
  }
}

TEST(worlds_turned_mirrored_and_in_other_units) {
  static const unsigned kinds[] = {WORLD_BODIES, WORLD_GROUNDS | WORLD_LIGHT, WORLD_MEMORY};
  static const char *const methods[] = {"rk4", "rk4-events", "verlet-events"};
  for (int k = 0; k < 9; k++)
    for (uint64_t seed = 1; seed <= worlds; seed++) check_world(seed, kinds[k / 3], methods[k % 3]);
}

/* ---- in another order ---- */

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
    OWN(strut_setup) first = make(number), second = make(number);
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
