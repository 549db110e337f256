/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sensors, internal states, and what switches signals: which there are, and the lines that follow them. */
#include <assert.h>
#include <string.h>

#include "engine/output/code/writer.h"

/* ---- which there are ---- */

/* What follows the motion matters to inputs only. */
bool strut_code_has_feedback(const strut_code_writer *w) {
  const strut_feedback_table *f = &w->model->feedback;
  return strut_code_input_count(w->model) > 0 &&
         (f->count || f->state_count > f->maxwell_count || f->sampled_count || f->trigger_count ||
          f->relay_count);
}

bool strut_code_has_states(const strut_code_writer *w) {
  return w->model->feedback.state_count > 0;
}
bool strut_code_has_internal_states(const strut_code_writer *w) {
  return strut_code_has_feedback(w) && w->scene->state_count > 0;
}
static bool has_integrated(const strut_code_writer *w) {
  const strut_feedback_table *f = &w->model->feedback;
  return strut_code_has_feedback(w) && f->state_count > f->maxwell_count;
}
static bool has_maxwell(const strut_code_writer *w) { return w->model->feedback.maxwell_count > 0; }

static bool has_sensor(const strut_code_writer *w, strut_sensor_kind kind) {
  const strut_feedback_table *f = &w->model->feedback;
  for (int32_t i = 0; i < f->count && strut_code_has_feedback(w); i++)
    if (f->sensor[i].kind == kind) return true;
  return false;
}

static bool has_driven_sensors(const strut_code_writer *w) {
  return strut_code_has_feedback(w) && w->model->feedback.needs_drives;
}

/* Entry k of a list of signals among those of the list that act; -1: it does not act. */
static int32_t place_in(const strut_code_writer *w, const int32_t *list, int32_t count,
                        int32_t signal) {
  int32_t place = 0;
  for (int32_t i = 0; i < count; i++) {
    if (!strut_code_signal_acts(w, list[i])) continue;
    if (list[i] == signal) return place;
    place++;
  }
  return -1;
}
static int32_t count_acting(const strut_code_writer *w, const int32_t *list, int32_t count) {
  int32_t acting = 0;
  for (int32_t i = 0; i < count; i++) acting += strut_code_signal_acts(w, list[i]);
  return acting;
}

int32_t strut_code_sample_count(const strut_code_writer *w) {
  return count_acting(w, w->model->feedback.sampled, w->model->feedback.sampled_count);
}
int32_t strut_code_sample_of(const strut_code_writer *w, int32_t signal) {
  return place_in(w, w->model->feedback.sampled, w->model->feedback.sampled_count, signal);
}
int32_t strut_code_start_count(const strut_code_writer *w) {
  return count_acting(w, w->model->feedback.triggered, w->model->feedback.trigger_count);
}
int32_t strut_code_start_of(const strut_code_writer *w, int32_t signal) {
  return place_in(w, w->model->feedback.triggered, w->model->feedback.trigger_count, signal);
}

/* Relays are counted in the scene's order, whether they are sampled or not. */
int32_t strut_code_relay_of(const strut_code_writer *w, int32_t signal) {
  int32_t place = 0;
  for (int32_t i = 0; i < signal; i++)
    place += w->scene->signals[i].kind == STRUT_RELAY && strut_code_signal_acts(w, i);
  return place;
}
int32_t strut_code_relay_count(const strut_code_writer *w) {
  return strut_code_relay_of(w, (int32_t)w->scene->signal_count);
}

static bool has_samples(const strut_code_writer *w) { return strut_code_sample_count(w) > 0; }
static bool has_starts(const strut_code_writer *w) { return strut_code_start_count(w) > 0; }
bool strut_code_has_relays(const strut_code_writer *w) { return strut_code_relay_count(w) > 0; }
static bool has_watched(const strut_code_writer *w) {
  return has_samples(w) || has_starts(w) || strut_code_has_relays(w);
}

