/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/integrate/mass_shares.h"

#include <math.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/model/mass_kernel.h"

/* Branches that are looked for at most, and columns above them at most, as a part of all work. */
enum { MOST_BRANCHES = 64 };
static const double MOST_ABOVE = 0.25;

/* Who solves which columns of the factor that x and y share. */
typedef struct branches {
  const strut_factor *factor;
  const int32_t *node; /* (n) of the scene, in the factor's order */
  int32_t *begin;      /* (threads + 1) */
  int32_t *column;     /* thread by thread, ascending; where branches meet: at the end */
  int32_t *inner;      /* (n) end of a column's entries within its branch */
  int32_t above;       /* columns where branches meet */
  int32_t *start,
      *later;    /* (above + 1), (above) their rows of L; entries from the first column above on */
  int32_t *from; /* columns of these entries, ascending */
  double *value;
  double *work; /* (n, 2) */
} branches;

struct strut_mass_shares {
  const strut_mass *mass;
  int threads;
  int32_t *single_begin, *single; /* coordinates that no mass couples, thread by thread */
  strut_mass_operator *blocks;    /* (threads) the blocks of each, where x and y share them */
  branches branches;              /* where x and y share a factor */
  double *work[2];                /* (n) of each coordinate, where they have one each */
  strut_arena arena;
};

/* ---- the tree ---- */

typedef struct tree {
  int32_t n, *parent, *child, *sibling; /* -1: none */
  double *weight;                       /* of a column and all below it */
} tree;

static double own_weight(const strut_factor *f, int32_t j) {
  return 4.0 + f->start[j + 1] - f->start[j];
}

static bool find_tree(const strut_factor *f, strut_arena *arena, tree *t) {
  size_t n = (size_t)f->n;
  *t = (tree){.n = f->n};
  t->parent = strut_arena_allocate(arena, n, sizeof *t->parent);
  t->child = strut_arena_allocate(arena, n + 1, sizeof *t->child); /* at n: the roots */
  t->sibling = strut_arena_allocate(arena, n, sizeof *t->sibling);
  t->weight = strut_arena_allocate(arena, n + 1, sizeof *t->weight);
  if (!t->parent || !t->child || !t->sibling || !t->weight) return false;
  for (int32_t j = 0; j <= f->n; j++) t->child[j] = -1;
  for (int32_t j = 0; j < f->n; j++) {
    int32_t up = f->start[j] < f->start[j + 1] ? f->row[f->start[j]] : f->n;
    t->parent[j] = up;
    t->weight[j] += own_weight(f, j);
    t->weight[up] += t->weight[j];
    t->sibling[j] = t->child[up];
    t->child[up] = j;
  }
  return true;
}

typedef struct division {
  int32_t branch[MOST_BRANCHES], count;
  int owner[MOST_BRANCHES];
  double above; /* work of the columns above */
} division;

/* Each branch to the thread with the least so far, the heaviest first; returns what the busiest one has. */
static double share_out(const tree *t, int threads, division *d) {
  double load[MOST_BRANCHES] = {0}, most = 0.0;
  bool given[MOST_BRANCHES] = {false};
  for (int32_t i = 0; i < d->count; i++) {
    int32_t heavy = -1;
    int least = 0;
    for (int32_t b = 0; b < d->count; b++)
      if (!given[b] && (heavy < 0 || t->weight[d->branch[b]] > t->weight[d->branch[heavy]]))
        heavy = b;
    for (int p = 1; p < threads && p < MOST_BRANCHES; p++)
      if (load[p] < load[least]) least = p;
    given[heavy] = true;
    d->owner[heavy] = least;
    load[least] += t->weight[d->branch[heavy]];
    most = fmax(most, load[least]);
  }
  return most;
}

