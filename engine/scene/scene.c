/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Defaults of the plain description, and the few quantities that follow from it. See scene.h. */
#include "engine/scene/scene.h"

#include <math.h>
#include <string.h>

#include "engine/base/vec.h"
#include "engine/scene/experiment.h"
#include "engine/scene/things.h"
#include "engine/scene/wrap.h"

void strut_scene_init(strut_scene *scene) {
  memset(scene, 0, sizeof *scene);
  scene->name = scene->description = scene->source = "";
  scene->start_equilibrium = -1;
}

const char *strut_member_kind_name(strut_member_kind kind) {
  switch (kind) {
    case STRUT_BAR: return "bar";
    case STRUT_SPRING: return "spring";
    case STRUT_CABLE: return "cable";
  }
  return "";
}

#define USUAL(KIND) (strut_thing_at(STRUT_THING_##KIND)->usual)
strut_node strut_node_default(void) { return *(const strut_node *)USUAL(NODE); }
strut_member strut_member_default(void) { return *(const strut_member *)USUAL(MEMBER); }
strut_hinge strut_hinge_default(void) { return *(const strut_hinge *)USUAL(HINGE); }
strut_contact strut_contact_default(void) { return *(const strut_contact *)USUAL(CONTACT); }
strut_cell strut_cell_default(void) { return *(const strut_cell *)USUAL(CELL); }
strut_collision strut_collision_default(void) { return *(const strut_collision *)USUAL(COLLISION); }
#undef USUAL

void strut_scene_free(strut_scene *scene) {
  strut_arena_free(&scene->arena);
  memset(scene, 0, sizeof *scene);
}

void strut_scene_hold_supports(strut_scene *scene, bool shapes) {
  for (size_t i = 0; i < scene->support_motion_count; i++) {
    const strut_support_motion *motion = &scene->support_motions[i];
    double value, rate;
    strut_signal_evaluate(scene->signals, motion->signal, 0.0, &value, &rate);
    scene->nodes[motion->node].start[motion->axis] += value;
    if (shapes) scene->nodes[motion->node].position[motion->axis] += value;
    for (size_t k = 0; k < scene->configuration_count && shapes; k++)
      if (scene->configurations[k].position)
        scene->configurations[k].position[motion->node][motion->axis] += value;
  }
  scene->support_motion_count = 0;
}

void strut_scene_stop_unbalances(strut_scene *scene) {
  for (size_t i = 0; i < scene->unbalance_count; i++)
    scene->nodes[scene->unbalances[i].node].mass += scene->unbalances[i].mass;
  scene->unbalance_count = 0;
}

/* The i-th of all masses; NULL after the last. */
static double *mass_at(const strut_scene *scene, size_t i) {
  if (i < scene->node_count) return &scene->nodes[i].mass;
  if ((i -= scene->node_count) < scene->member_count) return &scene->members[i].mass;
  if ((i -= scene->member_count) < scene->sliding_count) return &scene->sliding_masses[i].mass;
  if ((i -= scene->sliding_count) < scene->unbalance_count) return &scene->unbalances[i].mass;
  return NULL;
}

double strut_scene_mass(const strut_scene *scene) {
  double sum = 0.0;
  for (size_t i = 0; mass_at(scene, i); i++) sum += *mass_at(scene, i);
  return sum;
}

void strut_scene_scale_masses(strut_scene *scene, double factor) {
  for (size_t i = 0; mass_at(scene, i); i++) *mass_at(scene, i) *= factor;
}

/* Twice the area of the triangle about guide k, counter-clockwise: the next node is to the left. */
static double turn_at(const strut_scene *scene, const strut_member *member, size_t k) {
  const double *a = scene->nodes[strut_member_node(member, k - 1)].position,
               *b = scene->nodes[strut_member_node(member, k)].position,
               *c = scene->nodes[strut_member_node(member, k + 1)].position;
  return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
}