/* Does something ask whether a node touches the ground? */
static bool has_touches(const strut_code_writer *w) {
  for (size_t i = 0; i < w->scene->signal_count; i++)
    if (w->scene->signals[i].trigger.kind == STRUT_TRIGGER_CONTACT &&
        strut_code_signal_acts(w, (int32_t)i) && w->model->contacts.count)
      return true;
  for (int32_t i = 0; i < w->model->feedback.count && strut_code_has_feedback(w); i++)
    if (w->model->feedback.sensor[i].kind == STRUT_SENSOR_CONTACT &&
        w->model->feedback.sensor[i].at >= 0)
      return true;
  return false;
}

static bool has_sensors(const strut_code_writer *w) {
  return strut_code_has_feedback(w) && w->model->feedback.count > 0;
}
static bool has_sensed_length(const strut_code_writer *w) {
  return has_sensor(w, STRUT_SENSOR_LENGTH);
}
static bool has_sensed_strain(const strut_code_writer *w) {
  return has_sensor(w, STRUT_SENSOR_ANGLE) || has_sensor(w, STRUT_SENSOR_AREA) ||
         has_sensor(w, STRUT_SENSOR_DISTANCE);
}
static bool has_sensed_push(const strut_code_writer *w) {
  return has_sensor(w, STRUT_SENSOR_PRESSURE) || has_sensor(w, STRUT_SENSOR_COLLISION_FORCE);
}

const strut_code_condition strut_code_feedback_conditions[] = {
    {"feedback", strut_code_has_feedback},
    {"states", strut_code_has_states},
    {"internal_states", strut_code_has_internal_states},
    {"integrated", has_integrated},
    {"maxwell", has_maxwell},
    {"sensors", has_sensors},
    {"driven_sensors", has_driven_sensors},
    {"sensed_length", has_sensed_length},
    {"sensed_strain", has_sensed_strain},
    {"sensed_push", has_sensed_push},
    {"samples", has_samples},
    {"starts", has_starts},
    {"relays", strut_code_has_relays},
    {"watched", has_watched},
    {"touches", has_touches},
    {NULL, NULL},
};

/* ---- names of states ---- */

const char *strut_code_state_name(const strut_code_writer *w, int32_t k, const char **kind) {
  const strut_feedback_table *f = &w->model->feedback;
  int32_t scene = (int32_t)w->scene->state_count;
  *kind = "";
  if (k < scene) return w->scene->states[k].name;
  if (k < scene + f->lag_count) {
    *kind = "lag_";
    const char *name = w->scene->signals[f->lagged[k - scene]].name;
    return name ? name : "";
  }
  *kind = "maxwell_";
  return w->scene->members[f->maxwell[k - scene - f->lag_count].member].name;
}

void strut_code_add_start_states(strut_code_writer *w) {
  const strut_feedback_table *f = &w->model->feedback;
  if (!f->state_count) return;
  strut_buffer_add(&w->text,
                   "/* internal states at t = 0 */\nstatic const real start_state[] = {\n");
  for (int32_t k = 0; k < f->state_count; k++) {
    strut_buffer_add(&w->text, "    ");
    strut_code_add_real(w, w->model->velocity[f->base + k]);
    strut_buffer_add(&w->text, ", /* %s */\n", w->states.name[k]);
  }
  strut_buffer_add(&w->text, "};\n\n");
}

/* The force of a branch is the state behind the velocities. */
void strut_code_add_maxwell(strut_code_writer *w) {
  const strut_feedback_table *f = &w->model->feedback;
  strut_buffer_add(&w->text, "enum { MAXWELLS = %d };\n\nstatic const maxwell maxwells[] = {\n",
                   f->maxwell_count);
  for (int32_t i = 0; i < f->maxwell_count; i++) {
    const strut_maxwell_entry *m = &f->maxwell[i];
    strut_buffer_add(&w->text, "    {%d, %d", m->member, 2 * w->model->node_count + m->state);
    strut_code_add_field(w, m->stiffness);
    strut_code_add_field(w, m->damping);
    strut_code_end_row(w, w->scene->members[m->member].name);
  }
  strut_buffer_add(&w->text, "};\n\n");
}

