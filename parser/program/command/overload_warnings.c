/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parser/program/command/messages.h"

#include <math.h>
#include <stdio.h>

#include "engine/forces/history.h"

void strut_warn_of_overload(const strut_listener *listener, const strut_model *model,
                            const double *positions, const char *where) {
  strut_overload worst;
  if (!strut_history_overload(model, positions, &worst)) return;
  const char *unit = worst.hinge ? "N m" : "N";
  strut_tell(listener, STRUT_MESSAGE_WARNING, NULL,
             "%s %s '%s' carries %.4g %s, above the %.4g %s at which it %s; statics take it as %s",
             where, worst.kind, worst.name, worst.force, unit, worst.limit, unit,
             worst.breaks ? "breaks" : "yields", worst.breaks ? "whole" : "elastic");
}

/* Says what a search has left out: on a curve that folds one branch is taken at each elongation. */
static void warn_of_folds(const strut_listener *listener, const strut_model *model) {
  for (int32_t i = 0; i < model->elements.count; i++) {
    const strut_element *element = &model->elements.element[i];
    if (element->law != STRUT_LAW_FOLDING) continue;
    strut_tell(
        listener, STRUT_MESSAGE_WARNING, NULL,
        "the law of '%s' may fold back: a search takes it as it is when it comes from the rest "
        "length, and finds no state on another branch; strut path follows them",
        strut_element_name(model->scene, element));
    return;
  }
}

void strut_warn_of_equilibria(const strut_listener *listener, const strut_model *model,
                              const strut_equilibria *all) {
  warn_of_folds(listener, model);
  for (size_t i = 0; i < all->count; i++) {
    const strut_equilibrium *equilibrium = &all->list[i];
    char where[200];
    if (equilibrium->point.label != STRUT_STABLE) continue;
    snprintf(where, sizeof where, "in %.180s", equilibrium->name);
    strut_warn_of_overload(listener, model, equilibrium->point.q, where);
  }
}

/* Does something carry more than it can? What that is. */
static const char *overloaded_at(const strut_scene *scene, const strut_path_point *at) {
  for (size_t j = 0; j < scene->member_count; j++) {
    const strut_member *member = &scene->members[j];
    bool yields =
        member->law.kind == STRUT_LAW_ELASTIC_PLASTIC && fabs(at->at.force[j]) > member->law.yield;
    if (yields || (member->breaks_at > 0.0 && at->at.force[j] > member->breaks_at))
      return member->name;
  }
  for (size_t i = 0; i < scene->hinge_count; i++) {
    const strut_hinge *hinge = &scene->hinges[i];
    double moment = fabs(at->at.moment[i]);
    bool yields = hinge->law.kind == STRUT_LAW_ELASTIC_PLASTIC && moment > hinge->law.yield;
    if (yields || (hinge->breaks_at > 0.0 && moment > hinge->breaks_at)) return hinge->name;
  }
  return NULL;
}

/* Warns of the first point where something carries more than it can; false: there is none. */
static bool warn_of_points(const strut_listener *listener, const strut_scene *scene,
                           const strut_path *path) {
  for (size_t i = 0; i < path->point_count; i++) {
    const char *name = overloaded_at(scene, &path->points[i]);
    if (!name) continue;
    strut_tell(listener, STRUT_MESSAGE_WARNING, NULL,
               "from the factor %.4g on '%s' carries more than it can; paths take what "
               "breaks as whole and what yields as elastic",
               path->points[i].at.factor, name);
    return true;
  }
  return false;
}

void strut_warn_of_path(const strut_listener *listener, const strut_scene *scene,
                        const strut_path *path) {
  bool warned = false;
  if (path->friction && !path->grips)
    strut_tell(listener, STRUT_MESSAGE_WARNING, NULL,
               "friction is kept, but no contact has a static coefficient, and no cable rubs: "
               "the laws 'smooth' and 'stribeck' vanish at rest");
  for (size_t i = 0; i < path->stage_count && !warned; i++)
    warned = warn_of_points(listener, scene, &path->stages[i]);
  warned = warned || warn_of_points(listener, scene, path);
  for (size_t i = 0; i < path->branch_count && !warned; i++)
    warned = warn_of_points(listener, scene, &path->branches[i]);
}
