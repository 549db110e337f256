/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The crawler straight from the paper, slowly: equations (1) to (10), (14) and (15), Table 1.
 *
 * It shares no code with strut, so that strut can be compared with it. The mass matrix is the dense
 * one of all ten coordinates, inverted by GSL.
 *
 * See reference_crawler.h.
 */
#include "tests/paper/reference_crawler.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

enum { NODES = REFERENCE_NODES, MEMBERS = 9, DOF = 2 * NODES };

/* Table 1: nodes i1 - i2, lambda_0 [m], c [N/m], k [N s/m], m [kg]. */
static const struct {
  int i1, i2;
  double lambda0, c, k, m;
} table1[MEMBERS] = {
    {1, 2, 0.10, 1e6, 0.2, 0.1},  {3, 5, 0.02, 1e6, 0.2, 0.02}, {4, 5, 0.02, 1e6, 0.2, 0.02},
    {1, 3, 0.02, 3000, 0.2, 0.0}, {2, 3, 0.02, 3000, 0.2, 0.0}, {2, 4, 0.02, 3000, 0.2, 0.0},
    {1, 4, 0.02, 3000, 0.2, 0.0}, {1, 5, 0.01, 1e4, 0.2, 0.0},  {2, 5, 0.01, 1e4, 0.2, 0.0}};
static const double gravity = 9.81, ground_c = 1e5, ground_k = 100.0, stick_velocity = 1e-4;
static const int driven = 7; /* member 8 */

static const double state_one[DOF] = {0.0,       0.0,       0.0965109, 0.0238714, 0.0526668,
                                      0.0283691, 0.0602933, 0.0,       0.0434758, 0.0106875};

typedef reference_crawler crawler;

static double sign(double x) { return x > 0 ? 1.0 : x < 0 ? -1.0 : 0.0; }

static void mass_matrix(double mass[DOF][DOF]) {
  memset(mass, 0, sizeof(double[DOF][DOF]));
  for (int j = 0; j < MEMBERS; j++)
    for (int axis = 0; axis < 2; axis++) {
      int a = 2 * (table1[j].i1 - 1) + axis, b = 2 * (table1[j].i2 - 1) + axis;
      mass[a][a] += table1[j].m / 3, mass[b][b] += table1[j].m / 3;
      mass[a][b] += table1[j].m / 6, mass[b][a] += table1[j].m / 6;
    }
}

/* (1), (2), (6), (7): everything but the contact; force has DOF entries. */
static void applied_forces(const crawler *it, double t, const double *q, const double *qdot,
                           double *force) {
  memset(force, 0, DOF * sizeof *force);
  for (int j = 0; j < MEMBERS; j++) {
    int a = 2 * (table1[j].i1 - 1), b = 2 * (table1[j].i2 - 1);
    double lambda[2] = {q[b] - q[a], q[b + 1] - q[a + 1]};
    double rate[2] = {qdot[b] - qdot[a], qdot[b + 1] - qdot[a + 1]};
    double length = sqrt(lambda[0] * lambda[0] + lambda[1] * lambda[1]);
    double along = (rate[0] * lambda[0] + rate[1] * lambda[1]) / length;
    for (int axis = 0; axis < 2; axis++) {
      double spring = -table1[j].c * (length - table1[j].lambda0) / length * lambda[axis];
      double damper = -table1[j].k * along * lambda[axis] / length;
      double drive = 0.0;
      if (j == driven) {
        double omega = 2 * acos(-1.0) * it->frequency;
        double s = it->amplitude * sin(omega * t), sdot = it->amplitude * omega * cos(omega * t);
        bool rests = it->half_wave && t > 0.5 / it->frequency; /* (15), as the notes settle it */
        if (!rests) drive = (table1[j].c * s + table1[j].k * sdot) * lambda[axis] / length;
      }
      force[b + axis] += spring + damper + drive;
      force[a + axis] -= spring + damper + drive;
    }
    force[a + 1] -= table1[j].m * gravity / 2;
    force[b + 1] -= table1[j].m * gravity / 2;
  }
}

/* (8) and (9), as printed. */
static void add_contact(const crawler *it, const double *q, const double *qdot, double *force) {
  for (int i = 0; i < NODES; i++) {
    double y = q[2 * i + 1], xdot = qdot[2 * i], ydot = qdot[2 * i + 1];
    double normal = 0.0, friction, resultant = force[2 * i];
    if (y >= 0)
      normal = 0.0;
    else if (ydot >= 0)
      normal = -ground_c * y;
    else
      normal = -ground_c * y - ground_k * ydot;
    if (fabs(xdot) >= stick_velocity)
      friction = -it->mu * normal * sign(xdot);
    else if (fabs(resultant) >= it->mu * normal)
      friction = -it->mu * normal * sign(resultant);
    else
      friction = -resultant;
    force[2 * i] += friction;
    force[2 * i + 1] += normal;
  }
}