bool strut_scene_signals_repeat(const strut_scene *scene, double time) {
  for (size_t i = 0; i < scene->signal_count; i++) {
    const strut_signal *signal = &scene->signals[i];
    if ((signal->kind != STRUT_SINE && signal->kind != STRUT_SQUARE) || isfinite(signal->stop))
      continue;
    double turns = time * signal->frequency;
    if (fabs(turns - round(turns)) > 1e-9 * fmax(1.0, turns)) return false;
  }
  return true;
}

double strut_scene_last_signal_event(const strut_scene *scene) {
  double last = 0.0;
  for (size_t i = 0; i < scene->signal_count; i++) {
    const strut_signal *signal = &scene->signals[i];
    last = fmax(last, signal->start);
    if (isfinite(signal->stop)) last = fmax(last, signal->stop);
    if (signal->kind == STRUT_HALF_SINE) last = fmax(last, signal->start + 0.5 / signal->frequency);
    if (strut_signal_has_points(signal) && signal->outside != STRUT_OUTSIDE_REPEAT)
      last = fmax(last, signal->start + signal->time[signal->point_count - 1]);
  }
  return last;
}

bool strut_member_is_straight_at(const strut_scene *scene, const strut_member *member, size_t k) {
  return turn_at(scene, member, k) == 0.0;
}

uint32_t strut_member_right_guides(const strut_scene *scene, const strut_member *member) {
  uint32_t right = 0;
  for (size_t k = 1; k <= member->guide_count; k++) {
    double turn = turn_at(scene, member, k);
    bool to_right = member->guide_side == STRUT_GUIDE_RIGHT ||
                    (member->guide_side == STRUT_GUIDE_AS_DRAWN && turn < 0.0);
    right |= (uint32_t)to_right << k;
  }
  return right;
}

static double wrapped_length(const strut_scene *scene, const strut_member *member) {
  double p[STRUT_MOST_WRAPPED][2];
  int n = (int)member->guide_count + 2;
  strut_wrap way;
  for (int k = 0; k < n; k++)
    memcpy(p[k], scene->nodes[strut_member_node(member, (size_t)k)].position, sizeof p[k]);
  return strut_wrap_find((const double(*)[2])p, n, strut_member_right_guides(scene, member),
                         member->guide_radius, &way);
}

static double drawn_length(const strut_scene *scene, const strut_member *member) {
  double sum = 0.0;
  if (member->guide_count && member->guide_radius > 0.0) return wrapped_length(scene, member);
  for (size_t k = 0; k <= member->guide_count; k++)
    sum += strut_distance(scene->nodes[strut_member_node(member, k)].position,
                          scene->nodes[strut_member_node(member, k + 1)].position);
  return sum;
}

double strut_hinge_drawn(const strut_scene *scene, size_t index) {
  const strut_hinge *hinge = &scene->hinges[index];
  const double *o = scene->nodes[hinge->node[1]].position;
  strut_vec2 u = strut_vec2_between(o, scene->nodes[hinge->node[0]].position);
  strut_vec2 v = strut_vec2_between(o, scene->nodes[hinge->node[2]].position);
  return atan2(u.x * v.y - u.y * v.x, u.x * v.x + u.y * v.y);
}

double strut_hinge_rest(const strut_scene *scene, size_t index) {
  double rest = scene->hinges[index].rest_angle;
  return isnan(rest) ? strut_hinge_drawn(scene, index) : rest;
}

double strut_distance_drawn(const strut_scene *scene, size_t index) {
  const strut_distance_spring *spring = &scene->distances[index];
  bool line = spring->line[0] >= 0;
  const double *from = scene->nodes[line ? spring->line[0] : spring->node[0]].position,
               *to = scene->nodes[line ? spring->node[0] : spring->node[1]].position;
  strut_vec2 u = strut_vec2_between(from, to);
  if (!line) return u.x * cos(spring->along) + u.y * sin(spring->along);
  strut_vec2 w = strut_vec2_between(from, scene->nodes[spring->line[1]].position);
  return (w.x * u.y - w.y * u.x) / hypot(w.x, w.y);
}

double strut_distance_rest(const strut_scene *scene, size_t index) {
  double rest = scene->distances[index].rest_distance;
  return isnan(rest) ? strut_distance_drawn(scene, index) : rest;
}