/* Puts the heaviest branch's column above, and what is below it in its place. False: too many. */
static bool split_heaviest(const strut_factor *f, const tree *t, division *d) {
  int32_t heavy = 0, children = 0;
  for (int32_t b = 1; b < d->count; b++)
    if (t->weight[d->branch[b]] > t->weight[d->branch[heavy]]) heavy = b;
  int32_t j = d->branch[heavy];
  for (int32_t c = t->child[j]; c >= 0; c = t->sibling[c]) children++;
  if (children == 0 || d->count - 1 + children > MOST_BRANCHES) return false;
  d->above += own_weight(f, j);
  d->branch[heavy] = d->branch[--d->count];
  for (int32_t c = t->child[j]; c >= 0; c = t->sibling[c]) d->branch[d->count++] = c;
  return true;
}

/* The division with the least time; one without branches where none saves any. */
static void divide(const strut_factor *f, const tree *t, int threads, division *best) {
  division d = {.count = 0};
  double all = t->weight[t->n], least = 0.9 * all;
  *best = d;
  for (int32_t c = t->child[t->n]; c >= 0; c = t->sibling[c]) {
    if (d.count == MOST_BRANCHES) return;
    d.branch[d.count++] = c;
  }
  do {
    double time = share_out(t, threads, &d) + d.above;
    if (time < 0.99 * least) *best = d, least = time;
    if (time < 1.05 * all / threads) return;
  } while (d.above < MOST_ABOVE * all && split_heaviest(f, t, &d));
}

/* ---- who solves what ---- */

enum { ABOVE = -1 };

/* Roots one after the other to the thread with the least so far: so many that it does not matter which. */
static void share_roots(const tree *t, int threads, double *load, int32_t *owner) {
  for (int32_t c = t->child[t->n]; c >= 0; c = t->sibling[c]) {
    int least = 0;
    for (int p = 1; p < threads; p++)
      if (load[p] < load[least]) least = p;
    owner[c] = least;
    load[least] += t->weight[c];
  }
}

static void find_owners(const strut_factor *f, const tree *t, int threads, double *load,
                        int32_t *owner) {
  division d;
  int32_t roots = 0;
  for (int32_t c = t->child[t->n]; c >= 0; c = t->sibling[c]) roots++;
  for (int32_t j = 0; j < f->n; j++) owner[j] = ABOVE;
  divide(f, t, threads, &d);
  for (int32_t b = 0; b < d.count; b++) owner[d.branch[b]] = d.owner[b];
  if (d.count == 0 && roots > MOST_BRANCHES)
    share_roots(t, threads, load, owner);
  else if (d.count == 0)
    for (int32_t c = t->child[t->n]; c >= 0; c = t->sibling[c]) owner[c] = 0;
  for (int32_t j = f->n - 1; j >= 0; j--)
    if (owner[j] == ABOVE && t->parent[j] < f->n) owner[j] = owner[t->parent[j]];
}

/* Columns thread by thread, those above at the end; and where each column leaves its branch. */
static void list_columns(branches *b, int threads, const int32_t *owner) {
  const strut_factor *f = b->factor;
  for (int32_t j = 0; j < f->n; j++) b->begin[owner[j] == ABOVE ? threads + 1 : owner[j] + 1]++;
  for (int p = 0; p <= threads; p++) b->begin[p + 1] += b->begin[p];
  b->above = f->n - b->begin[threads];
  for (int p = 0; p <= threads; p++) {
    int32_t at = b->begin[p];
    for (int32_t j = 0; j < f->n; j++)
      if (owner[j] == (p < threads ? p : ABOVE)) b->column[at++] = j;
  }
  for (int32_t j = 0; j < f->n; j++) {
    int32_t k = f->start[j];
    while (k < f->start[j + 1] && owner[f->row[k]] != ABOVE) k++;
    b->inner[j] = k;
  }
}

