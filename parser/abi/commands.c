/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The library's commands: of each the options that the program's command of that name has, files apart. */
#include "parser/abi/handles.h"
#include "parser/command/fidelity_settings.h"
#include "parser/command/path_options.h"
#include "parser/command/run_settings.h"
#include "parser/command/statics_options.h"

#define END                                                                                        \
  { STRUT_OPTION_END, NULL, NULL, NULL }
#define FORCE                                                                                      \
  { STRUT_OPTION_FORCE, "force", NULL, "run even if the step exceeds the stability limit" }

static const strut_option run_options[] = {
    FORCE,
    STRUT_RUN_SETTING_OPTIONS,
    STRUT_FIDELITY_OPTIONS,
    {STRUT_OPTION_CHANNELS, "channels", "NAME,...", "channels to record, instead of the scene's"},
    {STRUT_OPTION_RECORD, "record", "YES|NO", "record channels (default yes)"},
    END};
static const strut_option equilibria_options[] = {STRUT_EQUILIBRIA_OPTIONS, END};
static const strut_option modes_options[] = {STRUT_MODES_OPTIONS, END};
static const strut_option rigidity_options[] = {STRUT_SHAPE_OPTIONS, END};
static const strut_option form_options[] = {STRUT_FORM_OPTIONS, END};
static const strut_option path_options[] = {STRUT_PATH_OPTIONS, END};
static const strut_option simulation_options[] = {
    FORCE,
    {STRUT_OPTION_INTEGRATOR, "integrator", "NAME",
     "integration method, instead of that of the file"},
    {STRUT_OPTION_STEP, "step", "TIME", "time step, instead of that of the file"},
    {STRUT_OPTION_TOLERANCE, "tolerance", "X", "error tolerance of the method adaptive"},
    STRUT_FIDELITY_OPTIONS,
    END};
static const strut_option sweep_options[] = {
    {STRUT_OPTION_COMPUTE, "compute", "WHAT",
     "run (default), equilibria, modes, rigidity, path or form"},
    {STRUT_OPTION_AT, "at", "NAME", "equilibrium of modes, rigidity and path"},
    {STRUT_OPTION_LOWEST, "lowest", "N", "number of energies, barriers and frequencies in a row"},
    {STRUT_OPTION_LIMIT_EVALUATIONS, "limit_evaluations", "N",
     "force evaluations after which a point fails"},
    {STRUT_OPTION_LIMIT_TIME, "limit_time", "TIME", "time after which a point fails"},
    {STRUT_OPTION_THREADS, "threads", "N", "number of threads (default automatic)"},
    {STRUT_OPTION_LANES, "lanes", "N", "points in lockstep in a thread (default automatic)"},
    STRUT_RUN_SETTING_OPTIONS,
    STRUT_FIDELITY_OPTIONS,
    END};

const strut_command abi_run_command = {.name = "run", .options = run_options},
                    abi_equilibria_command = {.name = "equilibria", .options = equilibria_options},
                    abi_modes_command = {.name = "modes", .options = modes_options},
                    abi_rigidity_command = {.name = "rigidity", .options = rigidity_options},
                    abi_form_command = {.name = "form", .options = form_options},
                    abi_path_command = {.name = "path", .options = path_options},
                    abi_matrices_command = {.name = "matrices", .options = rigidity_options},
                    abi_sweep_command = {.name = "sweep", .options = sweep_options},
                    abi_simulation_command = {.name = "simulation_open",
                                              .options = simulation_options};

const strut_command *abi_command_at(size_t i) {
  static const strut_command *const all[] = {
      &abi_run_command,      &abi_equilibria_command, &abi_modes_command,
      &abi_rigidity_command, &abi_form_command,       &abi_path_command,
      &abi_matrices_command, &abi_sweep_command,      &abi_simulation_command};
  return i < sizeof all / sizeof all[0] ? all[i] : NULL;
}