/* ---- sensors ---- */

/* "  s->sensor[NAME] = " */
static void begin_sensor(strut_code_writer *w, int32_t i) {
  strut_buffer_add(&w->text, "  s->sensor[%s_SENSOR_%s] = ", w->upper, w->sensors.name[i]);
}

static void add_energy_sensor(strut_code_writer *w, int32_t i, int32_t which) {
  if (which == STRUT_SENSED_TOTAL) strut_buffer_add(&w->text, "  e = energies_at(s, q, v);\n");
  begin_sensor(w, i);
  strut_buffer_add(&w->text, which == STRUT_SENSED_KINETIC ? "energies_at(s, q, v).kinetic;\n"
                             : which == STRUT_SENSED_ELASTIC
                                 ? "energies_at(s, q, v).elastic;\n"
                                 : "e.kinetic + e.elastic + e.gravity + "
                                   "e.contact;\n");
}

/* The block of an element. */
static int32_t block_of(const strut_code_writer *w, int32_t element) {
  int32_t b = 0;
  while (w->model->elements.block[b].end <= element) b++;
  return b;
}

/* What the elements of a cell or a collision push with. */
static void add_push_sensor(strut_code_writer *w, int32_t i, int32_t first) {
  const strut_element_table *t = &w->model->elements;
  begin_sensor(w, i);
  strut_code_add_real(w, t->element[first].numbers.outside);
  for (int32_t k = first; k < strut_element_end(t, first); k++)
    strut_buffer_add(&w->text, " - force_of(s, &blocks[%d], %d, q, v)", (int)block_of(w, k),
                     (int)k);
  strut_buffer_add(&w->text, ";\n");
}

/* The lines that evaluate sensor i; of those without a rate that stays 0. */
static void add_sensor(strut_code_writer *w, int32_t i) {
  strut_sensor_entry e = w->model->feedback.sensor[i];
  const char *name = w->sensors.name[i];
  switch (e.kind) {
    case STRUT_SENSOR_LENGTH:
      strut_buffer_add(&w->text, "  sense_length(s, %s_SENSOR_%s, %s_MEMBER_%s, q, v);\n", w->upper,
                       name, w->upper, w->members.name[e.at]);
      break;
    case STRUT_SENSOR_AREA:
    case STRUT_SENSOR_DISTANCE:
    case STRUT_SENSOR_ANGLE:
      strut_buffer_add(&w->text, "  sense_strain(s, %s_SENSOR_%s, &blocks[%d], %d, q, v);\n",
                       w->upper, name, (int)block_of(w, e.at), e.at);
      break;
    case STRUT_SENSOR_PRESSURE:
    case STRUT_SENSOR_COLLISION_FORCE: add_push_sensor(w, i, e.at); break;
    case STRUT_SENSOR_CONTACT_FORCE: break; /* refused */
    case STRUT_SENSOR_CONTACT:
      begin_sensor(w, i);
      if (e.at < 0)
        strut_buffer_add(&w->text, "0;\n");
      else
        strut_buffer_add(&w->text, "touches(s, %u, q);\n", w->model->contacts.at[e.at]);
      break;
    case STRUT_SENSOR_POSITION:
      begin_sensor(w, i);
      strut_buffer_add(&w->text, "q[%d];\n  s->sensor_rate[%s_SENSOR_%s] = v[%d];\n", e.at,
                       w->upper, name, e.at);
      break;
    case STRUT_SENSOR_VELOCITY:
      begin_sensor(w, i);
      strut_buffer_add(&w->text, "v[%d];\n", e.at);
      break;
    case STRUT_SENSOR_FORCE:
      begin_sensor(w, i);
      strut_buffer_add(&w->text, "tension_of(s, %s_MEMBER_%s, q, v);\n", w->upper,
                       w->members.name[e.at]);
      break;
    case STRUT_SENSOR_ENERGY: add_energy_sensor(w, i, e.at); break;
    case STRUT_SENSOR_KINDS: break;
  }
}

