/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about laws, stops and hinges. See check.h. */
#include <math.h>

#include "engine/base/vec.h"
#include "engine/scene/check_rules.h"

/* Methods with events number the pieces of a law by 16 bits. */
enum { MOST_POINTS = 30000 };

/* What is wrong with the lists of a law, or NULL. */
static const char *fault_of_lists(const strut_law *law) {
  bool points = strut_law_needs(law->kind, STRUT_LAW_PARAMETER_POINTS);
  for (size_t i = 0; i < law->count; i++)
    if (!isfinite(law->force[i]) || (points && !isfinite(law->x[i])))
      return "has a number that is not finite";
  if (law->count > MOST_POINTS) return "has more than 30000 points";
  if (strut_law_needs(law->kind, STRUT_LAW_PARAMETER_COEFFICIENTS) && !law->count)
    return "needs at least one coefficient";
  if (points && law->count < 2) return "needs at least two points";
  bool zero = law->count > 0;
  for (size_t i = 0; i < law->count; i++) zero = zero && law->force[i] == 0.0;
  if (zero) return "gives no force anywhere; leave it out, or give it a number that is not 0";
  for (size_t i = 1; i < law->count && points; i++)
    if (!(law->x[i] > law->x[i - 1])) return "needs points with increasing x";
  return NULL;
}

/* The law of `owner` by itself. */
static bool check_numbers(strut_checker *checker, strut_subject subject, size_t index,
                          const char *owner, const strut_law *law) {
  bool unknown = (unsigned)law->kind >= STRUT_LAW_COUNT || law->kind == STRUT_LAW_AXIAL;
  const char *fault = unknown                            ? "is of an unknown kind"
                      : strut_law_is_of_cells(law->kind) ? "is for cells only"
                      : (unsigned)law->carries > STRUT_CARRIES_COMPRESSION
                          ? "carries an unknown sign"
                          : fault_of_lists(law);
  if (fault) {
    strut_report_finding(checker, subject, index, "law", "the law of %s %s", owner, fault);
    return false;
  }
  bool valid = true;
  for (int p = 0; p < STRUT_LAW_NUMBER_COUNT; p++) {
    double value = strut_law_value(law, p);
    bool needed = strut_law_needs(law->kind, p);
    if (isfinite(value) && !(needed && strut_law_above_zero(p) && !(value > 0.0))) continue;
    strut_report_finding(checker, subject, index, "law", "the law of %s needs a %s%s", owner,
                         strut_law_key(p), strut_law_above_zero(p) ? " above zero" : "");
    valid = false;
  }
  return valid;
}

/* Is the law valid, and the stiffness given where and only where the law does not bring its own? */
static bool check_law(strut_checker *checker, strut_subject subject, size_t index,
                      const char *owner, const strut_law *law, bool stiffness) {
  if (!check_numbers(checker, subject, index, owner, law)) return false;
  if (stiffness && strut_law_at(law->kind)->own)
    strut_report_finding(checker, subject, index, "stiffness",
                         "%s gives a stiffness beside its law, which has its own", owner);
  else if (!stiffness && !strut_law_at(law->kind)->own && law->kind != STRUT_LAW_LINEAR)
    strut_report_finding(checker, subject, index, "law", "the law %s of %s needs a stiffness",
                         strut_law_at(law->kind)->word, owner);
  else
    return true;
  return false;
}

/* Does the second slope of an elastic-plastic law lie between 0 and the first? `stiffness`: the first. */
static bool check_hardening(strut_checker *checker, strut_subject subject, size_t index,
                            const char *owner, const strut_law *law, double stiffness) {
  if (law->kind != STRUT_LAW_ELASTIC_PLASTIC) return true;
  if (law->second_stiffness >= 0.0 && law->second_stiffness < stiffness) return true;
  strut_report_finding(checker, subject, index, "law",
                       "the second_stiffness of %s must be at least 0 and below its stiffness, "
                       "found %g beside %g",
                       owner, law->second_stiffness, stiffness);
  return false;
}

static bool check_end_of_member(strut_checker *checker, size_t index, const char *owner) {
  const strut_member *m = &checker->scene->members[index];
  bool rigid = m->kind == STRUT_BAR && checker->scene->bar_model == STRUT_BARS_RIGID;
  const char *key = m->breaks_at > 0.0 ? "breaks_at" : "released_at";
  if (strut_member_ends(m) && rigid)
    strut_report_finding(checker, STRUT_ON_MEMBER, index, key,
                         "%s is a rigid bar, which cannot break or be released; make the member a "
                         "spring, or bars: elastic",
                         owner);
  else if (m->breaks_at > 0.0 && m->law.carries == STRUT_CARRIES_COMPRESSION)
    strut_report_finding(checker, STRUT_ON_MEMBER, index, key,
                         "%s carries compression only, so that no tension breaks it", owner);
  else
    return true;
  return false;
}

static bool check_guide_friction(strut_checker *checker, size_t index, const char *owner,
                                 double length) {
  const strut_member *m = &checker->scene->members[index];
  const char *fault = m->guide_friction == 0.0 ? NULL
                      : !m->guide_count        ? "has guide_friction, but runs over no guides"
                      : m->law.kind != STRUT_LAW_LINEAR
                          ? "has guide_friction and a law; only linear cables may rub"
                      : !(length > 0.0) ? "has guide_friction, which needs a rest length above zero"
                                        : NULL;
  if (fault)
    strut_report_finding(checker, STRUT_ON_MEMBER, index, "guide_friction", "%s %s", owner, fault);
  return !fault;
}

