/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/commands.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/base/vec.h"
#include "engine/forces/elements.h"
#include "engine/integrate/integrator.h"
#include "engine/output/buffer.h"
#include "engine/output/json_value.h"
#include "engine/output/report/reports.h"
#include "engine/run/cost_estimate.h"
#include "engine/run/measure/monitors.h"
#include "parser/command/run_settings.h"
#include "parser/program/check_messages.h"
#include "parser/program/open_model.h"
#include "parser/program/streams.h"

enum { MOST_MEMBERS = 40, DIGITS = 5 };

static const strut_option options[] = {
    STRUT_SET_OPTION,
    STRUT_RUN_SETTING_OPTIONS,
    STRUT_FIDELITY_OPTIONS,
    STRUT_JSON_OPTION,
    {STRUT_OPTION_VERBOSE, "verbose", NULL, "list also what a step does not evaluate"},
    {STRUT_OPTION_END, NULL, NULL, NULL},
};

static strut_rounded_quantity in(double value, const char *unit) {
  return strut_quantity_of(value, DIGITS, unit);
}

static void print_counts(const strut_cost_estimate *estimate) {
  size_t members = estimate->count.bars + estimate->count.springs + estimate->count.cables;
  printf("  nodes              %zu, with %zu degrees of freedom\n", estimate->count.nodes,
         estimate->count.degrees_of_freedom);
  printf("  members            %zu: bars %zu, springs %zu, cables %zu\n", members,
         estimate->count.bars, estimate->count.springs, estimate->count.cables);
  if (estimate->count.running_cables + estimate->count.laws + estimate->count.stops > 0)
    printf("  of them            running cables %zu, with a law %zu, stops %zu\n",
           estimate->count.running_cables, estimate->count.laws, estimate->count.stops);
  if (estimate->count.hinges) printf("  hinges             %zu\n", estimate->count.hinges);
  if (estimate->count.cells) printf("  cells              %zu\n", estimate->count.cells);
  if (estimate->count.collisions) printf("  collisions         %zu\n", estimate->count.collisions);
  printf("  contacts           %zu\n  actuators          %zu\n  loads              %zu\n",
         estimate->count.contacts, estimate->count.actuators, estimate->count.loads);
  printf("  memory             %s\n", in((double)estimate->bytes, "B").text);
}

/* Step limits of the other methods, on one line. */
static void print_limits(const strut_cost_estimate *estimate) {
  const char *between = "  of other methods   ";
  for (size_t i = 0; strut_integrator_at(i); i++) {
    const strut_integrator *method = strut_integrator_at(i);
    double limit = strut_step_limit_of_method(&estimate->limits, method);
    if (method->region == STRUT_REGION_RK4 || !isfinite(limit)) continue;
    printf("%s%s %s", between, method->name, in(limit, "s").text);
    between = ", ";
  }
  if (*between == ',') printf("\n");
}

static void print_run(const strut_cost_estimate *estimate, const strut_experiment *e) {
  if (!estimate->runnable) {
    printf("  no run             a free node has no mass: statics only\n");
    return;
  }
  double step = e->step, hertz = estimate->largest_frequency / STRUT_TAU;
  printf("  mass matrix        %zu nonzeros, %zu in its factor, %zu in dense inverses\n",
         estimate->matrix.mass_nonzeros, estimate->matrix.factor_nonzeros,
         estimate->matrix.dense_entries);
  bool bound = estimate->limits.bound;
  printf("  highest frequency  %s%s (undamped, all contacts closed)\n", bound ? "at most " : "",
         in(hertz, "Hz").text);
  printf("  largest step       %s%s for rk4, with contacts and damping (%s)\n",
         bound ? "at least " : "", in(estimate->step_limit, "s").text,
         bound                        ? "a bound: the structure is too large for an estimate"
         : estimate->step_limit_exact ? "from all eigenvalues"
                                      : "within 1 %");
  print_limits(estimate);
  if (estimate->feedback)
    printf("  feedback           not counted in this frequency and these steps\n");
  const strut_integrator *method = strut_integrator_find(e->integrator);
  double limit =
      method ? strut_step_limit_of_method(&estimate->limits, method) : estimate->step_limit;
  if (method && method->region == STRUT_REGION_ALL) printf("  limit of %-9s none\n", method->name);
  if (step > limit) {
    printf("  step               %s: too large, strut run rejects it\n", in(step, "s").text);
  } else if (step > 0) {
    printf("  step               %s\n", in(step, "s").text);
  }
}

