/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/report/rigidity_report.h"

#include <math.h>

#include "engine/output/json_value.h"
#include "engine/output/report/rigidity_words.h"

/* Forces by member, or force densities where lengths are given. */
static void add_map(strut_json *json, struct cJSON *to, const char *key, const strut_scene *scene,
                    const double *force, const double *length) {
  struct cJSON *map = strut_json_object(json, to, key);
  for (size_t j = 0; j < scene->member_count; j++) {
    double divisor = !length ? 1.0 : length[j];
    strut_json_number(json, map, scene->members[j].name, divisor > 0 ? force[j] / divisor : 0.0);
  }
}

static void add_head(strut_json *json, const strut_rigidity *r, const strut_model *model,
                     const char *at) {
  const strut_scene *scene = model->scene;
  struct cJSON *root = json->root;
  strut_json_text(json, root, "name", scene->name);
  strut_json_text(json, root, "strut_version", STRUT_VERSION);
  strut_json_text(json, root, "at", at);
  strut_json_integer(json, root, "nodes", (int64_t)scene->node_count);
  strut_json_integer(json, root, "members", (int64_t)scene->member_count);
  strut_json_integer(json, root, "free_coordinates", r->matrix.rows);
  strut_json_integer(json, root, "supports", 2 * model->node_count - r->matrix.rows);
  strut_json_text(json, root, "method", r->spaces.dense ? "svd" : "qr");
  strut_json_number(json, root, "tolerance", STRUT_RANK_TOLERANCE);
  strut_json_integer(json, root, "rank", r->spaces.rank);
  strut_json_number(json, root, "largest", r->spaces.largest);
  strut_json_number(json, root, "kept", r->spaces.kept);
  strut_json_number(json, root, "dropped", r->spaces.dropped);
  strut_json_integer(json, root, "weak", r->spaces.weak);
  strut_json_integer(json, root, "without_length", r->without_length);
}

static void add_self_stress(strut_json *json, const strut_rigidity *r, const strut_scene *scene) {
  struct cJSON *stress = strut_json_object(json, json->root, "self_stress");
  size_t members = scene->member_count;
  strut_json_integer(json, stress, "count", r->states.count);
  if (r->states.count > 0 && !r->states.force) {
    strut_json_text(json, stress, "states", NULL);
    return;
  }
  struct cJSON *states = strut_json_array(json, stress, "states");
  for (int32_t i = 0; i < r->states.count; i++) {
    const double *force = r->states.force + (size_t)i * members;
    struct cJSON *state = strut_json_object(json, states, NULL);
    add_map(json, state, "forces", scene, force, NULL);
    add_map(json, state, "force_densities", scene, force, r->matrix.length);
    strut_json_bool(json, state, "feasible", r->states.cables_pull[i]);
  }
  if (r->states.count == 0) return;
  if (r->feasible)
    add_map(json, stress, "feasible", scene, r->feasible, NULL);
  else
    strut_json_text(json, stress, "feasible", NULL);
}

/* Scaled so that the node that moves most moves by 1. */
static void add_motion(strut_json *json, struct cJSON *to, const strut_rigidity *r,
                       const strut_scene *scene, const double *motion) {
  struct cJSON *nodes = strut_json_object(json, to, "nodes");
  double largest = 0.0;
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < scene->node_count; i++) {
      double d[2];
      for (size_t k = 0; k < 2; k++) {
        int32_t row = r->matrix.row_of[2 * i + k];
        d[k] = row < 0 ? 0.0 : motion[row];
        if (pass == 1 && largest > 0) d[k] = fabs(d[k]) < 1e-13 * largest ? 0.0 : d[k] / largest;
      }
      if (pass == 0)
        largest = fmax(largest, hypot(d[0], d[1]));
      else
        strut_json_numbers(json, nodes, scene->nodes[i].name, d, 2);
    }
}