static bool has_total(const strut_code_writer *w) {
  const strut_feedback_table *f = &w->model->feedback;
  for (int32_t i = 0; i < f->count; i++)
    if (f->sensor[i].kind == STRUT_SENSOR_ENERGY && f->sensor[i].at == STRUT_SENSED_TOTAL)
      return true;
  return false;
}

/* Sensors that follow from the motion alone, or those that the driven rest lengths, too, decide. */
static void add_sense(strut_code_writer *w, bool driven) {
  const strut_feedback_table *f = &w->model->feedback;
  strut_buffer_add(&w->text, "static void %s(%s_state *s, const real *q, const real *v) {\n",
                   driven ? "sense_forces" : "sense_motion", w->options->prefix);
  if (driven && has_total(w)) strut_buffer_add(&w->text, "  %s_energies e;\n", w->options->prefix);
  for (int32_t i = 0; i < f->count; i++)
    if (strut_sensor_needs_drives(f->sensor[i].kind) == driven) add_sensor(w, i);
  strut_buffer_add(&w->text,
                   "  (void)s, (void)q, (void)v; /* sensors may need none of them */\n}\n\n");
}

void strut_code_add_sensors(strut_code_writer *w) {
  if (has_sensor(w, STRUT_SENSOR_ENERGY))
    strut_buffer_add(&w->text,
                     "static %s_energies energies_at(const %s_state *s, const real *q, const real "
                     "*v);\n",
                     w->options->prefix, w->options->prefix);
  if (has_sensor(w, STRUT_SENSOR_FORCE))
    strut_buffer_add(
        &w->text,
        "static real tension_of(const %s_state *s, int j, const real *q, const real *v);\n",
        w->options->prefix);
  strut_buffer_add(&w->text, "\n");
  add_sense(w, false);
  if (has_driven_sensors(w)) add_sense(w, true);
}

/* ---- rates of internal states ---- */

static void add_lag_rate(strut_code_writer *w, int32_t signal) {
  int32_t k = w->model->feedback.lag_of[signal], at = 2 * w->model->node_count + k;
  strut_buffer_add(&w->text,
                   "  unlagged_%s(&values, t, &wanted, &unused); /* %s */\n"
                   "  s->force[%d] = (wanted - v[%d]) / ",
                   w->signals.name[signal], w->states.name[k], at, at);
  strut_code_add_real(w, w->scene->signals[signal].lag);
  strut_buffer_add(&w->text, ";\n");
}

static void add_rates(strut_code_writer *w) {
  const strut_feedback_table *f = &w->model->feedback;
  bool lags = false;
  for (int32_t k = 0; k < f->lag_count; k++) lags |= strut_code_signal_acts(w, f->lagged[k]);
  strut_buffer_add(&w->text,
                   "/* Rates of internal states, where accelerations of nodes are summed. */\n"
                   "static void add_rates_of_states(%s_state *s, double t, const real *v) {\n"
                   "  const observed values = {s, v + 2 * %s_NODES, 1};\n",
                   w->options->prefix, w->upper);
  if (lags) strut_buffer_add(&w->text, "  real wanted, unused;\n");
  if (w->scene->state_count)
    strut_buffer_add(&w->text,
                     "  for (int k = 0; k < %zu; k++)\n"
                     "    s->force[2 * %s_NODES + k] = (real)rate_of_state(&values, k, t);\n",
                     w->scene->state_count, w->upper);
  for (int32_t k = 0; k < f->lag_count; k++)
    if (strut_code_signal_acts(w, f->lagged[k])) add_lag_rate(w, f->lagged[k]);
  strut_buffer_add(&w->text, "  (void)values, (void)t;\n}\n\n");
}

/* ---- samples, starts and relays ---- */

static void add_observed(strut_code_writer *w) {
  if (strut_code_has_states(w))
    strut_buffer_add(&w->text, "  const observed o = {s, s->v + 2 * %s_NODES, 0};\n", w->upper);
  else
    strut_buffer_add(&w->text, "  const observed o = {s, 0};\n");
}

