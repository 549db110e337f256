/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Random scenes with cells, collisions, grounds of every shape and elements that remember: turned,
 * mirrored and larger they move as the turned, mirrored and larger scene, by methods with events, too.
 */
#include "engine/forces/history.h"
#include "engine/scene/profile.h"
#include "tests/models/run_model.h"
#include "tests/physics/random_world.h"
#include "tests/support/motion.h"
#include "tests/support/random.h"

static uint64_t scenes = 12; /* of each kind; more of them: test_world_invariance SCENES */
static const double TURN = 0.7, LARGER = 4.0, STEP = 1e-3;
enum { STEPS = 120 };

static void swap(double *a, double *b) {
  double keep = *a;
  *a = *b, *b = keep;
}

/* ---- points of a scene moved ---- */

static void turn_point(double *p) {
  double x = p[0], y = p[1];
  p[0] = cos(TURN) * x - sin(TURN) * y, p[1] = sin(TURN) * x + cos(TURN) * y;
}
static void mirror_point(double *p) { p[0] = -p[0]; }
static void enlarge_point(double *p) { p[0] *= LARGER, p[1] *= LARGER; }

static void move_points(strut_scene *scene, void move(double *)) {
  for (size_t i = 0; i < scene->node_count; i++) {
    move(scene->nodes[i].position);
    move(scene->nodes[i].start);
    move(scene->nodes[i].velocity);
  }
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

/* ---- numbers changed ---- */

static void turn_numbers(strut_scene *scene) {
  for (size_t i = 0; i < scene->distance_count; i++) scene->distances[i].along += TURN;
  for (size_t i = 0; i < scene->ground_count; i++) scene->grounds[i].slope += TURN;
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

static void mirror_numbers(strut_scene *scene) {
  for (size_t i = 0; i < scene->distance_count; i++) mirror_distance(&scene->distances[i]);
  for (size_t i = 0; i < scene->ground_count; i++) mirror_ground(scene, i);
  if (scene->contact_count)
    qsort(scene->contacts, scene->contact_count, sizeof *scene->contacts, by_place);
  for (size_t i = 0; i < scene->hinge_count; i++) {
    strut_hinge *h = &scene->hinges[i];
    double *c = strut_arena_allocate(&scene->arena, h->law.count + 1, sizeof *c);
    assert_non_null(c);
    h->rest_angle = isnan(h->rest_angle) ? h->rest_angle : -h->rest_angle;
    for (size_t k = 0; k < h->law.count; k++) c[k] = k % 2 ? -h->law.force[k] : h->law.force[k];
    if (h->law.kind == STRUT_LAW_POLYNOMIAL) h->law.force = c;
  }
}

/* Sizes of strains times `by`, forces times `force`. */
static void enlarge_law(strut_scene *scene, strut_law *law, double by, double force) {
  double *c = strut_arena_allocate(&scene->arena, law->count + 1, sizeof *c);
  assert_non_null(c);
  law->knee *= by, law->gap *= by, law->scale *= by;
  law->yield *= force, law->second_stiffness *= force / by;
  for (size_t k = 0; k < law->count; k++) c[k] = law->force[k] * force / pow(by, (double)k + 1);
  if (law->kind == STRUT_LAW_POLYNOMIAL) law->force = c;
}

static void enlarge_elements(strut_scene *scene) {
  for (size_t j = 0; j < scene->member_count; j++) {
    strut_member *m = &scene->members[j];
    if (m->rest_kind == STRUT_REST_LENGTH || m->rest_kind == STRUT_REST_PRETENSION)
      m->rest_value *= LARGER;
    m->longest *= LARGER, m->shortest *= LARGER;
    m->axial_stiffness *= LARGER, m->breaks_at *= LARGER;
    enlarge_law(scene, &m->law, LARGER, LARGER);
  }
  for (size_t i = 0; i < scene->hinge_count; i++) {
    strut_hinge *h = &scene->hinges[i];
    h->stiffness *= LARGER * LARGER, h->damping *= LARGER * LARGER;
    h->breaks_at *= LARGER * LARGER;
    enlarge_law(scene, &h->law, 1, LARGER * LARGER);
  }
  for (size_t i = 0; i < scene->cell_count; i++) { /* pressures stay */
    strut_cell *c = &scene->cells[i];
    c->stiffness /= LARGER * LARGER, c->damping /= LARGER * LARGER, c->rest_area *= LARGER * LARGER;
    enlarge_law(scene, &c->elastic, LARGER * LARGER, 1);
  }
  for (size_t i = 0; i < scene->collision_count; i++) scene->collisions[i].thickness *= LARGER;
  for (size_t i = 0; i < scene->distance_count; i++) {
    scene->distances[i].rest_distance *= LARGER;
    enlarge_law(scene, &scene->distances[i].law, LARGER, LARGER);
  }
}

static void enlarge_numbers(strut_scene *scene) {
  enlarge_elements(scene);
  for (size_t i = 0; i < scene->ground_count; i++)
    scene->grounds[i].radius *= LARGER, scene->grounds[i].belt_speed *= LARGER;
  for (size_t i = 0; i < scene->contact_count; i++) {
    strut_contact *c = &scene->contacts[i];
    c->dissipation /= LARGER;
    c->friction.stick_velocity *= LARGER, c->friction.width *= LARGER;
    c->friction.decay_velocity *= LARGER;
  }
  for (size_t i = 0; i < scene->signal_count; i++) {
    bool length = false; /* the pressure of a cell stays */
    for (size_t k = 0; k < scene->actuator_count; k++)
      length =
          length || (scene->actuators[k].member >= 0 && scene->actuators[k].signal == (int32_t)i);
    if (length) scene->signals[i].amplitude *= LARGER;
  }
}

/* ---- both ---- */

static model_run read_scene(uint64_t seed, unsigned parts) {
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

static motion advance(const strut_setup *setup, const char *method) {
  motion m = motion_begin_by(setup, method, STEP);
  strut_history_begin(m.model, m.state, 0);
  motion_steps(&m, STEPS);
  return m;
}

static double compare(uint64_t seed, unsigned parts, const char *method, void move(double *),
                      void change(strut_scene *)) {
  double worst = 0;
  model_run one = read_scene(seed, parts), other = read_scene(seed, parts);
  change(&other.setup.scene);
  move_points(&other.setup.scene, move);
  motion a = advance(&one.setup, method);
  motion b = advance(&other.setup, method);
  for (size_t i = 0; i < one.setup.scene.node_count && !a.state->trouble; i++) {
    move(a.state->q + 2 * i);
    for (size_t c = 0; c < 2; c++)
      worst = fmax(worst, fabs(a.state->q[2 * i + c] - b.state->q[2 * i + c]));
  }
  if (a.state->trouble != b.state->trouble) worst = HUGE_VAL;
  motion_free(&a), motion_free(&b);
  model_run_free(&one), model_run_free(&other);
  return worst;
}

BEFORE_ALL { scenes = (uint64_t)test_number(1, (double)scenes); }

TEST(changed_scenes) {
  static const unsigned kinds[] = {WORLD_BODIES, WORLD_GROUNDS | WORLD_LIGHT, WORLD_MEMORY};
  static const char *const methods[] = {"rk4", "rk4-events", "verlet-events"};
  static const struct change {
    const char *name;
    void (*move)(double *);
    void (*numbers)(strut_scene *);
  } changes[] = {{"turned", turn_point, turn_numbers},
                 {"mirrored", mirror_point, mirror_numbers},
                 {"larger", enlarge_point, enlarge_numbers}};
  bool fine = true;
  for (int k = 0; k < 3; k++)
    for (int m = 0; m < 3; m++)
      for (int c = 0; c < 3; c++)
        for (uint64_t seed = 1; seed <= scenes; seed++) {
          double worst = compare(seed, kinds[k], methods[m], changes[c].move, changes[c].numbers);
          if (c == 2 ? worst == 0 : worst < 1e-9) continue; /* by a power of two: every bit */
          print_error("parts %u, seed %d, %s, %s: %g\n", kinds[k], (int)seed, methods[m],
                      changes[c].name, worst);
          fine = false;
        }
  assert_true(fine);
}