/* Warns of stick bands that a step passes over, in one line for all nodes. */
static void print_bands(const strut_model *model, const strut_experiment *experiment) {
  const strut_scene *scene = model->scene;
  const strut_integrator *method = strut_integrator_find(experiment->integrator);
  double needed = 0.0;
  int32_t first = -1, more = -1;
  for (int32_t i = 0; method && i < model->contacts.count; i++) {
    double here = strut_stick_band_needed(model, method, i, experiment->step);
    if (!(here * (1.0 - 1e-6) > model->contacts.entry[i].friction.stick_velocity)) continue;
    if (first < 0) first = i;
    if (here > needed) needed = here;
    more++;
  }
  if (first < 0) return;
  const strut_contact_entry *e = &model->contacts.entry[first];
  char others[40] = "";
  if (more > 0) snprintf(others, sizeof others, " and %d more", (int)more);
  fprintf(stderr,
          "strut: warning: stick_velocity %s of node '%s'%s is narrower than the change of slip in "
          "one step of %s, so that sticking is a matter of chance; use stick_velocity >= %s, a "
          "smaller step, or a method with events\n",
          in(e->friction.stick_velocity, "m/s").text, scene->nodes[e->node].name, others,
          in(experiment->step, "s").text, in(needed, "m/s").text);
}

static void print_terms(const strut_cost_estimate *estimate, bool wanted, const char *title) {
  bool any = false;
  for (int i = 0; i < STRUT_COST_TERMS; i++) {
    const strut_cost_term *term = &estimate->terms[i];
    if (term->in != wanted) continue;
    if (!any) printf("\n%s\n", title);
    any = true;
    printf("  %-20s %s %s\n", term->name, wanted ? "for" : "needs", term->why);
  }
}

/* Positions of the drawn shape (length), or NULL. */
static double *drawn_shape(const strut_model *model) {
  double *q = strut_allocate((size_t)model->length, sizeof *q);
  for (size_t i = 0; q && i < model->scene->node_count; i++) {
    q[2 * i] = model->scene->nodes[i].position[0];
    q[2 * i + 1] = model->scene->nodes[i].position[1];
  }
  return q;
}

/* Rest length, force and stiffness of a member as drawn; of one that is an element by its law. */
static bool describe_member(const strut_model *model, const double *q, size_t j, strut_rest *rest) {
  if (!strut_member_rest(model->scene, j, rest)) return false;
  const strut_element *e = strut_element_of_member(&model->elements, (int32_t)j);
  if (!e || e->role != STRUT_ELEMENT_MEMBER) return true;
  strut_element_pose pose;
  strut_element_evaluate(model, (int32_t)(e - model->elements.element), model->members.rest, q,
                         (double)NAN, &pose);
  rest->pretension = pose.force;
  rest->force_density = rest->drawn_length > 0.0 ? pose.force / rest->drawn_length : 0.0;
  rest->stiffness = e->numbers.stiffness;
  return true;
}

/* The width of the columns of names: of the longest, from 12 to 40. */
static int name_width(const strut_scene *scene) {
  size_t longest = 12;
  const struct {
    const void *first;
    size_t count, size, offset;
  } things[] = {
      {scene->members, scene->member_count, sizeof *scene->members, offsetof(strut_member, name)},
      {scene->hinges, scene->hinge_count, sizeof *scene->hinges, offsetof(strut_hinge, name)},
      {scene->cells, scene->cell_count, sizeof *scene->cells, offsetof(strut_cell, name)},
      {scene->collisions, scene->collision_count, sizeof *scene->collisions,
       offsetof(strut_collision, name)},
      {scene->distances, scene->distance_count, sizeof *scene->distances,
       offsetof(strut_distance_spring, name)}};
  for (size_t t = 0; t < sizeof things / sizeof things[0]; t++)
    for (size_t i = 0; i < things[t].count && i < MOST_MEMBERS; i++) {
      const char *thing = (const char *)things[t].first + i * things[t].size;
      size_t length = strlen(*(const char *const *)(const void *)(thing + things[t].offset));
      if (length > longest) longest = length;
    }
  return longest > 40 ? 40 : (int)longest;
}

