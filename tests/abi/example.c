/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run, and a controller that keeps the crawler's drive in step with its own motion. */
#include <stdio.h>
#include <strut/abi.h>

/* Shows everything that is wrong, as the program does; releases the error. */
static int report(strutlib_error *error) {
  fputs(strutlib_error_report(error), stderr);
  strutlib_error_free(error);
  return 1;
}

static int run(const strutlib_scene *scene) {
  const char *names[] = {"accuracy"}, *values[] = {"0.5 %"};
  const double *y;
  double velocity;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS], i;
  int dimensions;
  strutlib_error *error;
  strutlib_result *result = strutlib_run(scene, 1, names, values, NULL, &error);
  if (!result) return report(error);
  if (strutlib_result_number(result, "velocity", &velocity))
    printf("velocity %.4g m/s, motion %s\n", velocity, strutlib_result_text(result, "steady.kind"));
  if (strutlib_result_array(result, "position.n1.y", &y, &dimensions, shape, stride)) {
    double highest = y[0];
    for (i = 0; i < shape[0]; i++)
      if (y[i * stride[0]] > highest) highest = y[i * stride[0]];
    printf("node n1 rises to %.4g m in %lu samples\n", highest, (unsigned long)shape[0]);
  }
  strutlib_result_free(result);
  return 0;
}

static int control(const strutlib_scene *scene) {
  const double *velocity;
  double *rest, rest_drawn;
  size_t shape[STRUTLIB_DIMENSIONS], stride[STRUTLIB_DIMENSIONS];
  int dimensions, status = STRUTLIB_OK;
  long driven = strutlib_index(scene, "members", "m8");
  strutlib_error *error;
  strutlib_simulation *simulation = strutlib_simulation_open(scene, 0, NULL, NULL, NULL, &error);
  if (!simulation) return report(error);
  strutlib_simulation_array(simulation, "velocity", &velocity, &dimensions, shape, stride);
  strutlib_simulation_input(simulation, "rest", &rest, &dimensions, shape, stride);
  rest_drawn = rest[driven];
  while (status == STRUTLIB_OK && strutlib_simulation_time(simulation) < 0.5) {
    rest[driven] = rest_drawn + (velocity[0] > 0 ? 0.1e-3 : -0.1e-3);
    status = strutlib_simulation_advance(simulation, 10, &error);
  }
  if (status == STRUTLIB_OK)
    printf("after %.3g s the inputs have done %.3g J of work\n",
           strutlib_simulation_time(simulation), strutlib_simulation_input_work(simulation));
  strutlib_simulation_close(simulation);
  return status == STRUTLIB_OK ? 0 : report(error);
}

int main(int count, char **arguments) {
  const char *names[] = {"frequency"}, *values[] = {"10 Hz"};
  strutlib_error *error;
  strutlib_scene *scene;
  int failed;
  if (count != 2) return 1;
  scene = strutlib_open(arguments[1], 1, names, values, &error);
  if (!scene) return report(error);
  failed = run(scene) || control(scene);
  strutlib_close(scene);
  return failed;
}
