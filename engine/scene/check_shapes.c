/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about configurations and the search for equilibria. See check.h. */
#include <math.h>
#include <stdio.h>

#include "engine/scene/check_rules.h"

/* State for checking sets of contact nodes. */
typedef struct sets_check {
  strut_checker *checker;
  bool *touches;   /* (node_count) may touch the ground */
  uint64_t *stamp; /* (node_count) the last set that contains it */
  uint64_t now;
} sets_check;

/* Checks one set; the finding is about `subject`, `index`, `key`. False: it is invalid. */
static bool check_set(sets_check *check, const strut_node_set *set, strut_subject subject,
                      size_t index, const char *key, const char *owner) {
  strut_checker *checker = check->checker;
  const strut_scene *scene = checker->scene;
  check->now++;
  if (!set->count) {
    strut_report_finding(checker, subject, index, key, "the %s of %s have an empty list", key,
                         owner);
    return false;
  }
  for (size_t i = 0; i < set->count; i++) {
    int32_t n = set->node[i];
    if (n < 0 || (size_t)n >= scene->node_count) {
      strut_report_finding(checker, subject, index, key,
                           "the %s of %s name a node that does not exist", key, owner);
      return false;
    }
    char node[200];
    strut_format_name(node, "node", scene->nodes[n].name, (size_t)n);
    bool twice = check->stamp[n] == check->now;
    check->stamp[n] = check->now;
    if (check->touches[n] && !twice) continue;
    strut_report_finding(checker, subject, index, key,
                         twice ? "the %s of %s name %s twice"
                               : "the %s of %s name %s, but 'nodes' of the ground lacks it",
                         key, owner, node);
    return false;
  }
  return true;
}

static void check_sets(sets_check *check, const strut_node_set *sets, size_t count,
                       strut_subject subject, size_t index, const char *key, const char *owner) {
  const strut_scene *scene = check->checker->scene;
  if (count && scene->ground_count && subject == STRUT_ON_EQUILIBRIA) {
    strut_report_finding(check->checker, subject, index, key,
                         "the %s of %s take the place of one straight line at rest, and the scene "
                         "has other grounds; leave them out",
                         key, owner);
    return;
  }
  if (count && !strut_scene_has_ground(scene)) {
    strut_report_finding(check->checker, subject, index, key,
                         "the %s of %s need a ground to rest on, and the scene has none", key,
                         owner);
    return;
  }
  for (size_t i = 0; i < count; i++)
    if (!check_set(check, &sets[i], subject, index, key, owner)) return;
}

static void check_positions(strut_checker *checker, size_t index, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_configuration *c = &scene->configurations[index];
  for (size_t i = 0; i < scene->node_count; i++) {
    const double *drawn = scene->nodes[i].position;
    if (isfinite(c->position[i][0]) && isfinite(c->position[i][1])) continue;
    if (!isfinite(drawn[0]) || !isfinite(drawn[1])) continue; /* reported at the node */
    char node[200];
    strut_report_finding(checker, STRUT_ON_CONFIGURATION, index, NULL,
                         "the position of %s in %s is not finite",
                         strut_format_name(node, "node", scene->nodes[i].name, i), owner);
    return;
  }
}

static void check_search(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_search *search = &checker->experiment->search;
  if (search->starts < 0 || search->starts > STRUT_MOST_STARTS)
    strut_report_finding(checker, STRUT_ON_EQUILIBRIA, 0, "starts",
                         "the starts of the search for equilibria must be from 0 to %d",
                         STRUT_MOST_STARTS);
  if ((double)search->seed > STRUT_MOST_SEED)
    strut_report_finding(checker, STRUT_ON_EQUILIBRIA, 0, "seed",
                         "the seed of the search for equilibria must be at most %.0f",
                         STRUT_MOST_SEED);
  if (scene->start_equilibrium < -1 ||
      (scene->start_equilibrium >= 0 &&
       (size_t)scene->start_equilibrium >= scene->configuration_count))
    strut_report_finding(
        checker, STRUT_ON_INITIAL, 0, NULL,
        "the initial state is the equilibrium of a configuration that does not exist");
  else if (scene->start_equilibrium >= 0 && checker->experiment->settle.wanted)
    strut_report_finding(checker, STRUT_ON_INITIAL, 0, NULL,
                         "the initial state is an equilibrium, so there is nothing to settle");
}

void strut_check_shapes(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  sets_check check = {.checker = checker};
  check.touches = strut_allocate(scene->node_count, sizeof *check.touches);
  check.stamp = strut_allocate(scene->node_count, sizeof *check.stamp);
  if (!check.touches || !check.stamp) checker->out_of_memory = true;
  for (size_t i = 0; !checker->out_of_memory && i < scene->contact_count; i++) {
    int32_t node = scene->contacts[i].node;
    if (node >= 0 && (size_t)node < scene->node_count) check.touches[node] = true;
  }
  for (size_t i = 0; !checker->out_of_memory && i < scene->configuration_count; i++) {
    const strut_configuration *c = &scene->configurations[i];
    char owner[200];
    strut_format_name(owner, "configuration", c->name, i);
    check_positions(checker, i, owner);
    check_sets(&check, c->sets, c->set_count, STRUT_ON_CONFIGURATION, i, "contacts", owner);
  }
  if (!checker->out_of_memory) {
    const strut_search *search = &checker->experiment->search;
    check_sets(&check, search->supports, search->support_count, STRUT_ON_EQUILIBRIA, 0, "supports",
               "the search for equilibria");
    check_search(checker);
  }
  strut_release(check.touches);
  strut_release(check.stamp);
}
