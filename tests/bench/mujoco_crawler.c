/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/bench/mujoco_crawler.h"

#include <mujoco/mujoco.h>
#include <stdlib.h>
#include <string.h>

#include "engine/base/vec.h"

/*
 * State I in the plane y = 0, z upwards. Joint angles are measured from the bars as drawn. Only the
 * node spheres touch the plane, which lies lower by their radius. Members 8, 4, 5, 6, 7, 9.
 */
static const char text[] =
    "<mujoco model='crawler'>"
    " <compiler autolimits='false' boundmass='0' boundinertia='1e-9'/>"
    " <option timestep='1e-4' integrator='RK4' gravity='0 0 -9.81'/>"
    " <size njmax='60' nconmax='20'/>"
    " <default>"
    "  <geom contype='0' conaffinity='0'/>"
    "  <default class='bar'><geom type='capsule' size='0.0005'/></default>"
    "  <default class='node'><geom type='sphere' size='0.001' mass='0' contype='1' condim='3'"
    "   friction='0.1 0 0' solref='-1e6 -1000'/></default>"
    "  <default class='soft'><tendon stiffness='3000' damping='0.2' springlength='0.02'/></default>"
    "  <default class='strong'><tendon stiffness='1e4' damping='0.2' "
    "springlength='0.01'/></default>"
    " </default>"
    " <worldbody>"
    "  <geom type='plane' size='10 10 1' pos='0 0 -0.001' conaffinity='1' friction='0.1 0 0'/>"
    "  <body name='long'>"
    "   <joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 0 1'/>"
    "   <joint type='hinge' axis='0 1 0'/>"
    "   <geom class='bar' fromto='0 0 0 0.0965109 0 0.0238714' mass='0.1'/>"
    "   <site name='n1'/><geom class='node'/>"
    "   <site name='n2' pos='0.0965109 0 0.0238714'/>"
    "   <geom class='node' pos='0.0965109 0 0.0238714'/>"
    "  </body>"
    "  <body name='upper' pos='0.0434758 0 0.0106875'>"
    "   <joint type='slide' axis='1 0 0'/><joint type='slide' axis='0 0 1'/>"
    "   <joint type='hinge' axis='0 1 0'/>"
    "   <geom class='bar' fromto='0 0 0 0.009191 0 0.0176816' mass='0.02'/>"
    "   <site name='n5'/><geom class='node'/>"
    "   <site name='n3' pos='0.009191 0 0.0176816'/><geom class='node' pos='0.009191 0 0.0176816'/>"
    "   <body name='lower'>"
    "    <joint type='hinge' axis='0 1 0'/>"
    "    <geom class='bar' fromto='0 0 0 0.0168175 0 -0.0106875' mass='0.02'/>"
    "    <site name='n4' pos='0.0168175 0 -0.0106875'/>"
    "    <geom class='node' pos='0.0168175 0 -0.0106875'/>"
    "   </body>"
    "  </body>"
    " </worldbody>"
    " <tendon>"
    "  <spatial class='strong'><site site='n1'/><site site='n5'/></spatial>"
    "  <spatial class='soft'><site site='n1'/><site site='n3'/></spatial>"
    "  <spatial class='soft'><site site='n2'/><site site='n3'/></spatial>"
    "  <spatial class='soft'><site site='n2'/><site site='n4'/></spatial>"
    "  <spatial class='soft'><site site='n1'/><site site='n4'/></spatial>"
    "  <spatial class='strong'><site site='n2'/><site site='n5'/></spatial>"
    " </tendon>"
    "</mujoco>";

struct mujoco_crawler {
  mjModel *model;
  mjData *data;
  double frequency, amplitude, rest;
  long long step;
  int widths; /* later versions keep two spring lengths for each tendon */
};

mujoco_crawler *mujoco_crawler_create(double f, double a, char *message, size_t size) {
  mujoco_crawler *it = calloc(1, sizeof *it);
  mjVFS *files = malloc(sizeof *files);
  if (it && files) {
    mj_defaultVFS(files);
    if (mj_makeEmptyFileVFS(files, "crawler.xml", (int)sizeof text) == 0) {
      memcpy(files->filedata[mj_findFileVFS(files, "crawler.xml")], text, sizeof text);
      it->model = mj_loadXML("crawler.xml", files, message, (int)size);
    }
    mj_deleteVFS(files);
    if (it->model) it->data = mj_makeData(it->model);
  }
  free(files);
  if (!it || !it->data) {
    mujoco_crawler_free(it);
    return NULL;
  }
  const mjtNum *springs = it->model->tendon_lengthspring;
  it->widths = springs[0] == springs[1] ? 2 : 1;
  it->rest = springs[0], it->frequency = f, it->amplitude = a;
  return it;
}

void mujoco_crawler_run(mujoco_crawler *it, long long steps) {
  for (long long end = it->step + steps; it->step < end; it->step++) {
    double sine, cosine, t = ((double)it->step + 0.5) * it->model->opt.timestep;
    strut_sincos_turns(it->frequency * t, &sine, &cosine);
    for (int i = 0; i < it->widths; i++)
      it->model->tendon_lengthspring[i] = it->rest + it->amplitude * sine;
    mj_step(it->model, it->data);
  }
}

double mujoco_crawler_position(const mujoco_crawler *it) { return it->data->qpos[0]; }

void mujoco_crawler_free(mujoco_crawler *it) {
  if (!it) return;
  if (it->data) mj_deleteData(it->data);
  if (it->model) mj_deleteModel(it->model);
  free(it);
}
