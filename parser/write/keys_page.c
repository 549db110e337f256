/* SPDX-License-Identifier: GPL-3.0-or-later */
/* docs/language-keys.md: one table for each mapping of the language. See keys_page.h. */
#include "parser/write/keys_page.h"

#include <string.h>

#include "parser/language/keys.h"
#include "parser/write/key_text.h"

/* The text above the table of each section. */
static const char *const introductions[STRUT_SECTION_COUNT] = {
    [STRUT_SECTION_SCENE] = "The keys at the top level of a model.",
    [STRUT_SECTION_NODE] =
        "`nodes: {NAME: [x, y]}`, or `nodes: {NAME: {position: [x, y], ...}}` with these keys.",
    [STRUT_SECTION_PART] =
        "`parts: {NAME: {...}}`: a piece of structure, which `place` copies. It sees the "
        "parameters, "
        "groups and signals of the scene, and no nodes but its own.",
    [STRUT_SECTION_PLACE] =
        "`place: {NAME: {...}}`: a copy of a part, or several, under names such as `NAME.node` or "
        "`NAME.3.node`.",
    [STRUT_SECTION_REPEAT] =
        "`repeat: {...}` of a placement. Copy k is moved k times against copy 0: scaled and turned "
        "about `about`, then by `step`, in its own frame.",
    [STRUT_SECTION_NEXT] =
        "`next: {...}` of `repeat`: what a copy has in common with the next one. Names are those "
        "of "
        "the copy; `next.NAME` is one of the next copy.",
    [STRUT_SECTION_MEMBER] =
        "`members: {NAME: {...}}`. A member needs a stiffness, a damping, or both. Of the four "
        "keys "
        "for the rest length, the member's own replaces that of its group; the same holds for the "
        "two "
        "keys for the stiffness.",
    [STRUT_SECTION_HINGE] =
        "`hinges: {NAME: {...}}`. A hinge needs a stiffness, a damping, or a "
        "law that brings its own stiffness.",
    [STRUT_SECTION_CELL] =
        "`cells: {NAME: {...}}`: either `pressure` or `gas`. In the plane a pressure is a force "
        "per "
        "length.",
    [STRUT_SECTION_GAS] = "`cells: {NAME: {gas: {...}}}`.",
    [STRUT_SECTION_COLLISION] =
        "`collisions: {NAME: {...}}`: `node` and `member`, or `nodes`, or `members`. Things pass "
        "through each other unless a collision names them.",
    [STRUT_SECTION_BEAM] =
        "`beams: {NAME: {...}}`. A beam is short for nodes `NAME.1`, `NAME.2`, ... between its "
        "ends, "
        "bars `NAME.1`, ... and hinges `NAME.1`, ... at these nodes; at a clamp also the fixed "
        "node "
        "and the hinge `NAME.start` or `NAME.end`. `strut write` writes these.",
    [STRUT_SECTION_CLAMPED_TO] =
        "`clamped_to: {start: NAME, end: NAME}` of a beam: the end keeps its drawn angle to a "
        "member "
        "or to another beam that has the node, too, by the hinge `NAME.start` or `NAME.end`. "
        "Several "
        "beams at one node also get hinges between each other, such as `NAME.start.OTHER`.",
    [STRUT_SECTION_LAW] =
        "`law: {...}` of a member or a hinge, or only its kind, such as `law: logarithmic`; "
        "`law: tension_only` and `law: compression_only` are linear and carry one sign. For a "
        "hinge "
        "read angle for length and moment for force. `polynomial` and `table` bring their own "
        "stiffness, so that the member must not give one.",
    [STRUT_SECTION_MOVES] =
        "`nodes: {NAME: {moves: {...}}}`: from its position, plus the signal at t = 0, the node "
        "moves "
        "by the signal, whose value must not jump. Statics keep it where it is at t = 0.",
    [STRUT_SECTION_RAYLEIGH] =
        "`rayleigh: {...}`: a mode of angular frequency w gets the damping ratio alpha / (2 w) + "
        "beta w / 2, beside what members' own dampers give.",
    [STRUT_SECTION_GROUND] =
        "`ground: {...}`: the line, profile or circle that nodes may touch; or several of them, "
        "`grounds: {NAME: {...}}`.",
    [STRUT_SECTION_CIRCLE] = "`circle: {...}` of a ground.",
    [STRUT_SECTION_MOTION] =
        "`motion: {x: SIGNAL, y: SIGNAL}` of a ground: its displacement, in lengths. Its work on "
        "the structure is in the energy balance. A displacement must not jump.",
    [STRUT_SECTION_FRICTION] =
        "`friction: {...}` of the ground, of a group, or of a contact; keys of a contact take "
        "precedence over those of its groups, and these over those of the ground. Karnopp's law "
        "and `coulomb` need `mu`, or `mu_static` and `mu_kinetic`; Karnopp's law also needs "
        "`stick_velocity`. The smooth law needs `mu` or `mu_kinetic`, and `width`. Where friction "
        "depends on the direction, `mu_forward` and `mu_backward` replace `mu`, in every law.",
    [STRUT_SECTION_CONTACT] = "`ground: {contacts: {NODE: {...}}}`: settings of a single contact.",
    [STRUT_SECTION_ACTUATOR] =
        "`actuators: {NAME: {...}}`, with a `signal`, a `force` of a member or a `moment` of a "
        "hinge.",
    [STRUT_SECTION_LOAD] = "`loads: {NAME: {...}}`.",
    [STRUT_SECTION_UNBALANCE] =
        "`unbalances: {NAME: {...}}`, each with a `speed` or an `angle`. Statics and settling have "
        "its mass at the node.",
    [STRUT_SECTION_SLIDER] =
        "`sliders: {NAME: {...}}`. Statics and settling have them where they are at t = 0.",
    [STRUT_SECTION_SIGNAL] =
        "A signal is a mapping with one of these keys, or the name of an entry of `signals`. The "
        "unit of its values follows from its use: a length, an angle or a pressure, or a force or "
        "a moment, for an actuator, a length for the motion of a ground, a number without unit for "
        "a load.",
    [STRUT_SECTION_SINE] = "`{sine: {...}}`.",
    [STRUT_SECTION_HALF_SINE] = "`{half_sine: {...}}`: a single pulse.",
    [STRUT_SECTION_SQUARE] = "`{square: {...}}`.",
    [STRUT_SECTION_RAMP] = "`{ramp: {...}}`.",
    [STRUT_SECTION_CONFIGURATION] =
        "`configurations: {NAME: {NODE: [x, y], ...}}`, or `configurations: {NAME: {...}}` with "
        "these keys. `{}` is the drawn shape. If a node is called `contacts`, that key followed by "
        "two plain values is its position.",
    [STRUT_SECTION_INITIAL] = "`initial: {...}`.",
    [STRUT_SECTION_SETTLE] = "`initial: {settle: {...}}`.",
    [STRUT_SECTION_EQUILIBRIA] =
        "`equilibria: {...}`: the search of `strut equilibria` and of `initial: {equilibrium: "
        "NAME}`.",
    [STRUT_SECTION_SOLVER] = "`solver: {...}`.",
    [STRUT_SECTION_RUN] = "`run: {...}`: either `duration`, or `periods` and `of`.",
    [STRUT_SECTION_MEASURE] = "`run: {measure: {...}}`.",
    [STRUT_SECTION_QUANTITY] = "`run: {measure: {quantities: {NAME: {...}}}}`.",
    [STRUT_SECTION_STEADY] = "`run: {measure: {steady: {...}}}`.",
    [STRUT_SECTION_OUTPUT] = "`output: {...}`.",
    [STRUT_SECTION_STUDY] =
        "The keys at the top level of a study, the file that `strut sweep` runs. Expressions in "
        "`set` and `derive` may use the model's parameters.",
    [STRUT_SECTION_RANGE] =
        "`axes: [{NAME: {...}}]`: values of a parameter; either `step` or `count`.",
    [STRUT_SECTION_VARIANT] = "`variants: {NAME: {...}}` of a study.",
    [STRUT_SECTION_CHECK] = "`check: {...}` of a study.",
    [STRUT_SECTION_FIGURE] = "`figures: {NAME: {...}}` of a study.",
    [STRUT_SECTION_PATH] =
        "`path: {...}` of a study with `compute: path`, as the options of `strut path`.",
    [STRUT_SECTION_FORM] =
        "`form: {...}` of a study with `compute: form`, as the options of `strut form`.",
    [STRUT_SECTION_POINTS] =
        "`axes: [{points: {...}}]` of a study; `{points: FILE}` is short for it.",
    [STRUT_SECTION_SAMPLE] = "`axes: [{sample: {...}}]` of a study: parameters from distributions.",
    [STRUT_SECTION_REFINE] = "`refine: {...}` of a study.",
    [STRUT_SECTION_STIFFNESS_AT] = "`stiffness_at: {...}` of a study.",
    [STRUT_SECTION_SENSITIVITY] =
        "`sensitivity: {...}` of a study; results are in `sensitivity.csv` beside the table.",
    [STRUT_SECTION_SEARCH] =
        "`search: {...}` of a study; either `maximise` or `minimise`. [Searches](search.md) has "
        "examples.",
    [STRUT_SECTION_FOLLOW] =
        "`follow: {...}` of a study, as the options of `strut follow`. [Branches of "
        "motions](follow.md#studies-of-branches) has an example.",
    [STRUT_SECTION_VARIABLE] =
        "`over: {NAME: {...}}` of a search. `{NAME: [...]}` is a list of choices, numbers or "
        "texts.",
    [STRUT_SECTION_LIMIT] = "`limit: {...}` of a study.",
    [STRUT_SECTION_DISTRIBUTION] =
        "`over: {NAME: {...}}` of a sample or a sensitivity analysis, with one of these keys.",
    [STRUT_SECTION_SENSOR] =
        "`sensors: {NAME: {...}}` with one thing to sense. Expressions of signals, and measured "
        "quantities, use the name. In an expression `rate(NAME)` is the rate of a length, an angle "
        "or "
        "a position.",
    [STRUT_SECTION_STATE] = "`states: {NAME: {...}}`.",
    [STRUT_SECTION_OSCILLATOR] =
        "`oscillators: {NAME: {...}}`. The name is the phase, an angle, in expressions: `2 mm * "
        "sin(NAME)`. `strut write` shows oscillators as states.",
    [STRUT_SECTION_CONTROLLER] =
        "`controllers: {NAME: {...}}`. The integral is the state `NAME_integral`. `strut write` "
        "shows PID controllers as signals and states.",
    [STRUT_SECTION_RELAY] =
        "`controllers: {NAME: {kind: relay, ...}}`: a signal with two values. Either `on_above` "
        "and "
        "`off_below`, or `on_below` and `off_above`.",
    [STRUT_SECTION_STARTS] =
        "`{sine: {...}, starts: {...}}` of any signal: the touchdown of a node, or a sensor that "
        "passes a "
        "level.",
    [STRUT_SECTION_MAXWELL] =
        "`members: {NAME: {maxwell: {...}}}`: the force of the branch follows F' = k (u' - F/c), "
        "with the "
        "rate u' of the elongation. In statics it has relaxed to 0."};