static bool check_stops(strut_checker *checker, size_t index, const char *owner) {
  const strut_member *m = &checker->scene->members[index];
  bool stops = m->shortest > 0.0 || m->longest > 0.0;
  bool stiff = m->stop_stiffness > 0.0 || m->stiffness > 0.0 || m->axial_stiffness > 0.0 ||
               strut_law_at(m->law.kind)->own;
  if (m->longest > 0.0 && m->shortest >= m->longest)
    strut_report_finding(checker, STRUT_ON_MEMBER, index, "longest",
                         "the longest of %s, %g m, must be above its shortest, %g m", owner,
                         m->longest, m->shortest);
  else if (!stops && (m->stop_stiffness > 0.0 || m->stop_damping > 0.0))
    strut_report_finding(checker, STRUT_ON_MEMBER, index,
                         m->stop_stiffness > 0.0 ? "stop_stiffness" : "stop_damping",
                         "%s describes stops, but has neither a shortest nor a longest", owner);
  else if (stops && !stiff)
    strut_report_finding(checker, STRUT_ON_MEMBER, index, "stop_stiffness",
                         "the stops of %s need a stop_stiffness", owner);
  else
    return true;
  return false;
}

bool strut_check_member_law(strut_checker *checker, size_t index, const char *owner) {
  const strut_member *m = &checker->scene->members[index];
  bool stiffness = m->stiffness > 0.0 || m->axial_stiffness > 0.0;
  if (!check_law(checker, STRUT_ON_MEMBER, index, owner, &m->law, stiffness)) return false;
  if (m->kind == STRUT_CABLE && m->law.carries == STRUT_CARRIES_COMPRESSION) {
    strut_report_finding(checker, STRUT_ON_MEMBER, index, "law",
                         "%s is a cable, which cannot carry compression", owner);
    return false;
  }
  if (m->law.kind == STRUT_LAW_LOGARITHMIC && m->rest_value <= 0.0) {
    strut_report_finding(checker, STRUT_ON_MEMBER, index, "law",
                         "the law logarithmic of %s needs a rest length above zero", owner);
    return false;
  }
  strut_rest rest;
  bool known = !checker->loose[index] && strut_member_rest(checker->scene, index, &rest);
  double slope = known ? rest.stiffness : HUGE_VAL;
  if (!check_guide_friction(checker, index, owner, known ? rest.length : 1.0)) return false;
  return check_hardening(checker, STRUT_ON_MEMBER, index, owner, &m->law, slope) &&
         check_end_of_member(checker, index, owner) && check_stops(checker, index, owner);
}

/* Do the nodes of a hinge exist, are they three, and do both arms have a direction? */
static void check_arms(strut_checker *checker, size_t index, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_hinge *h = &scene->hinges[index];
  for (int k = 0; k < 3; k++)
    if (h->node[k] < 0 || (size_t)h->node[k] >= scene->node_count) {
      strut_report_finding(checker, STRUT_ON_HINGE, index, "nodes",
                           "%s is at a node that does not exist", owner);
      return;
    }
  for (int k = 0; k < 3; k++)
    if (h->node[k] == h->node[(k + 1) % 3]) {
      strut_report_finding(checker, STRUT_ON_HINGE, index, "nodes",
                           "%s names node '%s' twice, expected three different nodes", owner,
                           scene->nodes[h->node[k]].name);
      return;
    }
  const strut_node *b = &scene->nodes[h->node[1]];
  for (int k = 0; k < 3; k += 2) {
    const strut_node *end = &scene->nodes[h->node[k]];
    bool drawn = strut_distance(b->position, end->position) == 0.0;
    if (!drawn && strut_distance(b->start, end->start) != 0.0) continue;
    strut_report_finding(checker, STRUT_ON_HINGE, index, "nodes",
                         "nodes '%s' and '%s' %s in one place, so an arm of %s has no direction",
                         b->name, end->name, drawn ? "are drawn" : "start", owner);
    return;
  }
}

void strut_check_hinges(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  for (size_t i = 0; i < scene->hinge_count; i++) {
    const strut_hinge *h = &scene->hinges[i];
    char owner[200];
    strut_format_name(owner, "hinge", h->name, i);
    const strut_checked whose = {STRUT_ON_HINGE, i, owner, NULL};
    bool valid = strut_check_fields(checker, &whose, STRUT_FIELDS_HINGE, h,
                                    strut_thing_at(STRUT_THING_HINGE)->usual) &&
                 check_law(checker, STRUT_ON_HINGE, i, owner, &h->law, h->stiffness > 0.0) &&
                 check_hardening(checker, STRUT_ON_HINGE, i, owner, &h->law, h->stiffness);
    if (valid && h->law.kind == STRUT_LAW_LOGARITHMIC)
      strut_report_finding(checker, STRUT_ON_HINGE, i, "law",
                           "the law logarithmic is for members, not for %s", owner);
    else if (valid && h->stiffness == 0.0 && h->damping == 0.0 && !strut_law_at(h->law.kind)->own &&
             !strut_is_pulled(scene, -1, (int32_t)i))
      strut_report_finding(checker, STRUT_ON_HINGE, i, NULL,
                           "%s has neither stiffness nor damping, so it does nothing", owner);
    check_arms(checker, i, owner);
  }
}
