/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about the ground, and about shapes on it. See check.h. */
#include <math.h>
#include <stdio.h>

#include "engine/scene/checks/check_rules.h"
#include "engine/scene/profile.h"
#include "engine/scene/signal_program.h"

/* ---- grounds and contacts ---- */

static const double QUARTER_TURN = 1.57079632679489661923;

/* What keeps a contact from being an element that rubs, with the name of its ground; or NULL. */
static const char *fault_of_ground(const strut_scene *scene, const strut_contact *contact) {
  const strut_ground *ground =
      scene->ground_count ? &scene->grounds[contact->ground] : &scene->ground;
  const strut_friction *friction = &contact->friction;
  return ground->shape != STRUT_GROUND_LINE     ? "needs a straight ground, and '%s' is none"
         : ground->moves[0] || ground->moves[1] ? "needs a ground at rest, and '%s' is shaken"
         : ground->damping_law != STRUT_DAMPING_APPROACH
             ? "has no dissipation of Hunt and Crossley, as ground '%s' wants it"
         : friction->law == STRUT_FRICTION_COULOMB
             ? "has no friction that sticks exactly, as ground '%s' wants it; use karnopp or smooth"
         : friction->law != STRUT_FRICTION_NONE && friction->directional
             ? "rubs in both directions alike, unlike ground '%s'"
             : NULL;
}

/* Reports it of a subject that rubs there. */
static void report_ground(strut_checker *checker, const strut_contact *contact) {
  const strut_scene *scene = checker->scene;
  const char *fault = fault_of_ground(scene, contact);
  const char *name = scene->ground_count ? scene->grounds[contact->ground].name : NULL;
  if (!name || !*name) name = "ground";
  char what[240];
  if (!fault) return;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
  snprintf(what, sizeof what, fault, name);
#pragma GCC diagnostic pop
  strut_fault(checker, NULL, "%s", what);
}

static void check_friction(strut_checker *checker) {
  const strut_friction *friction = &checker->scene->contacts[checker->index].friction;
  if ((unsigned)friction->law >= STRUT_FRICTION_LAW_COUNT) {
    strut_fault_of(checker, "law", "the friction law of %s is unknown", checker->owner);
    return;
  }
  const strut_friction none = {0};
  const strut_scene *scene = checker->scene;
  const char *fault = !friction->driven ? NULL
                      : !strut_exists(friction->signal, scene->signal_count)
                          ? "which does not exist"
                      : friction->directional ? "which cannot depend on the direction, too"
                      : scene->foot_count     ? "which feet that roll do not know"
                      : strut_friction_has_bristles(friction->law) ? "which bristles do not know"
                      : !scene->ground_count ? "which needs its ground in the list of grounds"
                                             : NULL;
  if (fault)
    strut_fault_of(checker, "mu", "the friction of %s follows a signal, %s", checker->owner, fault);
  strut_check_fields(checker, STRUT_FIELDS_FRICTION, friction, &none);
  if (strut_friction_has_bristles(friction->law) && friction->mu_static == 0.0 &&
      friction->mu_kinetic > 0.0)
    strut_fault_of(checker, "mu_static",
                   "the friction of %s has bristles that hold nothing: its mu_static is 0, but "
                   "its mu_kinetic is not",
                   checker->owner);
  if (strut_friction_holds_too_little(friction))
    strut_fault_of(checker, "mu_static",
                   "the friction of %s has static friction below kinetic friction", checker->owner);
  for (int p = 0; p < STRUT_FRICTION_PARAMETER_COUNT; p++)
    if (strut_friction_needs(friction->law, p) && strut_friction_value(friction, p) == 0.0)
      strut_check_number(checker, STRUT_FIELDS_FRICTION, strut_friction_key(p), 0.0);
}

static void check_line(strut_checker *checker) {
  const strut_ground *ground = &checker->scene->grounds[checker->index];
  strut_check_number(checker, STRUT_FIELDS_GROUND, "height", ground->height);
  strut_check_number(checker, STRUT_FIELDS_GROUND, "slope", ground->slope);
  for (int c = 0; c < 2; c++)
    strut_check_number(checker, STRUT_FIELDS_GROUND, "through", ground->through[c]);
  if (!ground->placed && fabs(cos(ground->slope)) < 1e-12)
    strut_fault(checker, "slope",
                "is upright, so that it has no height at x = 0; give a point of it, "
                "through: [x, y]");
}