/* "none, x, y or both", each in code style. */
static void put_words(strut_writer *writer, const char *words) {
  char word[40], next[40];
  for (int i = 0; strut_word_at(words, i, word, sizeof word); i++) {
    bool last = !strut_word_at(words, i + 1, next, sizeof next);
    strut_put(writer, i == 0 ? "`" : last ? " or `" : ", `");
    strut_put(writer, word);
    strut_put(writer, "`");
  }
}

static void put_unit(strut_writer *writer, const strut_key *key) {
  bool number = key->type == STRUT_TYPE_NUMBER || key->type == STRUT_TYPE_PAIR;
  if (!number || key->measure == STRUT_MEASURE_NONE) return;
  if (key->measure == STRUT_MEASURE_CONTEXT) {
    strut_put(writer, " in a unit that depends on its use");
    return;
  }
  strut_put(writer, " [");
  strut_put(writer, strut_dimension_unit(strut_measure_dimension(key->measure)));
  strut_put(writer, "]");
}

static void put_limits(strut_writer *writer, strut_key_limits limits) {
  switch (limits.range) {
    case STRUT_RANGE_NOT_NEGATIVE: strut_put(writer, ", not negative"); break;
    case STRUT_RANGE_ABOVE_ZERO: strut_put(writer, ", positive"); break;
    case STRUT_RANGE_WHOLE:
      strut_put(writer, " from ");
      strut_put_number(writer, limits.least);
      strut_put(writer, " to ");
      strut_put_number(writer, limits.most);
      break;
    case STRUT_RANGE_ANY: break;
  }
}