/* Every member's rest length in the four forms that the language accepts. */
static void print_members(const strut_model *model, const double *q, int names) {
  const strut_scene *scene = model->scene;
  if (scene->member_count == 0) return;
  printf("\n  %-*s %-6s %12s %12s %10s %12s %13s %12s\n", names, "member", "kind", "drawn",
         "rest length", "ratio", "pretension", "force density", "stiffness");
  for (size_t i = 0; i < scene->member_count && i < MOST_MEMBERS; i++) {
    strut_rest rest;
    const strut_member *member = &scene->members[i];
    if (!describe_member(model, q, i, &rest)) continue;
    printf("  %-*s %-6s %12s %12s %10.5g %12s %13s %12s\n", names, member->name,
           strut_member_kind_name(member->kind), in(rest.drawn_length, "m").text,
           in(rest.length, "m").text, rest.ratio, in(rest.pretension, "N").text,
           in(rest.force_density, "N/m").text, in(rest.stiffness, "N/m").text);
  }
  if (scene->member_count > MOST_MEMBERS) {
    printf("  ... and %zu more; --json lists all\n", scene->member_count - MOST_MEMBERS);
  }
}

static void print_running_cables(const strut_scene *scene, int names) {
  size_t printed = 0;
  for (size_t i = 0; i < scene->member_count && printed < MOST_MEMBERS; i++) {
    const strut_member *m = &scene->members[i];
    if (!m->guide_count) continue;
    if (!printed++) printf("\n  %-*s over\n", names, "running");
    printf("  %-*s ", names, m->name);
    for (size_t k = 0; k < m->guide_count + 2; k++)
      printf("%s%s", k ? ", " : "", scene->nodes[strut_member_node(m, k)].name);
    printf("\n");
  }
}

static const char *carries_name(const strut_member *m) {
  static const char *const names[] = {"both", "tension", "compression"};
  return names[m->kind == STRUT_CABLE ? STRUT_CARRIES_TENSION : m->law.carries];
}

static void print_laws(const strut_scene *scene, int names) {
  size_t printed = 0;
  for (size_t i = 0; i < scene->member_count && printed < MOST_MEMBERS; i++) {
    const strut_member *m = &scene->members[i];
    if (m->law.kind == STRUT_LAW_LINEAR && m->law.carries == STRUT_CARRIES_BOTH) continue;
    if (!printed++) printf("\n  %-*s %-12s carries\n", names, "law of", "kind");
    printf("  %-*s %-12s %s\n", names, m->name, strut_law_at(m->law.kind)->word, carries_name(m));
  }
}

/* The stiffness of a member's stops [N/m]. */
static double stop_stiffness(const strut_model *model, size_t j) {
  const strut_element *e = strut_element_of_member(&model->elements, (int32_t)j);
  while (e && e->role == STRUT_ELEMENT_MEMBER)
    e = e->sibling >= 0 ? &model->elements.element[e->sibling] : NULL;
  return e ? e->numbers.stiffness : 0.0;
}

static void print_stops(const strut_model *model, int names) {
  const strut_scene *scene = model->scene;
  size_t printed = 0;
  for (size_t i = 0; i < scene->member_count && printed < MOST_MEMBERS; i++) {
    const strut_member *m = &scene->members[i];
    bool shortest = m->shortest > 0.0, longest = m->longest > 0.0;
    if (!shortest && !longest) continue;
    if (!printed++)
      printf("\n  %-*s %12s %12s %12s %12s\n", names, "stops of", "shortest", "longest",
             "stiffness", "damping");
    printf("  %-*s %12s %12s %12s %12s\n", names, m->name,
           shortest ? in(m->shortest, "m").text : "-", longest ? in(m->longest, "m").text : "-",
           in(stop_stiffness(model, i), "N/m").text, in(m->stop_damping, "N s/m").text);
  }
}