double strut_cell_drawn(const strut_scene *scene, size_t index) {
  const strut_cell *cell = &scene->cells[index];
  const double *o = scene->nodes[cell->node[0]].position;
  double twice = 0.0;
  for (size_t k = 1; k + 1 < cell->node_count; k++) {
    strut_vec2 u = strut_vec2_between(o, scene->nodes[cell->node[k]].position);
    strut_vec2 v = strut_vec2_between(o, scene->nodes[cell->node[k + 1]].position);
    twice += u.x * v.y - u.y * v.x;
  }
  return 0.5 * twice;
}

/* Rest length that gives `force` in the drawn shape; NAN if none does. */
static double length_under(const strut_member *member, double drawn, double force) {
  if (force == 0.0) return drawn;
  if (member->axial_stiffness > 0.0) {
    double sum = member->axial_stiffness + force;
    return sum > 0.0 ? member->axial_stiffness * drawn / sum : (double)NAN;
  }
  return member->stiffness > 0.0 ? drawn - force / member->stiffness : (double)NAN;
}

bool strut_member_rest(const strut_scene *scene, size_t index, strut_rest *rest) {
  const strut_member *member = &scene->members[index];
  double drawn = drawn_length(scene, member), force = (double)NAN, length = (double)NAN;
  switch (member->rest_kind) {
    case STRUT_REST_RATIO: length = member->rest_value * drawn; break;
    case STRUT_REST_LENGTH: length = member->rest_value; break;
    case STRUT_REST_PRETENSION:
      length = length_under(member, drawn, force = member->rest_value);
      break;
    case STRUT_REST_FORCE_DENSITY:
      length = length_under(member, drawn, force = member->rest_value * drawn);
      break;
  }
  bool by_ea = member->axial_stiffness > 0.0;
  if (!isfinite(drawn) || !isfinite(length) || length < 0.0 || (by_ea && length == 0.0))
    return false;
  double stiffness = by_ea ? member->axial_stiffness / length : member->stiffness;
  if (!isfinite(stiffness)) return false;
  if (isnan(force)) force = stiffness * (drawn - length);
  if (member->kind == STRUT_CABLE && force < 0.0) force = 0.0;
  *rest = (strut_rest){.drawn_length = drawn,
                       .length = length,
                       .ratio = drawn > 0.0 ? length / drawn : 0.0,
                       .pretension = force,
                       .force_density = drawn > 0.0 ? force / drawn : 0.0,
                       .stiffness = stiffness};
  return true;
}

/* ---- experiments ---- */

strut_experiment strut_experiment_default(void) {
  return (strut_experiment){
      .integrator = "rk4",
      .tolerance = 1e-6,
      .budget = STRUT_USUAL_BUDGET,
      .refine_rate = 0.25,
      .refine_memory = 8.0,
      .steady = {.tolerance = 0.005, .successive = 5},
      .settle = {.speed = 1e-8, .acceleration = 1e-8, .limit = 100.0},
      .search = {.seed = 1},
      .period_signal = -1,
      .measure_node = -1,
      .channels = STRUT_CHANNEL_POSITION | STRUT_CHANNEL_LENGTH | STRUT_CHANNEL_FORCE};
}

strut_status strut_experiment_end(const strut_experiment *experiment, strut_status status,
                                  strut_error *error) {
  if (!strut_experiment_interrupted(experiment)) return status;
  return strut_fail(error, STRUT_INTERRUPTED, "interrupted");
}

void strut_setup_init(strut_setup *setup) {
  strut_scene_init(&setup->scene);
  setup->experiment = strut_experiment_default();
}

void strut_setup_free(strut_setup *setup) {
  strut_scene_free(&setup->scene);
  memset(&setup->experiment, 0, sizeof setup->experiment);
}