static void check_profile(strut_checker *checker) {
  size_t segment, other;
  strut_profile_fault fault =
      strut_profile_check(&checker->scene->grounds[checker->index], &segment, &other);
  switch (fault) {
    case STRUT_PROFILE_FINE: break;
    case STRUT_PROFILE_NO_MEMORY: checker->out_of_memory = true; break;
    case STRUT_PROFILE_SHORT:
      strut_fault_of(checker, "profile", "the profile of %s needs at least two points",
                     checker->owner);
      break;
    case STRUT_PROFILE_POINT:
      strut_fault_of(checker, "profile", "point %zu of the profile of %s is not finite",
                     segment + 1, checker->owner);
      break;
    case STRUT_PROFILE_ZERO:
      strut_fault_of(checker, "profile", "points %zu and %zu of the profile of %s are one point",
                     segment + 1, segment + 2, checker->owner);
      break;
    case STRUT_PROFILE_BACK:
      strut_fault_of(checker, "profile", "the profile of %s turns back onto itself at point %zu",
                     checker->owner, segment + 1);
      break;
    case STRUT_PROFILE_CROSSES:
      strut_fault_of(checker, "profile",
                     "the profile of %s crosses itself: its segments %zu and %zu meet; its "
                     "ends continue straight",
                     checker->owner, other + 1, segment + 1);
      break;
  }
}

/* A displacement that jumps would take the ground through nodes. */
static void check_motion(strut_checker *checker) {
  const strut_ground *ground = &checker->scene->grounds[checker->index];
  char what[240];
  for (int c = 0; c < 2; c++) {
    if (!ground->moves[c]) continue;
    snprintf(what, sizeof what, "the motion of %s in %c", checker->owner, "xy"[c]);
    strut_check_motion(checker, "motion", ground->motion[c], what, "ground");
  }
}

static void check_grounds(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  if (scene->ground.present) strut_fault_of(checker, NULL, "there are both a ground and grounds");
  for (size_t i = 0; i < scene->ground_count; i++) {
    const strut_ground *ground = &scene->grounds[i];
    bool single = scene->ground_count == 1 && !(ground->name && *ground->name), used = false;
    strut_check_begin(checker, STRUT_THING_GROUND, i);
    if (single) strut_check_begin_with(checker, STRUT_ON_GROUND, i, "the ground");
    strut_check_number(checker, STRUT_FIELDS_GROUND, "belt_speed", ground->belt_speed);
    if ((unsigned)ground->damping_law >= STRUT_DAMPING_COUNT)
      strut_fault_of(checker, "damping_law", "the damping law of %s is unknown", checker->owner);
    switch (ground->shape) {
      case STRUT_GROUND_LINE: check_line(checker); break;
      case STRUT_GROUND_PROFILE: check_profile(checker); break;
      case STRUT_GROUND_CIRCLE:
        checker->within = "circle";
        for (int c = 0; c < 2; c++)
          strut_check_number(checker, STRUT_FIELDS_CIRCLE, "centre", ground->centre[c]);
        strut_check_number(checker, STRUT_FIELDS_CIRCLE, "radius", ground->radius);
        checker->within = NULL;
        break;
    }
    check_motion(checker);
    for (size_t k = 0; k < scene->contact_count; k++)
      used = used || scene->contacts[k].ground == (int32_t)i;
    if (!used) strut_fault_of(checker, "nodes", "no node may touch %s", checker->owner);
  }
}

/* Contacts follow their nodes, then grounds, then pieces, one of each. */
static bool follows(const strut_contact *before, const strut_contact *contact) {
  if (contact->node != before->node) return contact->node > before->node;
  if (contact->ground != before->ground) return contact->ground > before->ground;
  return contact->piece > before->piece;
}

/* Pieces of each ground; of a profile with faults, which are reported, any number. */
static size_t *count_pieces(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  size_t *pieces = strut_allocate(scene->ground_count + 1, sizeof *pieces), segment, other;
  if (!pieces) checker->out_of_memory = true;
  for (size_t i = 0; i < scene->ground_count && pieces; i++) {
    const strut_ground *ground = &scene->grounds[i];
    bool faulty =
        ground->shape == STRUT_GROUND_PROFILE && strut_profile_check(ground, &segment, &other);
    pieces[i] = faulty ? SIZE_MAX : strut_ground_pieces(ground);
  }
  return pieces;
}