static void print_end(int names, const char *name, double force, double time, const char *unit,
                      size_t *printed) {
  if (!(force > 0.0) && !(time > 0.0)) return;
  if (!(*printed)++) printf("\n  %-*s %12s %12s\n", names, "end of", "breaks_at", "released_at");
  printf("  %-*s %12s %12s\n", names, name, force > 0.0 ? in(force, unit).text : "-",
         time > 0.0 ? in(time, "s").text : "-");
}

static void print_ends(const strut_scene *scene, int names) {
  size_t printed = 0;
  for (size_t i = 0; i < scene->member_count && printed < MOST_MEMBERS; i++) {
    const strut_member *m = &scene->members[i];
    print_end(names, m->name, m->breaks_at, m->released_at, "N", &printed);
  }
  for (size_t i = 0; i < scene->hinge_count && printed < MOST_MEMBERS; i++) {
    const strut_hinge *h = &scene->hinges[i];
    print_end(names, h->name, h->breaks_at, h->released_at, "N m", &printed);
  }
}

/* A hinge as drawn. */
static strut_element_pose describe_hinge(const strut_model *model, const double *q, size_t i,
                                         double *stiffness) {
  int32_t element = strut_element_of_hinge(&model->elements, (int32_t)i);
  strut_element_pose pose;
  strut_element_evaluate(model, element, model->members.rest, q, (double)NAN, &pose);
  *stiffness = model->elements.element[element].numbers.stiffness;
  return pose;
}

static void print_hinges(const strut_model *model, const double *q, int names) {
  const strut_scene *scene = model->scene;
  for (size_t i = 0; i < scene->hinge_count && i < MOST_MEMBERS; i++) {
    double stiffness, degree = STRUT_PI / 180.0;
    strut_element_pose pose = describe_hinge(model, q, i, &stiffness);
    if (!i)
      printf("\n  %-*s %12s %12s %12s %14s\n", names, "hinge", "drawn", "rest angle", "moment",
             "stiffness");
    printf("  %-*s %8.5g deg %8.5g deg %12s %14s\n", names, scene->hinges[i].name,
           pose.strain / degree, pose.natural / degree, in(pose.force, "N m").text,
           in(stiffness, "N m/rad").text);
  }
  if (scene->hinge_count > MOST_MEMBERS)
    printf("  ... and %zu more; --json lists all\n", scene->hinge_count - MOST_MEMBERS);
}

static const char *cell_content(const strut_cell *cell) {
  return strut_cell_is_elastic(cell)         ? "elastic"
         : cell->law == STRUT_LAW_PRESSURE   ? "given pressure"
         : cell->law == STRUT_LAW_ISOTHERMAL ? "isothermal gas"
                                             : "isentropic gas";
}

static void print_cells(const strut_scene *scene, int names) {
  for (size_t i = 0; i < scene->cell_count && i < MOST_MEMBERS; i++) {
    const strut_cell *cell = &scene->cells[i];
    if (!i)
      printf("\n  %-*s %12s %12s %12s  content\n", names, "cell", "drawn", "pressure", "outside");
    printf("  %-*s %8.4g m^2 %12s %12s  %s\n", names, cell->name, fabs(strut_cell_drawn(scene, i)),
           in(cell->pressure, "N/m").text, in(cell->outside, "N/m").text, cell_content(cell));
  }
  if (scene->cell_count > MOST_MEMBERS)
    printf("  ... and %zu more; --json lists all\n", scene->cell_count - MOST_MEMBERS);
}

/* The least distance of the surfaces of a collision in the drawn shape. */
static double drawn_gap(const strut_model *model, const double *q, size_t i) {
  int32_t first = strut_element_of_collision(&model->elements, (int32_t)i);
  int32_t end = strut_element_end(&model->elements, first);
  double gap = HUGE_VAL;
  strut_element_pose pose;
  for (int32_t k = first; k < end; k++) {
    strut_element_evaluate(model, k, model->members.rest, q, (double)NAN, &pose);
    gap = fmin(gap, pose.strain - pose.natural);
  }
  return gap;
}

