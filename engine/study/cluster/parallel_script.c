/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/cluster/parallel_script.h"

#include "engine/base/memory.h"
#include "engine/study/cluster/script_page.h"
#include "engine/study/results/shard.h"

static void say_head(strut_page *p, const strut_parallel_script *s) {
  strut_page_say(p, "#!/bin/sh\n");
  strut_page_format(p, "# A study in %lld shards by GNU parallel, and their table in the end.\n",
                    (long long)s->shards);
  strut_page_say(
      p,
      "#\n"
      "#   sh FILE                     on this machine\n"
      "#   sh FILE --sshlogin one,two  on machines that share this folder\n"
      "#\n"
      "# In a Slurm job of several tasks each shard is a step of the job. Further words\n"
      "# go to GNU parallel. What is done is not computed again: after any trouble the\n"
      "# same command goes on.\n");
  strut_page_assignment(p, "strut", s->program);
  strut_page_assignment(p, "folder", s->folder);
  strut_page_assignment(p, "study", s->study);
  strut_page_assignment(p, "results", s->output);
  strut_page_format(p, "cpus=%lld\nlast=%lld\n", (long long)s->cpus, (long long)s->shards - 1);
}

/* One shard, for which the script calls itself: so no shell but this one sees a path. */
static void say_shard(strut_page *p, const strut_parallel_script *s) {
  strut_page_say(p,
                 "case $0 in /*) script=$0 ;; *) script=$PWD/$0 ;; esac\n"
                 "cd \"$folder\" || exit 4\n\n"
                 "if [ \"${1:-}\" = --this-shard ]; then\n"
                 "  exec \"$strut\" sweep \"$study\" -o \"$results\"");
  for (size_t i = 0; i < s->word_count; i++) {
    strut_page_say(p, " ");
    strut_page_word(p, s->words[i]);
  }
  strut_page_format(p, " --threads \"$cpus\" --quiet \\\n    --shard \"$2/%lld\"\nfi\n\n",
                    (long long)s->shards);
}

strut_status strut_parallel_script_write(const strut_parallel_script *script, char **text,
                                         strut_error *error) {
  strut_page p = {0};
  *text = NULL;
  if (script->shards < 1 || script->shards > STRUT_MOST_SHARDS)
    return strut_fail(error, STRUT_USAGE, "a study has 1 to %d shards", STRUT_MOST_SHARDS);
  say_head(&p, script);
  say_shard(&p, script);
  strut_page_say(&p,
                 "parallel --version 2>/dev/null | grep -q '^GNU parallel' || {\n"
                 "  echo 'GNU parallel is not installed (the package parallel)' >&2\n"
                 "  exit 4\n"
                 "}\n"
                 "mkdir -p \"$results\" || exit 4\n"
                 "if [ -n \"${SLURM_JOB_ID:-}\" ] && [ \"${SLURM_NTASKS:-1}\" -gt 1 ]; then\n"
                 "  jobs=$SLURM_NTASKS\n"
                 "  step='srun --exact --nodes=1 --ntasks=1'\n"
                 "else\n"
                 "  jobs=$(($(nproc) / cpus))\n"
                 "  [ \"$jobs\" -gt 0 ] || jobs=1\n"
                 "  step=\n"
                 "fi\n"
                 "# shellcheck disable=SC2086  # a step is several words\n"
                 "parallel --will-cite --quote --jobs \"$jobs\" \"$@\" \\\n"
                 "  $step sh \"$script\" --this-shard {} ::: $(seq 0 \"$last\") </dev/null\n"
                 "exec \"$strut\" merge \"$results\" # which says what is missing, if so\n");
  if (p.failed) {
    strut_release(p.text);
    return strut_fail(error, STRUT_NO_MEMORY, "out of memory for the script");
  }
  *text = p.text;
  return STRUT_OK;
}