static bool has_surface(const strut_scene *scene, const strut_contact *contact,
                        const size_t *pieces) {
  if (!scene->ground_count) return contact->ground == 0 && contact->piece == 0;
  return strut_exists(contact->ground, scene->ground_count) &&
         strut_exists(contact->piece, pieces[contact->ground]);
}

static void check_contacts(strut_checker *checker, const size_t *pieces) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->contact_count; i++) {
    const strut_contact *contact = &scene->contacts[i];
    strut_check_begin(checker, STRUT_THING_CONTACT, i);
    if (contact->node < 0 || (size_t)contact->node >= scene->node_count) {
      strut_fault_of(checker, NULL, "contact number %zu is of a node that does not exist", i + 1);
      continue;
    }
    strut_format_name(checker->owner, "the contact of node", scene->nodes[contact->node].name,
                      (size_t)contact->node);
    if (i && !follows(&scene->contacts[i - 1], contact))
      strut_fault(checker, NULL,
                  "is out of order: contacts follow their nodes, one for each at most");
    bool again = i && scene->contacts[i - 1].node == contact->node &&
                 scene->contacts[i - 1].ground == contact->ground;
    if (!has_surface(scene, contact, pieces))
      strut_fault(checker, NULL, "is with a ground, or a piece of one, that does not exist");
    else if ((unsigned)contact->friction.law < STRUT_FRICTION_LAW_COUNT &&
             strut_friction_has_bristles(contact->friction.law) && !again)
      report_ground(checker, contact);
    strut_check_fields(checker, STRUT_FIELDS_CONTACT, contact, NULL);
    check_friction(checker);
  }
}

void strut_check_ground(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_ground *ground = &scene->ground;
  strut_check_begin_with(checker, STRUT_ON_GROUND, 0, "the ground");
  strut_check_number(checker, STRUT_FIELDS_GROUND, "height", ground->height);
  strut_check_number(checker, STRUT_FIELDS_GROUND, "belt_speed", ground->belt_speed);
  if (!(fabs(ground->slope) < QUARTER_TURN))
    strut_fault_of(
        checker, "slope",
        "the slope of the ground must lie between -90 deg and 90 deg, found %g deg; a line at any "
        "angle needs a point, through: [x, y]",
        ground->slope / QUARTER_TURN * 90.0);
  if ((unsigned)ground->damping_law >= STRUT_DAMPING_COUNT)
    strut_fault_of(checker, "damping_law", "the ground's damping law is unknown");
  if (ground->present && !scene->contact_count)
    strut_fault_of(checker, "nodes", "no node may touch the ground");
  if (scene->ground_count) check_grounds(checker);
  if (!strut_scene_has_ground(scene) && scene->contact_count)
    strut_fault_of(checker, NULL, "there are contacts but no ground");
  size_t *pieces = count_pieces(checker);
  if (pieces) check_contacts(checker, pieces);
  strut_release(pieces);
}

/* ---- feet ---- */

static bool check_foot(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_foot *foot = &scene->feet[checker->index];
  if (!strut_exists(foot->member, scene->member_count) ||
      !strut_exists(foot->node, scene->node_count))
    return strut_fault(checker, "member", "is at a member or a node that does not exist");
  if (checker->loose[foot->member]) return false; /* it is reported there */
  const strut_member *m = &scene->members[foot->member];
  const char *member = m->name, *node = scene->nodes[foot->node].name;
  if (m->node[0] != foot->node && m->node[1] != foot->node)
    return strut_fault(checker, "node", "is at node '%s', which is no end of member '%s'", node,
                       member);
  if (m->guide_count)
    return strut_fault(checker, "member", "is at a running cable; a foot needs a straight member");
  return true;
}

void strut_check_feet(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->foot_count; i++) {
    const strut_foot *foot = &scene->feet[i];
    bool touches = false;
    strut_check_begin(checker, STRUT_THING_FOOT, i);
    if (!strut_check_fields(checker, STRUT_FIELDS_FOOT, foot, NULL) || !check_foot(checker))
      continue;
    for (size_t k = 0; k < i; k++)
      if (scene->feet[k].node == foot->node)
        strut_fault_of(checker, "node", "node '%s' has a foot already, '%s'",
                       scene->nodes[foot->node].name, scene->feet[k].name);
    for (size_t k = 0; k < scene->contact_count; k++) {
      const strut_contact *contact = &scene->contacts[k];
      if (contact->node != foot->node) continue;
      touches = true;
      report_ground(checker, contact);
    }
    if (!touches)
      strut_fault(checker, "node", "is at node '%s', which may touch no ground",
                  scene->nodes[foot->node].name);
  }
}