strut_span strut_experiment_span(const strut_experiment *experiment, const strut_scene *scene) {
  strut_span span = {.duration = experiment->duration};
  double unit = 1.0; /* of the windows: one period, or one second */
  if (experiment->periods > 0.0) {
    unit = span.period = strut_signal_period(scene->signals, experiment->period_signal);
    span.duration = experiment->periods * span.period;
  }
  if (experiment->measure_last > 0.0)
    span.window_start = span.duration - experiment->measure_last * unit;
  if (experiment->output_last > 0.0)
    span.record_start = span.duration - experiment->output_last * unit;
  if (span.window_start < 0.0) span.window_start = 0.0;
  if (span.record_start < 0.0) span.record_start = 0.0;
  span.record_every = experiment->output_every > 0.0 ? experiment->output_every
                                                     : (span.duration - span.record_start) / 1000.0;
  return span;
}

/* Steps per period of a method that chooses its steps; 0: it does not. */
static double steps_per_period(const char *integrator) {
#define STRUT_INTEGRATOR_STEPS(row, word, steps)                                                   \
  if (strcmp(integrator, word) == 0) return steps;
  STRUT_INTEGRATORS(STRUT_INTEGRATOR_STEPS)
  return 0.0;
}

bool strut_experiment_is_adaptive(const char *integrator) {
  return integrator && steps_per_period(integrator) > 0.0;
}

void strut_experiment_choose_method(strut_experiment *experiment, const strut_scene *scene) {
  bool usual = !experiment->integrator_named && strcmp(experiment->integrator, "rk4") == 0;
  if (experiment->accuracy > 0.0) return;
  for (size_t i = 0; i < scene->contact_count && usual; i++)
    if (strut_friction_is_exact(scene->contacts[i].friction.law))
      experiment->integrator = "rk4-events";
  if (experiment->step != 0.0 || !strut_experiment_is_adaptive(experiment->integrator)) return;
  strut_span span = strut_experiment_span(experiment, scene);
  experiment->step =
      (span.period > 0.0 ? span.period : span.duration) / steps_per_period(experiment->integrator);
  experiment->step_chosen = true;
}

static bool shift_ground(strut_ground *ground, const double place[2], strut_arena *arena) {
  if (!ground->placed) ground->through[0] = 0.0, ground->through[1] = ground->height;
  ground->placed = ground->placed || ground->shape == STRUT_GROUND_LINE;
  for (int c = 0; c < 2; c++) ground->through[c] += place[c], ground->centre[c] += place[c];
  if (ground->shape != STRUT_GROUND_PROFILE) return true;
  double(*points)[2] = strut_arena_allocate(arena, ground->point_count, sizeof *points);
  for (size_t k = 0; points && k < ground->point_count; k++)
    for (int c = 0; c < 2; c++) points[k][c] = ground->points[k][c] + place[c];
  ground->points = points;
  return points;
}

void strut_scene_stop_grip(const strut_scene *scene, strut_friction *friction) {
  double mu, rate;
  if (!friction->driven) return;
  strut_signal_evaluate(scene->signals, friction->signal, 0.0, &mu, &rate);
  strut_friction_drive(friction, isnan(mu) ? 1.0 : mu);
  friction->driven = false;
}

bool strut_scene_stop_grounds(strut_scene *scene, strut_arena *arena) {
  if (!scene->ground_count) return true;
  strut_ground *grounds = strut_arena_allocate(arena, scene->ground_count, sizeof *grounds);
  bool good = grounds;
  for (size_t i = 0; i < scene->ground_count && good; i++) {
    strut_ground *ground = &grounds[i];
    double place[2] = {0.0, 0.0}, rate;
    *ground = scene->grounds[i];
    for (int c = 0; c < 2; c++)
      if (ground->moves[c])
        strut_signal_evaluate(scene->signals, ground->motion[c], 0.0, &place[c], &rate);
    ground->belt_speed = 0.0;
    ground->moves[0] = ground->moves[1] = false;
    if (place[0] != 0.0 || place[1] != 0.0) good = shift_ground(ground, place, arena);
  }
  scene->grounds = grounds;
  return good;
}