/* State z = (q, qdot); (10). */
static void derivative(const crawler *it, double t, const double *z, double *zdot) {
  double force[DOF];
  applied_forces(it, t, z, z + DOF, force);
  add_contact(it, z, z + DOF, force);
  for (int i = 0; i < DOF; i++) {
    zdot[i] = z[DOF + i];
    zdot[DOF + i] = 0;
    for (int j = 0; j < DOF; j++) zdot[DOF + i] += it->inverse_mass[i][j] * force[j];
  }
}

static void rk4_step(const crawler *it, double t, double half_t, double end_t, double dt,
                     double *z) {
  double k1[2 * DOF], k2[2 * DOF], k3[2 * DOF], k4[2 * DOF], w[2 * DOF];
  derivative(it, t, z, k1);
  for (int i = 0; i < 2 * DOF; i++) w[i] = z[i] + dt / 2 * k1[i];
  derivative(it, half_t, w, k2);
  for (int i = 0; i < 2 * DOF; i++) w[i] = z[i] + dt / 2 * k2[i];
  derivative(it, half_t, w, k3);
  for (int i = 0; i < 2 * DOF; i++) w[i] = z[i] + dt * k3[i];
  derivative(it, end_t, w, k4);
  for (int i = 0; i < 2 * DOF; i++) z[i] += dt / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
}

static double kinetic_energy(const double *qdot) {
  double mass[DOF][DOF], sum = 0.0;
  mass_matrix(mass);
  for (int i = 0; i < DOF; i++)
    for (int j = 0; j < DOF; j++) sum += 0.5 * qdot[i] * mass[i][j] * qdot[j];
  return sum;
}

/* Kinetic damping: at each peak of the kinetic energy all velocities become zero. */
int reference_settle(const crawler *with_drive, double dt, double *z) {
  crawler it = *with_drive;
  it.amplitude = 0, it.mu = 0;
  double before = 0.0, zdot[2 * DOF];
  for (long step = 0; step < 4000000; step++) {
    rk4_step(&it, 0, 0, 0, dt, z);
    double now = kinetic_energy(z + DOF), fastest = 0.0;
    derivative(&it, 0, z, zdot);
    for (int i = 0; i < 2 * DOF; i++) fastest = fmax(fastest, fabs(zdot[i]));
    if (fastest < 1e-8) return 1; /* speeds and accelerations */
    if (now < before) {
      memset(z + DOF, 0, DOF * sizeof *z);
      now = 0;
    }
    before = now;
  }
  return 0;
}

double reference_centre(const double *q) {
  double moment = 0.0, mass = 0.0;
  for (int j = 0; j < MEMBERS; j++) {
    double middle = 0.5 * (q[2 * (table1[j].i1 - 1)] + q[2 * (table1[j].i2 - 1)]);
    moment += table1[j].m * middle, mass += table1[j].m;
  }
  return moment / mass;
}

/* State II is the mirror image of I: x becomes -x, and nodes 1 and 2 change names. */
void reference_prepare(crawler *it, int mirrored, double *z) {
  double mass[DOF][DOF];
  gsl_matrix_view inverse = gsl_matrix_view_array(*mass, DOF, DOF);
  mass_matrix(mass);
  gsl_linalg_cholesky_decomp1(&inverse.matrix);
  gsl_linalg_cholesky_invert(&inverse.matrix);
  memcpy(it->inverse_mass, mass, sizeof mass);
  memset(z, 0, 2 * DOF * sizeof *z);
  for (int i = 0; i < NODES; i++) {
    int from = mirrored && i < 2 ? 1 - i : i;
    z[2 * i] = mirrored ? -state_one[2 * from] : state_one[2 * from];
    z[2 * i + 1] = state_one[2 * from + 1];
  }
}

void reference_step(const crawler *it, long n, double dt, double *z) {
  rk4_step(it, (double)n * dt, ((double)n + 0.5) * dt, ((double)n + 1.0) * dt, dt, z);
}

void reference_run(const crawler *it, double dt, double periods, double window, double *z,
                   reference_figures *figures) {
  long steps = lround(periods / it->frequency / dt);
  long first = lround((periods - window) / it->frequency / dt);
  double start_com = 0, start_one = 0;
  long touching[NODES] = {0};
  for (int i = 0; i < NODES; i++) figures->highest[i] = -(double)INFINITY;
  for (long n = 0; n < steps; n++) {
    if (n == first) start_com = reference_centre(z), start_one = z[0];
    reference_step(it, n, dt, z);
    if (n < first) continue;
    for (int i = 0; i < NODES; i++) {
      touching[i] += z[2 * i + 1] < 0;
      figures->highest[i] = fmax(figures->highest[i], z[2 * i + 1]);
    }
  }
  double span = (double)(steps - first) * dt;
  figures->velocity = (reference_centre(z) - start_com) / span;
  figures->velocity_one = (z[0] - start_one) / span;
  for (int i = 0; i < NODES; i++) figures->duty[i] = (double)touching[i] / (double)(steps - first);
}