static void put_expression_type(strut_writer *writer, const strut_key *key) {
  bool signal = key->measure == STRUT_MEASURE_CONTEXT;
  strut_put(writer, signal ? "expression of `t` and sensors" : "expression of columns");
}

void strut_put_key_type(strut_writer *writer, const strut_key *key) {
  static const char *const types[] = {
      [STRUT_TYPE_TEXT] = "text",
      [STRUT_TYPE_NUMBER] = "number",
      [STRUT_TYPE_PAIR] = "two numbers",
      [STRUT_TYPE_WORDS] = "list of ",
      [STRUT_TYPE_NAME] = "name",
      [STRUT_TYPE_NODE_PATH] = "names of two nodes or more",
      [STRUT_TYPE_NODE_TRIPLE] = "names of three nodes",
      [STRUT_TYPE_NAME_PAIR] = "two names",
      [STRUT_TYPE_NODE_RING] = "names of three nodes or more",
      [STRUT_TYPE_NUMBERS] = "list of numbers",
      [STRUT_TYPE_NAMES] = "list of names",
      [STRUT_TYPE_POINTS] = "list of `[x, force]`",
      [STRUT_TYPE_PROFILE] = "list of `[x, y]` [m]",
      [STRUT_TYPE_LAW] = "[law](#law), or the kind of one",
      [STRUT_TYPE_CONTACT_NODES] = "`all`, or list of nodes",
      [STRUT_TYPE_NODE_SETS] = "list of nodes, or list of such lists",
      [STRUT_TYPE_GROUPS] = "group, or list of groups",
      [STRUT_TYPE_SIGNAL] = "[signal](#signal), or the name of one",
      [STRUT_TYPE_SIGNALS] = "list of signals",
      [STRUT_TYPE_TABLE] = "list of `[t, value]`",
      [STRUT_TYPE_KEEP] = "list of quantities, or of ",
      [STRUT_TYPE_AXES] = "list of axes",
      [STRUT_TYPE_TIMES] = "list of times [s]",
      [STRUT_TYPE_SETTLE] = "`true`, `false`, or [mapping](#settle)",
      [STRUT_TYPE_STEADY] = "`true`, `false`, or [mapping](#steady)",
      [STRUT_TYPE_THINGS] = "names, each with ",
      [STRUT_TYPE_FREE] = ""};
  if (key->type == STRUT_TYPE_MAP) {
    strut_put(writer, "[mapping](#");
    strut_put(writer, key->name);
    strut_put(writer, ")");
    return;
  }
  if (key->type == STRUT_TYPE_EXPRESSION) put_expression_type(writer, key);
  if (key->limits.range == STRUT_RANGE_WHOLE) strut_put(writer, "whole ");
  if (types[key->type]) strut_put(writer, types[key->type]);
  if (key->type == STRUT_TYPE_THINGS || key->type == STRUT_TYPE_FREE) {
    strut_put(writer, key->words);
  } else if (*key->words) {
    put_words(writer, key->words);
  }
  put_unit(writer, key);
  put_limits(writer, key->limits);
}