bool strut_scene_shift(strut_scene *scene, const double by[2], strut_arena *arena) {
  for (int c = 0; c < 2; c++) {
    for (size_t i = 0; i < scene->node_count; i++)
      scene->nodes[i].position[c] += by[c], scene->nodes[i].start[c] += by[c];
    for (size_t k = 0; k < scene->configuration_count; k++)
      for (size_t i = 0; scene->configurations[k].position && i < scene->node_count; i++)
        scene->configurations[k].position[i][c] += by[c];
  }
  if (scene->ground.present) scene->ground.height += by[1] - tan(scene->ground.slope) * by[0];
  bool good = true;
  for (size_t i = 0; i < scene->ground_count && good; i++)
    good = shift_ground(&scene->grounds[i], by, arena);
  return good;
}

/* ---- masses that slide ---- */

double strut_sliding_mass_scale(const strut_scene *scene, size_t index) {
  const strut_sliding_mass *mass = &scene->sliding_masses[index];
  const int32_t *node = scene->members[mass->member].node;
  if (!mass->travel) return 1.0;
  double drawn = strut_distance(scene->nodes[node[0]].position, scene->nodes[node[1]].position);
  return drawn > 0.0 ? 1.0 / drawn : 0.0;
}

double strut_sliding_mass_share(const strut_scene *scene, size_t index, double t) {
  const strut_sliding_mass *mass = &scene->sliding_masses[index];
  double value, rate;
  if (mass->signal < 0) return mass->share;
  strut_signal_evaluate(scene->signals, mass->signal, t, &value, &rate);
  return mass->share + strut_sliding_mass_scale(scene, index) * value;
}

double strut_sliding_mass_rate(const strut_scene *scene, size_t index, double t) {
  const strut_sliding_mass *mass = &scene->sliding_masses[index];
  double value, rate;
  if (mass->signal < 0) return 0.0;
  strut_signal_evaluate(scene->signals, mass->signal, t, &value, &rate);
  return strut_sliding_mass_scale(scene, index) * rate;
}

bool strut_scene_hold_sliding_masses(strut_scene *scene, strut_arena *arena) {
  size_t count = scene->sliding_count;
  strut_sliding_mass *held = strut_arena_allocate(arena, count, sizeof *held);
  if (!held) return false;
  for (size_t i = 0; i < count; i++) {
    held[i] = scene->sliding_masses[i];
    held[i].share = strut_sliding_mass_share(scene, i, 0.0);
    held[i].signal = -1;
  }
  scene->sliding_masses = held;
  return true;
}

/* ---- without what makes it move by itself ---- */

bool strut_scene_remove_feedback(strut_scene *scene, strut_arena *arena) {
  bool relaxes = false;
  scene->signal_count = scene->sensor_count = scene->state_count = 0;
  for (size_t i = 0; i < scene->member_count; i++)
    relaxes = relaxes || scene->members[i].maxwell.stiffness > 0.0;
  if (!relaxes) return true;
  strut_member *members = strut_arena_allocate(arena, scene->member_count, sizeof *members);
  if (!members) return false;
  memcpy(members, scene->members, scene->member_count * sizeof *members);
  for (size_t i = 0; i < scene->member_count; i++) members[i].maxwell = (strut_maxwell){0};
  scene->members = members;
  return true;
}

bool strut_path_names_load(const char *names, const char *load) {
  size_t length = strlen(load);
  for (const char *at = names; (at = strstr(at, load)); at++) {
    bool begins = at == names || at[-1] == ' ' || at[-1] == ',';
    if (begins && (at[length] == '\0' || at[length] == ',')) return true;
  }
  return false;
}

/* ---- measured data ---- */

const strut_data_column *strut_data_find(const strut_data_table *tables, size_t count,
                                         const char *name, const strut_data_table **table) {
  size_t length = strcspn(name, ".");
  if (table) *table = NULL;
  for (size_t i = 0; i < count; i++) {
    if (strncmp(tables[i].name, name, length) != 0 || tables[i].name[length]) continue;
    if (table) *table = &tables[i];
    for (size_t k = 0; name[length] && k < tables[i].column_count; k++)
      if (strcmp(tables[i].columns[k].name, name + length + 1) == 0) return &tables[i].columns[k];
  }
  return NULL;
}