/* The rows of L above: what branches leave to them, and what they leave each other. */
static bool list_rows(branches *b, int threads, const int32_t *owner, strut_arena *arena,
                      strut_arena *scratch) {
  const strut_factor *f = b->factor;
  const int32_t *columns = b->column + b->begin[threads];
  int32_t *place = strut_arena_allocate(scratch, (size_t)f->n, sizeof *place);
  int32_t *next = strut_arena_allocate(scratch, (size_t)b->above + 1, sizeof *next);
  b->start = strut_arena_allocate(arena, (size_t)b->above + 1, sizeof *b->start);
  b->later = strut_arena_allocate(arena, (size_t)b->above, sizeof *b->later);
  if (!place || !next || !b->start || !b->later) return false;
  for (int32_t i = 0; i < b->above; i++) place[columns[i]] = i;
  for (int32_t j = 0; j < f->n; j++)
    for (int32_t k = b->inner[j]; k < f->start[j + 1]; k++) b->start[place[f->row[k]] + 1]++;
  for (int32_t i = 0; i < b->above; i++) b->start[i + 1] += b->start[i];
  size_t entries = (size_t)b->start[b->above];
  b->from = strut_arena_allocate(arena, entries, sizeof *b->from);
  b->value = strut_arena_allocate(arena, entries, sizeof *b->value);
  if (!b->from || !b->value) return false;
  for (int32_t i = 0; i < b->above; i++) next[i] = b->start[i], b->later[i] = b->start[i + 1];
  for (int32_t j = 0; j < f->n; j++)
    for (int32_t k = b->inner[j]; k < f->start[j + 1]; k++) {
      int32_t i = place[f->row[k]], to = next[i]++;
      if (owner[j] == ABOVE && to < b->later[i]) b->later[i] = to;
      b->from[to] = j, b->value[to] = f->value[k];
    }
  return true;
}

static bool make_branches(const strut_mass_operator *op, int threads, strut_arena *arena,
                          branches *b) {
  const strut_factor *f = b->factor = op->factor;
  strut_arena scratch = {0};
  tree t;
  size_t n = (size_t)f->n;
  b->node = op->factor_node;
  int32_t *owner = strut_arena_allocate(&scratch, n, sizeof *owner);
  double *load = strut_arena_allocate(&scratch, (size_t)threads, sizeof *load);
  b->begin = strut_arena_allocate(arena, (size_t)threads + 2, sizeof *b->begin);
  b->column = strut_arena_allocate(arena, n, sizeof *b->column);
  b->inner = strut_arena_allocate(arena, n, sizeof *b->inner);
  b->work = strut_arena_allocate(arena, 2 * n, sizeof *b->work);
  bool good =
      owner && load && b->begin && b->column && b->inner && b->work && find_tree(f, &scratch, &t);
  if (good) find_owners(f, &t, threads, load, owner);
  if (good) list_columns(b, threads, owner);
  good = good && list_rows(b, threads, owner, arena, &scratch);
  strut_arena_free(&scratch);
  return good;
}

/* ---- the other nodes ---- */

/* Coordinates that are neither in a block nor in a factor. */
static bool list_singles(strut_mass_shares *s, const strut_model *model) {
  const strut_mass *mass = s->mass;
  int32_t length = model->length, count = 0;
  strut_arena scratch = {0};
  bool *coupled = strut_arena_allocate(&scratch, (size_t)length, sizeof *coupled);
  s->single = strut_arena_allocate(&s->arena, (size_t)length, sizeof *s->single);
  s->single_begin = strut_arena_allocate(&s->arena, (size_t)s->threads + 1, sizeof(int32_t));
  bool good = coupled && s->single && s->single_begin;
  for (int c = 0; c < 2 && good; c++) {
    const strut_mass_operator *op = &mass->coordinate[c];
    const uint32_t *at = op->block_at;
    for (int32_t b = 0; b < op->block_count; b++)
      for (int32_t i = 0; i < op->block_size[b]; i++) coupled[*at++ + (uint32_t)c] = true;
    for (int32_t i = 0; op->factor && i < op->factor->n; i++)
      coupled[2 * op->factor_node[i] + c] = true;
  }
  for (int32_t i = 0; i < length && good && mass->any_single; i++)
    if (!coupled[i]) s->single[count++] = i;
  for (int p = 0; p <= s->threads && good; p++)
    s->single_begin[p] = (int32_t)((int64_t)count * p / s->threads);
  strut_arena_free(&scratch);
  return good;
}

