/* SPDX-License-Identifier: GPL-3.0-or-later
 * A throw-away rival: contact solvers of Siconos (Debian 4.4.0) on a problem in space, local or global, that
 * contact_solvers.py --siconos writes as a text of Siconos.
 * gcc -O2 -I/usr/include/siconos -I/usr/include/siconos/numerics siconos_solve.c -o siconos_solve -lsiconos_numerics -lsiconos_externals -lm
 * usage: siconos_solve problem.dat fc3d_nsgs|fc3d_nsn_ac|gfc3d_nsgs|gfc3d_nsn_ac|gfc3d_nsgs_wr|gfc3d_nsn_ac_wr \
 *                      tolerance seconds impulses.bin
 * Solvers have their default options, but as many iterations as fit into the time, which is that of the processor. Runs
 * are repeated as those of nscdd are: until a tenth of a second is over, ten times at the most; the shortest counts.
 * impulses.bin: double seconds, what the driver returned (0: its tolerance is met; -1: the time was over, -2: r grew
 *               beyond 1e30 N s), iterations, its own error; then r, 3 per contact */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
#include "SiconosNumerics.h"
#include "NonSmoothDrivers.h"
#include "FrictionContactProblem.h"
#include "GlobalFrictionContactProblem.h"
#include "SolverOptions.h"
#include "NumericsMatrix.h"
#include "NumericsSparseMatrix.h"
#include "SparseBlockMatrix.h"
#include "Friction_cst.h"

static const struct { const char* name; int id, is_global; } solvers[] = {
  {"fc3d_nsgs", SICONOS_FRICTION_3D_NSGS, 0}, {"fc3d_nsn_ac", SICONOS_FRICTION_3D_NSN_AC, 0},
  {"gfc3d_nsgs", SICONOS_GLOBAL_FRICTION_3D_NSGS, 1}, {"gfc3d_nsn_ac", SICONOS_GLOBAL_FRICTION_3D_NSN_AC, 1},
  {"gfc3d_nsgs_wr", SICONOS_GLOBAL_FRICTION_3D_NSGS_WR, 1},
  {"gfc3d_nsn_ac_wr", SICONOS_GLOBAL_FRICTION_3D_NSN_AC_WR, 1}};

/* what the handler of the timer writes: solvers improve r where it lies */
static const char* output;
static double results[4], *impulses;
static size_t impulses_size;
static double limit, started;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void finish(void) {
  int file = open(output, O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file < 0 || write(file, results, sizeof results) != (ssize_t)sizeof results ||
      write(file, impulses, impulses_size) != (ssize_t)impulses_size)
    _exit(1);
  _exit(0);
}

/* Every tenth of a second by the clock: whether the time is over, or impulses are beyond all measure. */
static void look(int number) {
  (void)number;
  size_t k = 0;
  while (k < impulses_size / sizeof(double) && impulses[k] > -1e30 && impulses[k] < 1e30) ++k;
  results[0] = now() - started;
  results[1] = k < impulses_size / sizeof(double) ? -2 : -1;
  if (results[1] == -2 || results[0] > limit) finish();
}

static double* zeros(int count) {
  double* numbers = calloc((size_t)count + 1, sizeof(double));
  if (!numbers) exit(1);
  return numbers;
}

static void look_every(int microseconds) {
  struct itimerval timer = {{0, microseconds}, {0, microseconds}};
  setitimer(ITIMER_REAL, &timer, NULL);
}

/* Gauss-Seidel wants blocks: by compressed columns its rows are slow */
static void to_blocks(FrictionContactProblem* problem) {
  NumericsMatrix* blocks = NM_create(NM_SPARSE_BLOCK, problem->M->size0, problem->M->size1);
  if (SBM_from_csparse(3, NM_csc(problem->M), blocks->matrix1)) exit(1);
  problem->M = blocks;
}

int main(int argc, char** argv) {
  size_t solver = 0, count = sizeof solvers / sizeof *solvers;
  while (argc == 6 && solver < count && strcmp(argv[2], solvers[solver].name)) ++solver;
  if (argc != 6 || solver == count)
    return fprintf(stderr, "usage: siconos_solve problem.dat solver tolerance seconds impulses.bin\n"), 1;
  limit = atof(argv[4]);
  double shortest = 1e300, total = 0;
  output = argv[5];
  signal(SIGALRM, look);
  for (int run = 0; run < 10 && total < 0.1; ++run) {
    /* read again each time: solvers keep what they made of the matrices */
    FrictionContactProblem* local = NULL;
    GlobalFrictionContactProblem* global = NULL;
    if (solvers[solver].is_global) global = globalFrictionContact_new_from_filename(argv[1]);
    else local = frictionContact_new_from_filename(argv[1]);
    if (!local && !global) return fprintf(stderr, "siconos_solve: %s: not read\n", argv[1]), 1;
    int contacts = local ? local->numberOfContacts : global->numberOfContacts;
    if (solvers[solver].id == SICONOS_FRICTION_3D_NSGS) to_blocks(local);
    SolverOptions* options = solver_options_create(solvers[solver].id);
    options->iparam[SICONOS_IPARAM_MAX_ITER] = 1000000000;
    options->dparam[SICONOS_DPARAM_TOL] = atof(argv[3]);
    double *velocities = zeros(3 * contacts), *of_bodies = zeros(global ? global->M->size0 : 0);
    impulses = zeros(3 * contacts);
    impulses_size = sizeof(double) * 3 * (size_t)contacts;
    started = now();
    look_every(100000);
    int info = local ? fc3d_driver(local, impulses, velocities, options)
                     : gfc3d_driver(global, impulses, velocities, of_bodies, options);
    double seconds = now() - started;
    look_every(0);
    total += seconds;
    if (seconds < shortest) shortest = seconds;
    results[0] = shortest;
    results[1] = info;
    results[2] = options->iparam[SICONOS_IPARAM_ITER_DONE];
    results[3] = options->dparam[SICONOS_DPARAM_RESIDU];
  }
  finish();
}