/* "relay_input_NAME(&values, t)" behind what the input is compared with. */
static void add_input(strut_code_writer *w, int32_t signal) {
  strut_buffer_add(&w->text, "relay_input_%s(&values, t)", w->signals.name[signal]);
}

static void add_thresholds(strut_code_writer *w, int32_t signal) {
  const strut_relay *r = &w->scene->signals[signal].relay;
  strut_buffer_add(&w->text, ", ");
  strut_code_add_double(w, r->lower);
  strut_buffer_add(&w->text, ", ");
  strut_code_add_double(w, r->upper);
  strut_buffer_add(&w->text, ")");
}

/* "if (is_beyond(...)) s->relay_above[0] ^= 1": the condition. */
static void add_switch_condition(strut_code_writer *w, int32_t signal) {
  strut_buffer_add(&w->text, "if (is_beyond(s->relay_above[%d], ", strut_code_relay_of(w, signal));
  add_input(w, signal);
  add_thresholds(w, signal);
  strut_buffer_add(&w->text, ") ");
}

static void add_sampling(strut_code_writer *w, int32_t signal, const char *indent) {
  bool lagged = w->scene->signals[signal].lag > 0.0;
  strut_buffer_add(&w->text, "%s%s_%s(&o, t, &s->held[%d], &unused);\n", indent,
                   lagged ? "lagged" : "unsampled", w->signals.name[signal],
                   strut_code_sample_of(w, signal));
}

/* At the start of a run, parts before their users. */
static void add_begin(strut_code_writer *w) {
  const strut_signal *signals = w->scene->signals;
  strut_buffer_add(&w->text,
                   "/* First samples, and sides of relays, with the rest lengths of the model. */\n"
                   "static void begin_signals(%s_state *s) {\n  const double t = 0;\n",
                   w->options->prefix);
  add_observed(w);
  strut_buffer_add(&w->text, "  const observed values = {o.s, %s1};\n  real unused;\n",
                   strut_code_has_states(w) ? "o.state, " : "");
  for (int32_t i = 0; i < strut_code_start_count(w); i++)
    strut_buffer_add(&w->text, "  s->started_at[%d] = HUGE_VAL, s->did_hold[%d] = -1;\n", i, i);
  strut_buffer_add(&w->text, "  sense_motion(s, s->q, s->v);\n%s",
                   has_driven_sensors(w) ? "  sense_forces(s, s->q, s->v);\n" : "");
  for (int32_t i = 0; i < (int32_t)w->scene->signal_count; i++) {
    const strut_relay *r = &signals[i].relay;
    if (!strut_code_signal_acts(w, i)) continue;
    if (signals[i].kind == STRUT_RELAY) {
      strut_buffer_add(&w->text, "  s->relay_above[%d] = ", strut_code_relay_of(w, i));
      strut_buffer_add(&w->text, r->on_at_start == r->on_above ? "!(" : "");
      add_input(w, i);
      strut_buffer_add(&w->text, r->on_at_start == r->on_above ? " < " : " > ");
      strut_code_add_double(w, r->on_at_start == r->on_above ? r->lower : r->upper);
      strut_buffer_add(&w->text, r->on_at_start == r->on_above ? ");\n" : ";\n");
    }
    if (signals[i].every > 0.0) add_sampling(w, i, "  ");
  }
  strut_buffer_add(&w->text, "  (void)t, (void)values, (void)unused;\n}\n\n");
}

static void add_sample(strut_code_writer *w, int32_t signal) {
  const strut_signal *s = &w->scene->signals[signal];
  strut_buffer_add(&w->text, "  if (is_due(t, ");
  strut_code_add_double(w, s->every);
  strut_buffer_add(&w->text, ", s->h)) {\n");
  if (s->kind == STRUT_RELAY) {
    int32_t relay = strut_code_relay_of(w, signal);
    strut_buffer_add(&w->text, "    ");
    add_switch_condition(w, signal);
    strut_buffer_add(&w->text, "s->relay_above[%d] = !s->relay_above[%d];\n", relay, relay);
  }
  add_sampling(w, signal, "    ");
  strut_buffer_add(&w->text, "    changed = 1;\n  }\n");
}