static void print_collisions(const strut_model *model, const double *q, int names) {
  const strut_scene *scene = model->scene;
  for (size_t i = 0; i < scene->collision_count && i < MOST_MEMBERS; i++) {
    const strut_collision *c = &scene->collisions[i];
    if (!i)
      printf("\n  %-*s %12s %12s %12s %14s\n", names, "collision", "thickness", "drawn gap",
             "stiffness", "damping");
    printf("  %-*s %12s %12s %12s %14s\n", names, c->name, in(c->thickness, "m").text,
           in(drawn_gap(model, q, i), "m").text, in(c->stiffness, "N/m").text,
           in(c->damping, "N s/m").text);
  }
  if (scene->collision_count > MOST_MEMBERS)
    printf("  ... and %zu more; --json lists all\n", scene->collision_count - MOST_MEMBERS);
}

/* The stiffness at rest, of a law that brings its own too. */
static double distance_stiffness(const strut_model *model, size_t i) {
  int32_t element = strut_element_of_distance(&model->elements, (int32_t)i);
  return model->elements.element[element].numbers.stiffness;
}

static void print_distances(const strut_model *model, int names) {
  const strut_scene *scene = model->scene;
  for (size_t i = 0; i < scene->distance_count && i < MOST_MEMBERS; i++) {
    const strut_distance_spring *d = &scene->distances[i];
    if (!i)
      printf("\n  %-*s %12s %12s %14s %14s\n", names, "distance", "drawn", "rest", "stiffness",
             "damping");
    printf("  %-*s %12s %12s %14s %14s\n", names, d->name,
           in(strut_distance_drawn(scene, i), "m").text,
           in(strut_distance_rest(scene, i), "m").text,
           in(distance_stiffness(model, i), "N/m").text, in(d->damping, "N s/m").text);
  }
  if (scene->distance_count > MOST_MEMBERS)
    printf("  ... and %zu more; --json lists all\n", scene->distance_count - MOST_MEMBERS);
}

static strut_status print_estimate(const strut_cost_estimate *estimate, const strut_model *model,
                                   const strut_experiment *experiment, bool verbose) {
  const strut_scene *scene = model->scene;
  int names = name_width(scene);
  double *q = drawn_shape(model);
  if (!q) return strut_print_out_of_memory();
  printf("%s%svalid\n", scene->name, *scene->name ? ": " : "");
  print_counts(estimate);
  print_run(estimate, experiment);
  print_terms(estimate, true, "each step evaluates");
  if (verbose) print_terms(estimate, false, "omitted, as the scene does not need it");
  print_members(model, q, names);
  print_running_cables(scene, names);
  print_laws(scene, names);
  print_stops(model, names);
  print_ends(scene, names);
  print_hinges(model, q, names);
  print_cells(scene, names);
  print_collisions(model, q, names);
  print_distances(model, names);
  strut_release(q);
  return STRUT_OK;
}

static void add_estimate(strut_json *json, const strut_cost_estimate *estimate,
                         const strut_setup *setup) {
  const strut_scene *scene = &setup->scene;
  struct cJSON *root = json->root;
  strut_json_text(json, root, "name", scene->name);
  strut_json_text(json, root, "strut_version", STRUT_VERSION);
  strut_json_integer(json, root, "language", STRUT_LANGUAGE_VERSION);
  strut_json_integer(json, root, "nodes", (int64_t)estimate->count.nodes);
  strut_json_integer(json, root, "degrees_of_freedom", (int64_t)estimate->count.degrees_of_freedom);
  strut_json_integer(json, root, "bars", (int64_t)estimate->count.bars);
  strut_json_integer(json, root, "springs", (int64_t)estimate->count.springs);
  strut_json_integer(json, root, "cables", (int64_t)estimate->count.cables);
  strut_json_integer(json, root, "running_cables", (int64_t)estimate->count.running_cables);
  strut_json_integer(json, root, "laws", (int64_t)estimate->count.laws);
  strut_json_integer(json, root, "stops", (int64_t)estimate->count.stops);
  strut_json_integer(json, root, "contacts", (int64_t)estimate->count.contacts);
  strut_json_integer(json, root, "actuators", (int64_t)estimate->count.actuators);
  strut_json_integer(json, root, "loads", (int64_t)estimate->count.loads);
  strut_json_integer(json, root, "mass_nonzeros", (int64_t)estimate->matrix.mass_nonzeros);
  strut_json_integer(json, root, "factor_nonzeros", (int64_t)estimate->matrix.factor_nonzeros);
  strut_json_integer(json, root, "dense_entries", (int64_t)estimate->matrix.dense_entries);
  strut_json_integer(json, root, "bytes", (int64_t)estimate->bytes);
  strut_json_bool(json, root, "runnable", estimate->runnable);
  strut_json_number(json, root, "largest_frequency",
                    estimate->runnable ? estimate->largest_frequency / STRUT_TAU : (double)NAN);
  strut_json_number(json, root, "step", setup->experiment.step);
  strut_json_number(json, root, "step_limit",
                    estimate->runnable ? estimate->step_limit : (double)NAN);
  strut_json_bool(json, root, "step_limit_exact", estimate->step_limit_exact);
  strut_json_bool(json, root, "step_limit_bound", estimate->limits.bound);
  struct cJSON *limits = strut_json_object(json, root, "step_limits");
  for (size_t i = 0; strut_integrator_at(i) && estimate->runnable; i++)
    strut_json_number(json, limits, strut_integrator_at(i)->name,
                      strut_step_limit_of_method(&estimate->limits, strut_integrator_at(i)));
}