/* Blocks of nodes in equal numbers. */
static bool share_blocks(strut_mass_shares *s) {
  const strut_mass_operator *op = &s->mass->coordinate[0];
  const uint32_t *at = op->block_at;
  const double *inverse = op->block_inverse;
  s->blocks = strut_arena_allocate(&s->arena, (size_t)s->threads, sizeof *s->blocks);
  for (int p = 0; p < s->threads && s->blocks; p++) {
    int32_t begin = (int32_t)((int64_t)op->block_count * p / s->threads);
    int32_t end = (int32_t)((int64_t)op->block_count * (p + 1) / s->threads);
    s->blocks[p] = (strut_mass_operator){.block_count = end - begin, .block_size = op->block_size};
    s->blocks[p].block_size += op->block_count ? begin : 0;
    s->blocks[p].block_at = at, s->blocks[p].block_inverse = inverse;
    for (int32_t b = begin; b < end; b++)
      at += op->block_size[b], inverse += op->block_size[b] * op->block_size[b];
  }
  return s->blocks;
}

strut_mass_shares *strut_mass_shares_create(const strut_model *model, int threads) {
  strut_mass_shares *s = strut_allocate(1, sizeof *s);
  if (!s) return NULL;
  s->mass = model->mass, s->threads = threads;
  bool good = list_singles(s, model);
  if (s->mass->shared) {
    good = good && share_blocks(s);
    if (good && s->mass->coordinate[0].factor)
      good = make_branches(&s->mass->coordinate[0], threads, &s->arena, &s->branches);
  }
  for (int c = 0; c < 2 && good && !s->mass->shared; c++)
    good = (s->work[c] = strut_arena_allocate(&s->arena, (size_t)model->length, sizeof(double)));
  if (good) return s;
  strut_mass_shares_free(s);
  return NULL;
}

void strut_mass_shares_free(strut_mass_shares *shares) {
  if (!shares) return;
  strut_arena_free(&shares->arena);
  strut_release(shares);
}

/* ---- solving ---- */

/* What a thread's branches leave, and their entries of L^-1 f. */
static void forward(const branches *b, int32_t begin, int32_t end) {
  const strut_factor *f = b->factor;
  const int32_t *restrict row = f->row;
  const double *restrict value = f->value;
  double *restrict work = b->work;
  for (int32_t i = begin; i < end; i++) {
    int32_t j = b->column[i], last = b->inner[j];
    strut_pair x = strut_pair_load(work + 2 * j);
    for (int32_t k = f->start[j]; k < last; k++)
      strut_pair_store(work + 2 * row[k], strut_pair_load(work + 2 * row[k]) - value[k] * x);
  }
}

/* The place of row i of those above in `work`. */
static double *row_above(const branches *b, int32_t i) {
  return b->work + 2 * b->column[b->factor->n - b->above + i];
}

/* Some entries of a row of those above. */
STRUT_INLINE strut_pair gather(const branches *b, strut_pair x, int32_t begin, int32_t end) {
  for (int32_t k = begin; k < end; k++)
    x -= b->value[k] * strut_pair_load(b->work + 2 * b->from[k]);
  return x;
}