static void add_start(strut_code_writer *w, int32_t signal) {
  const strut_trigger *trigger = &w->scene->signals[signal].trigger;
  int32_t k = strut_code_start_of(w, signal);
  strut_buffer_add(&w->text, "  holds = ");
  switch (trigger->kind) {
    case STRUT_TRIGGER_CONTACT:
      strut_buffer_add(&w->text, w->model->contacts.count ? "touches(s, %d, s->q)" : "0",
                       2 * trigger->item);
      break;
    case STRUT_TRIGGER_ABOVE:
    case STRUT_TRIGGER_BELOW:
      strut_buffer_add(&w->text, "s->sensor[%s_SENSOR_%s] %c ", w->upper,
                       w->sensors.name[trigger->item],
                       trigger->kind == STRUT_TRIGGER_ABOVE ? '>' : '<');
      strut_code_add_double(w, trigger->level);
      break;
    case STRUT_TRIGGER_NONE: break;
  }
  strut_buffer_add(&w->text, ";\n  if (holds && s->did_hold[%d] == 0", k);
  if (!trigger->each) strut_buffer_add(&w->text, " && !(s->started_at[%d] < HUGE_VAL)", k);
  strut_buffer_add(&w->text,
                   ") s->started_at[%d] = t, changed = 1;\n"
                   "  s->did_hold[%d] = (signed char)holds;\n",
                   k, k);
}

static void add_relay(strut_code_writer *w, int32_t signal) {
  int32_t relay = strut_code_relay_of(w, signal);
  strut_buffer_add(&w->text, "  ");
  add_switch_condition(w, signal);
  strut_buffer_add(&w->text,
                   "{\n    s->relay_above[%d] = !s->relay_above[%d];\n"
                   "    evaluate_inputs(s, in, t, s->q, s->v);\n    changed = 1;\n  }\n",
                   relay, relay);
}

/* At the start of a step. */
static void add_update(strut_code_writer *w) {
  const strut_feedback_table *f = &w->model->feedback;
  strut_buffer_add(&w->text,
                   "/* Takes samples, starts and switches signals. Returns whether some has "
                   "changed. */\n"
                   "static int update_signals(%s_state *s, const %s_inputs *in) {\n"
                   "  double t = time_at(s, 0);\n  int changed = 0, holds;\n  real unused;\n",
                   w->options->prefix, w->options->prefix);
  add_observed(w);
  strut_buffer_add(&w->text,
                   "  const observed values = {o.s, %s1};\n"
                   "  evaluate_inputs(s, in, t, s->q, s->v);\n",
                   strut_code_has_states(w) ? "o.state, " : "");
  for (int32_t i = 0; i < f->sampled_count; i++)
    if (strut_code_signal_acts(w, f->sampled[i])) add_sample(w, f->sampled[i]);
  if (has_samples(w)) strut_buffer_add(&w->text, "  evaluate_inputs(s, in, t, s->q, s->v);\n");
  for (int32_t i = 0; i < f->trigger_count; i++)
    if (strut_code_signal_acts(w, f->triggered[i])) add_start(w, f->triggered[i]);
  if (has_starts(w)) strut_buffer_add(&w->text, "  evaluate_inputs(s, in, t, s->q, s->v);\n");
  for (int32_t i = 0; i < f->relay_count; i++)
    if (strut_code_signal_acts(w, f->relay[i])) add_relay(w, f->relay[i]);
  strut_buffer_add(&w->text,
                   "  (void)values, (void)holds, (void)unused;\n  return changed;\n}\n\n");
}

void strut_code_add_feedback(strut_code_writer *w) {
  if (has_integrated(w)) add_rates(w);
  if (!has_watched(w)) return;
  add_begin(w);
  add_update(w);
}
