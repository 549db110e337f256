/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Runs a model in MuJoCo from its first key frame, if it has one, and prints the time and the displacements of
 * all joints as a table.
 *
 *   mujoco_run FILE.xml STEP SECONDS
 */
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char **argv) {
  char error[1000] = "";
  if (argc != 4) return 1;
  mjModel *model = mj_loadXML(argv[1], NULL, error, sizeof error);
  if (!model) {
    fprintf(stderr, "%s\n", error);
    return 2;
  }
  mjData *data = mj_makeData(model);
  model->opt.timestep = atof(argv[2]);
  if (model->nkey) mj_resetDataKeyframe(model, data, 0);
  printf("time");
  for (int i = 0; i < model->njnt; i++) printf(",%s", mj_id2name(model, mjOBJ_JOINT, i));
  printf("\n");
  for (int left = (int)(atof(argv[3]) / atof(argv[2]) + 0.5); left > 0; left--) {
    mj_step(model, data);
    printf("%.17g", data->time);
    for (int i = 0; i < model->nq; i++) printf(",%.17g", data->qpos[i]);
    printf("\n");
  }
  mj_deleteData(data);
  mj_deleteModel(model);
  return 0;
}
