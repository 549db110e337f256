/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Counting instructions: what a piece of work costs, the same on a busy machine as on an idle one.
 */
#pragma once

/**
 * Instructions that work(context) executes, by stepping a child process through it one at a time.
 * What the work changes, it changes in the child only. -1 where the machine does not allow it.
 */
long count_instructions(void (*work)(void *context), void *context);