static void add_terms(strut_json *json, const strut_cost_estimate *estimate) {
  struct cJSON *terms = strut_json_object(json, json->root, "terms");
  for (int i = 0; i < STRUT_COST_TERMS; i++) {
    strut_json_bool(json, terms, estimate->terms[i].name, estimate->terms[i].in);
  }
}

/* What a plain member has not: guides, a law, stops. */
static void add_extras(strut_json *json, struct cJSON *row, const strut_model *model, size_t j) {
  const strut_scene *scene = model->scene;
  const strut_member *m = &scene->members[j];
  if (m->guide_count) {
    struct cJSON *nodes = strut_json_array(json, row, "nodes");
    for (size_t k = 0; k < m->guide_count + 2; k++)
      strut_json_text(json, nodes, NULL, scene->nodes[strut_member_node(m, k)].name);
  }
  if (m->law.kind != STRUT_LAW_LINEAR || m->law.carries != STRUT_CARRIES_BOTH) {
    strut_json_text(json, row, "law", strut_law_at(m->law.kind)->word);
    strut_json_text(json, row, "carries", carries_name(m));
  }
  if (m->guide_friction > 0.0) strut_json_number(json, row, "guide_friction", m->guide_friction);
  if (m->guide_radius > 0.0) strut_json_number(json, row, "guide_radius", m->guide_radius);
  if (m->breaks_at > 0.0) strut_json_number(json, row, "breaks_at", m->breaks_at);
  if (m->released_at > 0.0) strut_json_number(json, row, "released_at", m->released_at);
  if (m->shortest > 0.0) strut_json_number(json, row, "shortest", m->shortest);
  if (m->longest > 0.0) strut_json_number(json, row, "longest", m->longest);
  if (m->shortest > 0.0 || m->longest > 0.0)
    strut_json_number(json, row, "stop_stiffness", stop_stiffness(model, j));
}

static void add_hinges(strut_json *json, const strut_model *model, const double *q) {
  const strut_scene *scene = model->scene;
  struct cJSON *hinges = strut_json_object(json, json->root, "hinges");
  for (size_t i = 0; i < scene->hinge_count; i++) {
    double stiffness;
    strut_element_pose pose = describe_hinge(model, q, i, &stiffness);
    struct cJSON *row = strut_json_object(json, hinges, scene->hinges[i].name);
    strut_json_number(json, row, "drawn_angle", pose.strain);
    strut_json_number(json, row, "rest_angle", pose.natural);
    strut_json_number(json, row, "moment", pose.force);
    strut_json_number(json, row, "stiffness", stiffness);
    const strut_hinge *h = &scene->hinges[i];
    if (h->breaks_at > 0.0) strut_json_number(json, row, "breaks_at", h->breaks_at);
    if (h->released_at > 0.0) strut_json_number(json, row, "released_at", h->released_at);
  }
}