static void add_mechanisms(strut_json *json, const strut_rigidity *r, const strut_scene *scene) {
  const strut_mechanisms *m = &r->mechanisms;
  struct cJSON *to = strut_json_object(json, json->root, "mechanisms");
  strut_json_integer(json, to, "count", m->count);
  strut_json_integer(json, to, "rigid_body", m->rigid_body);
  strut_json_integer(json, to, "infinitesimal", m->infinitesimal);
  strut_json_integer(json, to, "finite", m->finite);
  strut_json_integer(json, to, "undecided", m->undecided);
  if (m->count > 0 && !m->list) {
    strut_json_text(json, to, "modes", NULL);
    return;
  }
  struct cJSON *modes = strut_json_array(json, to, "modes");
  for (int32_t i = 0; i < m->count; i++) {
    const strut_mechanism *mode = &m->list[i];
    char words[STRUT_RIGIDITY_WORDS];
    struct cJSON *row = strut_json_object(json, modes, NULL);
    strut_json_text(json, row, "kind", strut_motion_kind_name(mode->kind));
    strut_json_number(json, row, "stiffness", mode->stiffness);
    strut_json_number(json, row, "stress_form", mode->stress_form);
    strut_json_number(json, row, "moved", mode->moved);
    strut_json_number(json, row, "strain", mode->strain);
    strut_json_text(json, row, "test", strut_mechanism_words(m, mode, words));
    add_motion(json, row, r, scene, mode->motion);
  }
  if (m->stiffener) add_map(json, to, "stiffened_by", scene, m->stiffener, NULL);
}

static void add_verdicts(strut_json *json, const strut_rigidity *r) {
  char words[STRUT_RIGIDITY_WORDS];
  struct cJSON *root = json->root;
  struct cJSON *count = strut_json_object(json, root, "maxwell_calladine");
  strut_json_integer(json, count, "members_minus_coordinates", r->matrix.columns - r->matrix.rows);
  strut_json_integer(json, count, "self_stress_minus_mechanisms",
                     r->states.count - r->mechanisms.count);
  strut_json_integer(json, root, "class", r->bars_at_node > 1 ? r->bars_at_node : 1);
  /* of several states another combination might do it */
  bool single = r->states.count <= 1;
  bool known = r->states.count == 0 || (r->stress.tested && (single || r->stress.super_stable));
  if (known)
    strut_json_bool(json, root, "super_stable", r->stress.super_stable);
  else
    strut_json_text(json, root, "super_stable", NULL);
  strut_json_text(json, root, "super_stability", strut_super_stability_words(r, words));
  if (r->stress.tested) {
    struct cJSON *stress = strut_json_object(json, root, "stress_matrix");
    strut_json_numbers(json, stress, "eigenvalues", r->stress.eigenvalues, (size_t)r->stress.count);
    strut_json_integer(json, stress, "nullity", r->stress.nullity);
    strut_json_text(json, stress, "of", strut_stress_source_words(r->source));
    strut_json_text(json, stress, "on", r->stress.supported ? "free coordinates" : "nodes");
  } else {
    strut_json_text(json, root, "stress_matrix", NULL);
  }
}

static void add_tensegrity(strut_json *json, const strut_tensegrity *t) {
  struct cJSON *to = strut_json_object(json, json->root, "classification");
  strut_json_text(json, to, "label", t->label);
  strut_json_bool(json, to, "self_stress", t->self_stress);
  strut_json_bool(json, to, "cables", t->cables);
  strut_json_bool(json, to, "stiffened_mechanism", t->mechanism);
  strut_json_bool(json, to, "all_states_stiffen", t->all_states);
  strut_json_bool(json, to, "struts_apart", t->struts_apart);
  strut_json_bool(json, to, "struts_inside", t->struts_inside);
}

static void add_members(strut_json *json, const strut_rigidity *r, const strut_scene *scene) {
  strut_json_bool(json, json->root, "equilibrium", r->equilibrium);
  strut_json_number(json, json->root, "residual", r->residual);
  strut_json_bool(json, json->root, "self_equilibrium", r->self_equilibrium);
  struct cJSON *members = strut_json_object(json, json->root, "members_at");
  for (size_t j = 0; j < scene->member_count; j++) {
    struct cJSON *row = strut_json_object(json, members, scene->members[j].name);
    strut_json_text(json, row, "kind", strut_member_kind_words(scene->members[j].kind));
    strut_json_number(json, row, "length", r->matrix.length[j]);
    strut_json_number(json, row, "force", r->force[j]);
    strut_json_number(json, row, "force_density",
                      r->matrix.length[j] > 0 ? r->density[j] : (double)NAN);
  }
}

char *strut_rigidity_json(const strut_rigidity *rigidity, const strut_model *model,
                          const char *at) {
  strut_json json = strut_json_begin();
  add_head(&json, rigidity, model, at);
  add_self_stress(&json, rigidity, model->scene);
  add_mechanisms(&json, rigidity, model->scene);
  add_verdicts(&json, rigidity);
  add_tensegrity(&json, &rigidity->tensegrity);
  add_members(&json, rigidity, model->scene);
  return strut_json_end(&json);
}