/* ---- configurations and the search for equilibria ---- */

/* State for checking sets of contact nodes. */
typedef struct sets_check {
  strut_checker *checker;
  bool *touches;   /* (node_count) may touch the ground */
  uint64_t *stamp; /* (node_count) the last set that contains it */
  uint64_t now;
} sets_check;

/* Checks one set, of this key. False: it is invalid. */
static bool check_set(sets_check *check, const strut_node_set *set, const char *key) {
  strut_checker *checker = check->checker;
  const strut_scene *scene = checker->scene;
  check->now++;
  if (!set->count)
    return strut_fault_of(checker, key, "the %s of %s have an empty list", key, checker->owner);
  for (size_t i = 0; i < set->count; i++) {
    int32_t n = set->node[i];
    if (n < 0 || (size_t)n >= scene->node_count)
      return strut_fault_of(checker, key, "the %s of %s name a node that does not exist", key,
                            checker->owner);
    char node[200];
    strut_format_name(node, "node", scene->nodes[n].name, (size_t)n);
    bool twice = check->stamp[n] == check->now;
    check->stamp[n] = check->now;
    if (check->touches[n] && !twice) continue;
    return strut_fault_of(checker, key,
                          twice ? "the %s of %s name %s twice"
                                : "the %s of %s name %s, but 'nodes' of the ground lacks it",
                          key, checker->owner, node);
  }
  return true;
}

static void check_sets(sets_check *check, const strut_node_set *sets, size_t count,
                       const char *key) {
  strut_checker *checker = check->checker;
  const strut_scene *scene = checker->scene;
  if (count && scene->ground_count && checker->subject == STRUT_ON_EQUILIBRIA) {
    strut_fault_of(checker, key,
                   "the %s of %s take the place of one straight line at rest, and the scene "
                   "has other grounds; leave them out",
                   key, checker->owner);
    return;
  }
  if (count && !strut_scene_has_ground(scene)) {
    strut_fault_of(checker, key, "the %s of %s need a ground to rest on, and the scene has none",
                   key, checker->owner);
    return;
  }
  for (size_t i = 0; i < count; i++)
    if (!check_set(check, &sets[i], key)) return;
}

static void check_positions(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_configuration *configuration = &scene->configurations[checker->index];
  for (size_t i = 0; i < scene->node_count; i++) {
    const double *drawn = scene->nodes[i].position;
    if (isfinite(configuration->position[i][0]) && isfinite(configuration->position[i][1]))
      continue;
    if (!isfinite(drawn[0]) || !isfinite(drawn[1])) continue; /* reported at the node */
    char node[200];
    strut_fault_of(checker, NULL, "the position of %s in %s is not finite",
                   strut_format_name(node, "node", scene->nodes[i].name, i), checker->owner);
    return;
  }
}

static void check_search(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  const strut_search *search = &checker->experiment->search;
  if (search->starts < 0 || search->starts > STRUT_MOST_STARTS)
    strut_fault_of(checker, "starts",
                   "the starts of the search for equilibria must be from 0 to %d",
                   STRUT_MOST_STARTS);
  if ((double)search->seed > STRUT_MOST_SEED)
    strut_fault_of(checker, "seed", "the seed of the search for equilibria must be at most %.0f",
                   STRUT_MOST_SEED);
  if (scene->start_equilibrium != -1 &&
      !strut_exists(scene->start_equilibrium, scene->configuration_count))
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
    if (strut_exists(node, scene->node_count)) check.touches[node] = true;
  }
  for (size_t i = 0; !checker->out_of_memory && i < scene->configuration_count; i++) {
    const strut_configuration *configuration = &scene->configurations[i];
    strut_check_begin(checker, STRUT_THING_CONFIGURATION, i);
    check_positions(checker);
    check_sets(&check, configuration->sets, configuration->set_count, "contacts");
  }
  if (!checker->out_of_memory) {
    const strut_search *search = &checker->experiment->search;
    strut_check_begin_with(checker, STRUT_ON_EQUILIBRIA, 0, "the search for equilibria");
    check_sets(&check, search->supports, search->support_count, "supports");
    check_search(checker);
  }
  strut_release(check.touches);
  strut_release(check.stamp);
}