static void add_cells(strut_json *json, const strut_scene *scene) {
  struct cJSON *cells = strut_json_object(json, json->root, "cells");
  for (size_t i = 0; i < scene->cell_count; i++) {
    struct cJSON *row = strut_json_object(json, cells, scene->cells[i].name);
    strut_json_number(json, row, "drawn_area", fabs(strut_cell_drawn(scene, i)));
    strut_json_number(json, row, "pressure", scene->cells[i].pressure);
    strut_json_number(json, row, "outside", scene->cells[i].outside);
    strut_json_text(json, row, "content", cell_content(&scene->cells[i]));
  }
}

static void add_collisions(strut_json *json, const strut_model *model, const double *q) {
  const strut_scene *scene = model->scene;
  struct cJSON *collisions = strut_json_object(json, json->root, "collisions");
  for (size_t i = 0; i < scene->collision_count; i++) {
    const strut_collision *c = &scene->collisions[i];
    struct cJSON *row = strut_json_object(json, collisions, c->name);
    strut_json_number(json, row, "thickness", c->thickness);
    strut_json_number(json, row, "drawn_gap", drawn_gap(model, q, i));
    strut_json_number(json, row, "stiffness", c->stiffness);
    strut_json_number(json, row, "damping", c->damping);
  }
}

static void add_distances(strut_json *json, const strut_model *model) {
  const strut_scene *scene = model->scene;
  if (!scene->distance_count) return;
  struct cJSON *distances = strut_json_object(json, json->root, "distances");
  for (size_t i = 0; i < scene->distance_count; i++) {
    const strut_distance_spring *d = &scene->distances[i];
    struct cJSON *row = strut_json_object(json, distances, d->name);
    strut_json_number(json, row, "drawn", strut_distance_drawn(scene, i));
    strut_json_number(json, row, "rest", strut_distance_rest(scene, i));
    strut_json_number(json, row, "stiffness", distance_stiffness(model, i));
    strut_json_number(json, row, "damping", d->damping);
    strut_json_text(json, row, "law", strut_law_at(d->law.kind)->word);
  }
}

static void add_members(strut_json *json, const strut_model *model, const double *q) {
  const strut_scene *scene = model->scene;
  struct cJSON *members = strut_json_object(json, json->root, "members");
  for (size_t i = 0; i < scene->member_count; i++) {
    strut_rest rest;
    const strut_member *member = &scene->members[i];
    if (!describe_member(model, q, i, &rest)) continue;
    struct cJSON *row = strut_json_object(json, members, member->name);
    strut_json_text(json, row, "kind", strut_member_kind_name(member->kind));
    strut_json_number(json, row, "drawn_length", rest.drawn_length);
    strut_json_number(json, row, "rest_length", rest.length);
    strut_json_number(json, row, "rest_length_ratio", rest.ratio);
    strut_json_number(json, row, "pretension", rest.pretension);
    strut_json_number(json, row, "force_density", rest.force_density);
    strut_json_number(json, row, "stiffness", rest.stiffness);
    add_extras(json, row, model, i);
  }
}

static bool add_warnings(strut_json *json, const strut_setup *setup, strut_open_report *report) {
  strut_findings found = {0};
  strut_status status = strut_setup_warn(setup, &found);
  struct cJSON *warnings = strut_json_array(json, json->root, "warnings");
  for (size_t i = 0; i < found.count; i++) {
    struct cJSON *warning = strut_json_object(json, warnings, NULL);
    strut_json_text(json, warning, "code", found.items[i].key);
    strut_json_text(json, warning, "text", found.items[i].message);
  }
  struct cJSON *messages = strut_json_array(json, json->root, "messages");
  strut_add_diagnostics(json, messages, &report->diagnostics);
  strut_add_warnings(json, messages, &found, &setup->scene, &report->diagnostics);
  strut_findings_free(&found);
  return status == STRUT_OK;
}

static strut_status print_json(const strut_cost_estimate *estimate, const strut_model *model,
                               const strut_setup *setup, strut_open_report *report) {
  double *q = drawn_shape(model);
  if (!q) return strut_print_out_of_memory();
  strut_json json = strut_json_begin();
  strut_json_bool(&json, json.root, "valid", true);
  add_estimate(&json, estimate, setup);
  add_terms(&json, estimate);
  add_members(&json, model, q);
  add_hinges(&json, model, q);
  add_cells(&json, model->scene);
  add_collisions(&json, model, q);
  add_distances(&json, model);
  strut_release(q);
  if (!add_warnings(&json, setup, report)) json.failed = true;
  return strut_print_block(strut_json_end(&json));
}

