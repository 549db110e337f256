/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/study/cluster/slurm_script.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/memory.h"
#include "engine/study/cluster/script_page.h"
#include "engine/study/results/shard.h"

/* Seconds before the time is over in which a task finishes its points. */
enum { NOTICE = 120, MOST_RESTARTS = 1000, MOST_NAME = 60 };

/* A name for the queue: plain characters only. */
static void plain_name(const char *name, char plain[MOST_NAME + 1]) {
  size_t length = 0;
  for (; name[length] && length < MOST_NAME; length++) {
    unsigned char c = (unsigned char)name[length];
    plain[length] = (char)(c < 0x80 && (isalnum(c) || strchr("._-", c)) ? c : '_');
  }
  plain[length] = '\0';
}

static bool is_plain(const char *text, const char *others) {
  size_t length = 0;
  if (!text) return true;
  for (; text[length]; length++)
    if (!isdigit((unsigned char)text[length]) && !strchr(others, text[length])) return false;
  return length > 0 && length < 32 && isdigit((unsigned char)text[0]);
}

static strut_status check(const strut_slurm_script *s, strut_error *error) {
  if (s->shards < 1 || s->shards > STRUT_MOST_SHARDS)
    return strut_fail(error, STRUT_USAGE, "a study has 1 to %d shards", STRUT_MOST_SHARDS);
  if (!is_plain(s->time, ":-"))
    return strut_fail(error, STRUT_USAGE,
                      "'%s' is no time for Slurm: minutes, H:M:S or D-H:M:S, such as 12:00:00",
                      s->time);
  if (!is_plain(s->memory, "KMGT"))
    return strut_fail(error, STRUT_USAGE, "'%s' is no memory for Slurm, such as 500M or 2G",
                      s->memory);
  return STRUT_OK;
}

static void say_head(strut_page *p, const strut_slurm_script *s, const char *name) {
  strut_page_say(p, "#!/bin/sh\n");
  strut_page_format(p, "#SBATCH --job-name=%s\n#SBATCH --array=0-%lld\n", name,
                    (long long)s->shards - 1);
  strut_page_say(p, "#SBATCH --nodes=1\n#SBATCH --ntasks=1\n");
  if (s->cpus) strut_page_format(p, "#SBATCH --cpus-per-task=%lld\n", (long long)s->cpus);
  if (s->time) strut_page_format(p, "#SBATCH --time=%s\n", s->time);
  if (s->memory) strut_page_format(p, "#SBATCH --mem=%s\n", s->memory);
  strut_page_format(
      p, "#SBATCH --requeue\n#SBATCH --open-mode=append\n#SBATCH --signal=B:USR1@%d\n", NOTICE);
  strut_page_format(
      p, "# A study in %lld shards as an array of jobs, and their table when all have ended.\n",
      (long long)s->shards);
  strut_page_say(
      p,
      "#\n"
      "#   sh FILE                 sends both to the queue\n"
      "#   sh FILE --array=2,5     the same for some shards only\n"
      "#\n"
      "# Further options go to sbatch; SBATCH_PARTITION, SBATCH_ACCOUNT, ... hold for both jobs.\n"
      "# What is done is not computed again, so the same command goes on after any trouble. A\n"
      "# shard whose time is over goes back to the queue by itself.\n");
}

/* The part that runs where the script is called: it sends the rest of itself to the queue. */
static void say_sending(strut_page *p, const strut_slurm_script *s, const char *name) {
  strut_page_say(
      p,
      "case $0 in /*) script=$0 ;; *) script=$PWD/$0 ;; esac\n"
      "cd \"$folder\" || exit 4\n\n"
      "if [ -z \"${SLURM_ARRAY_TASK_ID:-}\" ]; then # not yet in the queue\n"
      "  mkdir -p \"$results\" || exit 4\n"
      "  shards=$(sbatch --parsable --chdir=\"$folder\" --output=\"$results/slurm-%A-%a.log\" \\\n"
      "    \"$@\" \"$script\") || exit\n"
      "  table=$(sbatch --parsable --chdir=\"$folder\" --output=\"$results/slurm-%j-merge.log\" "
      "\\\n"
      "    --dependency=\"afterany:${shards%%;*}\" ");
  strut_page_format(p, "--job-name=%s-merge ", name);
  if (s->time) strut_page_format(p, "--time=%s ", s->time);
  strut_page_say(p, "<<'END'\n#!/bin/sh\nexec ");
  strut_page_word(p, s->program);
  strut_page_say(p, " merge ");
  strut_page_word(p, s->output);
  strut_page_say(p,
                 "\nEND\n"
                 "  ) || exit\n"
                 "  echo \"the shards are job ${shards%%;*}, their table is job ${table%%;*}\"\n"
                 "  exit\n"
                 "fi\n\n");
}

/* The part that is a task of the array. */
static void say_task(strut_page *p, const strut_slurm_script *s) {
  strut_page_say(p, "again=\n\"$strut\" sweep \"$study\" -o \"$results\"");
  for (size_t i = 0; i < s->word_count; i++) {
    strut_page_say(p, " ");
    strut_page_word(p, s->words[i]);
  }
  strut_page_format(p, " --shard slurm/%lld &\n", (long long)s->shards);
  strut_page_say(
      p,
      "child=$!\n"
      "trap 'again=yes; kill -TERM \"$child\"' USR1 # the time is nearly over\n"
      "trap 'kill -TERM \"$child\"' TERM\n"
      "wait \"$child\"\n"
      "code=$?\n"
      "while kill -0 \"$child\" 2>/dev/null; do # a signal ended the wait, not the shard\n"
      "  wait \"$child\"\n"
      "  code=$?\n"
      "done\n");
  strut_page_format(p,
                    "if [ -n \"$again\" ] && [ \"$code\" -eq 130 ] &&\n"
                    "  [ \"${SLURM_RESTART_COUNT:-0}\" -lt %d ]; then\n",
                    MOST_RESTARTS);
  strut_page_say(p,
                 "  scontrol requeue \"${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID\"\n"
                 "fi\n"
                 "exit \"$code\"\n");
}

strut_status strut_slurm_script_write(const strut_slurm_script *script, char **text,
                                      strut_error *error) {
  char name[MOST_NAME + 1];
  strut_page p = {0};
  *text = NULL;
  strut_status status = check(script, error);
  if (status != STRUT_OK) return status;
  plain_name(*script->name ? script->name : "study", name);
  say_head(&p, script, name);
  strut_page_assignment(&p, "strut", script->program);
  strut_page_assignment(&p, "folder", script->folder);
  strut_page_assignment(&p, "study", script->study);
  strut_page_assignment(&p, "results", script->output);
  say_sending(&p, script, name);
  say_task(&p, script);
  if (p.failed) {
    strut_release(p.text);
    return strut_fail(error, STRUT_NO_MEMORY, "out of memory for the script");
  }
  *text = p.text;
  return STRUT_OK;
}
