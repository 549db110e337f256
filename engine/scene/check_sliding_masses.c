/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rules about masses that slide along members. See check.h. */
#include <math.h>

#include "engine/scene/check_rules.h"
#include "engine/scene/signal_motion.h"

/* Shares this far beyond an end are there but for rounding. */
static const double ROUNDING = 1e-9;
/* Times at which a signal is looked at: where it may turn, and evenly over the run. */
enum { MOST_TURNS = 1000, MOST_SAMPLES = 2000 };

static bool exists(int32_t index, size_t count) { return index >= 0 && (size_t)index < count; }

static bool node_has_mass(const strut_scene *scene, int32_t node) {
  if (scene->nodes[node].mass > 0.0) return true;
  for (size_t i = 0; i < scene->unbalance_count; i++)
    if (scene->unbalances[i].node == node && scene->unbalances[i].mass > 0.0) return true;
  for (size_t j = 0; j < scene->member_count; j++)
    for (size_t k = 0; k < scene->members[j].guide_count + 2; k++)
      if (scene->members[j].mass > 0.0 && strut_member_node(&scene->members[j], k) == node)
        return true;
  return false;
}

static bool node_moves(const strut_scene *scene, int32_t node) {
  for (size_t i = 0; i < scene->support_motion_count; i++)
    if (scene->support_motions[i].node == node) return true;
  return false;
}

/* Can the member carry a mass that slides? */
static bool check_member(strut_checker *checker, size_t i, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_member *m = &scene->members[scene->sliding_masses[i].member];
  const char *fault = NULL;
  if (m->guide_count)
    fault = "runs over guides; only members between two nodes carry sliders";
  else if (strut_member_ends(m))
    fault = "breaks or is released; take breaks_at and released_at away";
  if (fault) {
    strut_report_finding(checker, STRUT_ON_SLIDER, i, "member", "%s is on member '%s', which %s",
                         owner, m->name, fault);
    return false;
  }
  for (int k = 0; k < 2; k++) {
    const strut_node *node = &scene->nodes[m->node[k]];
    if (node_moves(scene, m->node[k]))
      strut_report_finding(checker, STRUT_ON_SLIDER, i, "member",
                           "%s is on a member whose node '%s' moves by a signal; sliders need "
                           "members between free or fixed nodes",
                           owner, node->name);
    else if (!(node->fixed[0] && node->fixed[1]) && !node_has_mass(scene, m->node[k]))
      strut_report_finding(checker, STRUT_ON_SLIDER, i, "member",
                           "%s is on a member whose node '%s' has no mass but the slider's; give "
                           "the node or the member a mass",
                           owner, node->name);
    else
      continue;
    return false;
  }
  return true;
}

static bool outside(double share) { return !(share >= -ROUNDING && share <= 1.0 + ROUNDING); }

/* Reports the first time looked at, at which the mass is beyond an end of its member. */
static void check_range(strut_checker *checker, size_t i, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_experiment *e = checker->experiment;
  const strut_sliding_mass *s = &scene->sliding_masses[i];
  double time[MOST_TURNS], until = e->duration > 0.0 ? e->duration : 1.0, first = HUGE_VAL;
  if (s->signal < 0) {
    if (outside(s->share))
      strut_report_finding(checker, STRUT_ON_SLIDER, i, "position",
                           "%s is at %.6g of its member, which is beyond its ends; expected a "
                           "share from 0 to 1",
                           owner, s->share);
    return;
  }
  size_t count = strut_signal_times(scene->signals, s->signal, 0.0, HUGE_VAL, time, MOST_TURNS);
  for (size_t k = 0; k < count; k++)
    if (time[k] >= 0.0 && time[k] < first && outside(strut_sliding_mass_share(scene, i, time[k])))
      first = time[k];
  for (int k = 0; k <= MOST_SAMPLES && isfinite(until); k++) {
    double t = until * k / MOST_SAMPLES;
    if (t < first && outside(strut_sliding_mass_share(scene, i, t))) first = t;
  }
  if (!(first < HUGE_VAL)) return;
  strut_report_finding(checker, STRUT_ON_SLIDER, i, s->travel ? "travel" : "moves",
                       "%s is at %.6g of its member at t = %g s, which is beyond its ends; "
                       "expected shares from 0 to 1",
                       owner, strut_sliding_mass_share(scene, i, first), first);
}

/* Has the motion an acceleration, and no jumps? */
static bool check_signal(strut_checker *checker, size_t i, const char *owner) {
  const strut_scene *scene = checker->scene;
  const strut_sliding_mass *s = &scene->sliding_masses[i];
  const char *key = s->travel ? "travel" : "moves";
  double when;
  if (s->signal == -1) return true;
  if (!exists(s->signal, scene->signal_count)) {
    strut_report_finding(checker, STRUT_ON_SLIDER, i, key, "%s has a signal that does not exist",
                         owner);
    return false;
  }
  if (checker->wild[s->signal]) return false;
  if (!strut_signal_is_wave(scene->signals, s->signal)) {
    strut_report_finding(checker, STRUT_ON_SLIDER, i, key,
                         "%s moves by an expression, a lag, samples or a start, whose acceleration "
                         "is not known; use waves, ramps, tables and sums of them",
                         owner);
    return false;
  }
  if (!strut_signal_value_jumps(scene->signals, s->signal, HUGE_VAL, &when)) return true;
  strut_report_finding(checker, STRUT_ON_SLIDER, i, key,
                       "the signal that moves %s jumps at t = %g s, but a mass cannot jump; use a "
                       "ramp, a table, or waves that begin and stop at zero",
                       owner, when);
  return false;
}

void strut_check_sliding_masses(strut_checker *checker) {
  const strut_scene *scene = checker->scene;
  char owner[200];
  for (size_t i = 0; i < scene->sliding_count; i++) {
    const strut_sliding_mass *s = &scene->sliding_masses[i];
    strut_format_name(owner, "slider", s->name, i);
    const strut_checked whose = {STRUT_ON_SLIDER, i, owner, NULL};
    strut_check_fields(checker, &whose, STRUT_FIELDS_SLIDER, s, NULL);
    bool placed = isfinite(s->share);
    if (!exists(s->member, scene->member_count)) {
      strut_report_finding(checker, STRUT_ON_SLIDER, i, "member",
                           "%s is on a member that does not exist", owner);
      continue;
    }
    if (checker->loose[s->member]) continue;
    bool carried = check_member(checker, i, owner);
    if (carried && s->signal >= 0 && scene->bar_model == STRUT_BARS_RIGID)
      strut_report_finding(checker, STRUT_ON_SLIDER, i, s->travel ? "travel" : "moves",
                           "%s moves, but bars are rigid; make them elastic, bars: elastic", owner);
    if (check_signal(checker, i, owner) && placed) check_range(checker, i, owner);
  }
}