/* Does the scene fix the method of a run? If not, it is for statics, or --accuracy chooses. */
static bool has_fixed_method(const strut_experiment *e) {
  bool by_hand = !(e->accuracy > 0.0);
  return by_hand && (e->step != 0.0 || e->duration != 0.0 || e->periods != 0.0);
}

/* What is wrong, as JSON; returns `status`. */
static strut_status print_wrong(strut_status status, const strut_error *error,
                                strut_open_report *report) {
  strut_json json = strut_json_begin();
  strut_json_bool(&json, json.root, "valid", false);
  struct cJSON *messages = strut_json_array(&json, json.root, "messages");
  strut_add_diagnostics(&json, messages, &report->diagnostics);
  if (error->message[0])
    strut_add_message(&json, messages, report->diagnostics.file, "error", error->message);
  strut_json_integer(&json, json.root, "unlisted", (int64_t)report->diagnostics.unstored);
  strut_status printed = strut_print_block(strut_json_end(&json));
  return printed != STRUT_OK ? printed : status;
}

static strut_status open_checked(const strut_arguments *arguments, strut_setup *setup,
                                 strut_open_report *report) {
  if (!arguments->json) return strut_open_model(arguments, STRUT_OPEN_AS_RUN, setup);
  strut_status status = strut_open_model_reported(arguments, STRUT_OPEN_AS_RUN, setup, report);
  bool located = status == STRUT_BAD_SCENE && report->diagnostics.count;
  if (located || report->error.message[0]) return print_wrong(status, &report->error, report);
  return status; /* what is not about the scene was printed */
}

static strut_status check_model(const strut_arguments *arguments, strut_open_report *report) {
  strut_setup setup;
  strut_cost_estimate estimate;
  strut_model *model = NULL;
  strut_error error = {0};
  strut_status status = open_checked(arguments, &setup, report);
  if (status != STRUT_OK) return status;
  status = strut_run_options_apply(&strut_command_check, arguments, &setup);
  if (status != STRUT_OK) {
    strut_setup_free(&setup);
    return status;
  }
  status = strut_model_compile(&setup.scene, &model, &error);
  if (status == STRUT_OK && has_fixed_method(&setup.experiment))
    status = strut_integrator_check(model, &setup.experiment, &error);
  if (status == STRUT_OK) status = strut_cost_estimate_describe(model, &estimate, &error);
  if (status == STRUT_OK) print_bands(model, &setup.experiment);
  if (status == STRUT_OK && (status = strut_warn_of_scene(&setup))) {
    /* reported already */
  } else if (status != STRUT_OK) {
    if (arguments->json && error.message[0])
      status = print_wrong(status, &error, report);
    else
      strut_print_error(&error);
  } else if (arguments->json) {
    status = print_json(&estimate, model, &setup, report);
  } else if (!arguments->quiet) {
    status = print_estimate(&estimate, model, &setup.experiment, arguments->verbose);
  }
  strut_model_free(model);
  strut_setup_free(&setup);
  return status;
}

static strut_status run_check(const strut_arguments *arguments) {
  strut_open_report report = {.text = NULL};
  if (strut_is_study(arguments->model)) return strut_check_study(&strut_command_check, arguments);
  strut_status status = check_model(arguments, &report);
  strut_open_report_free(&report);
  return status;
}

static const strut_refused_option refused[] = {
    {"plot", "'strut view' and 'strut run --plot' draw a model"},
    {"output", "it only prints; --json prints everything"},
    {"threads", "nothing takes long enough"},
    {NULL, NULL}};

const strut_command strut_command_check = {
    .name = "check",
    .model = "MODEL",
    .summary = "validates a model and describes what a run of it computes",
    .details =
        "\nPrints the numbers of nodes and members, the terms of the equations that a step "
        "evaluates and\n"
        "those it omits, the largest stable step, and for each member its rest length in each of "
        "the\n"
        "four forms that the language accepts. Running cables, laws, stops and hinges have tables "
        "of\n"
        "their own.\n"
        "--json lists all messages with their places, for editors; a study is checked, too.\n",
    .options = options,
    .run = run_check,
    .refused = refused,
};