/* What branches leave to rows begin to end, four at a time, since each sum waits for itself. */
static void gather_branches(const branches *b, int32_t begin, int32_t end) {
  enum { SIDE = 4 };
  const double *restrict value = b->value, *restrict work = b->work;
  const int32_t *restrict from = b->from;
  int32_t i = begin;
  for (; i + SIDE <= end; i += SIDE) {
    const int32_t *s = b->start + i;
    strut_pair x[SIDE];
    int32_t least = INT32_MAX;
    for (int r = 0; r < SIDE; r++) {
      x[r] = strut_pair_load(row_above(b, i + r));
      if (b->later[i + r] - s[r] < least) least = b->later[i + r] - s[r];
    }
    for (int32_t k = 0; k < least; k++)
      for (int r = 0; r < SIDE; r++)
        x[r] -= value[s[r] + k] * strut_pair_load(work + 2 * from[s[r] + k]);
    for (int r = 0; r < SIDE; r++)
      strut_pair_store(row_above(b, i + r), gather(b, x[r], s[r] + least, b->later[i + r]));
  }
  for (; i < end; i++) {
    strut_pair x = strut_pair_load(row_above(b, i));
    strut_pair_store(row_above(b, i), gather(b, x, b->start[i], b->later[i]));
  }
}

/* What rows above leave each other. */
static void gather_above(const branches *b) {
  for (int32_t i = 0; i < b->above; i++) {
    strut_pair x = strut_pair_load(row_above(b, i));
    strut_pair_store(row_above(b, i), gather(b, x, b->later[i], b->start[i + 1]));
  }
}

static void backward(const branches *b, int32_t begin, int32_t end, double *acceleration) {
  const strut_factor *f = b->factor;
  const int32_t *restrict row = f->row;
  const double *restrict value = f->value;
  double *restrict work = b->work;
  for (int32_t i = end - 1; i >= begin; i--) {
    int32_t j = b->column[i];
    strut_pair x = strut_pair_load(work + 2 * j) * f->inverse_diagonal[j];
    for (int32_t k = f->start[j]; k < f->start[j + 1]; k++)
      x -= value[k] * strut_pair_load(work + 2 * row[k]);
    strut_pair_store(work + 2 * j, x);
    strut_pair_store(acceleration + 2 * b->node[j], x);
  }
}

static void solve_branches(const strut_mass_shares *s, strut_thread_pool *pool, int thread,
                           const double *force, double *acceleration) {
  const branches *b = &s->branches;
  int32_t begin = b->begin[thread], end = b->begin[thread + 1], n = b->factor->n;
  int32_t first = n - b->above;
  for (int32_t i = begin; i < end; i++) {
    int32_t j = b->column[i];
    strut_pair_store(b->work + 2 * j, strut_pair_load(force + 2 * b->node[j]));
  }
  forward(b, begin, end);
  if (b->above) {
    strut_thread_pool_meet(pool);
    int32_t from = (int32_t)((int64_t)b->above * thread / s->threads);
    int32_t to = (int32_t)((int64_t)b->above * (thread + 1) / s->threads);
    for (int32_t i = from; i < to; i++)
      strut_pair_store(row_above(b, i), strut_pair_load(force + 2 * b->node[b->column[first + i]]));
    gather_branches(b, from, to);
    strut_thread_pool_meet(pool);
    if (thread == 0) gather_above(b);
    if (thread == 0) backward(b, first, n, acceleration);
    strut_thread_pool_meet(pool);
  }
  backward(b, begin, end, acceleration);
}

void strut_mass_shares_solve(const strut_mass_shares *s, strut_thread_pool *pool, int thread,
                             const double *force, double *acceleration) {
  const strut_mass *mass = s->mass;
  const double *inverse = mass->inverse;
  for (int32_t i = s->single_begin[thread]; i < s->single_begin[thread + 1]; i++)
    acceleration[s->single[i]] = force[s->single[i]] * inverse[s->single[i]];
  if (mass->shared) {
    mass_blocks(&s->blocks[thread], true, force, acceleration);
    if (s->branches.factor) solve_branches(s, pool, thread, force, acceleration);
    return;
  }
  for (int c = 0; c < 2; c++) {
    const strut_mass_operator *op = &mass->coordinate[c];
    if (c % s->threads != thread) continue;
    mass_blocks(op, false, force + c, acceleration + c);
    if (op->factor) strut_mass_factor_single(op, force + c, acceleration + c, s->work[c]);
  }
}