const char *strut_section_introduction(strut_section section) { return introductions[section]; }

bool strut_default_is_described(const strut_key *key) {
  return strchr(key->fallback, ' ') && !strchr(key->fallback, '[');
}

void strut_put_without_links(strut_writer *writer, const char *markdown, bool ticks) {
  for (const char *c = markdown; *c; c++) {
    const char *close = *c == '[' ? strchr(c, ']') : NULL;
    const char *end = close && close[1] == '(' ? strchr(close, ')') : NULL;
    if (end) {
      strut_put_part(writer, c + 1, (size_t)(close - c - 1));
      c = end;
    } else if (ticks || *c != '`') {
      strut_put_part(writer, c, 1);
    }
  }
}

static void put_section(strut_writer *writer, strut_section section) {
  strut_put(writer, "\n## ");
  strut_put(writer, strut_section_name(section));
  strut_put(writer, "\n\n");
  strut_put(writer, introductions[section]);
  strut_put(writer, "\n\n| key | value | default | meaning |\n|---|---|---|---|\n");
  for (int i = 0; i < strut_section_size(section); i++) {
    const strut_key *key = strut_key_at(strut_section_first(section) + i);
    bool words = strut_default_is_described(key);
    strut_put(writer, "| `");
    strut_put(writer, key->name);
    strut_put(writer, "` | ");
    strut_put_key_type(writer, key);
    strut_put(writer, key->need == STRUT_REQUIRED ? " | required"
                      : *key->fallback            ? words ? " | " : " | `"
                                                  : " |");
    strut_put(writer, key->fallback);
    strut_put(writer, *key->fallback && !words ? "` | " : " | ");
    strut_put(writer, key->description);
    strut_put(writer, " |\n");
  }
}

char *strut_keys_page(void) {
  strut_writer result = {.text = NULL};
  strut_put(&result,
            "<!-- Generated by `strut keys` from parser/language/keys_table.h; do not edit. -->\n"
            "# Keys of the language, version 1\n\n"
            "A number is an expression with units, such as `2*amplitude + 0.1 mm`; a number "
            "without a unit is "
            "in the SI unit in brackets.\nGroups may have the keys of a [member](#member), a "
            "[node](#node) or "
            "a [contact](#contact), except `group`.\n");
  for (int section = 0; section < STRUT_SECTION_COUNT; section++)
    put_section(&result, (strut_section)section);
  if (!result.failed) return result.text;
  strut_release(result.text);
  return NULL;
}
