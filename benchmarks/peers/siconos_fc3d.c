/* SPDX-License-Identifier: GPL-3.0-or-later
 * A throw-away rival: nonsmooth Gauss-Seidel of Siconos (Debian 4.4.0) on a contact problem in space that
 * granular_speed.py --space --siconos writes.
 * gcc -O2 -I/usr/include/siconos -I/usr/include/siconos/numerics siconos_fc3d.c -o siconos_fc3d -lsiconos_numerics -lsiconos_externals -lm
 * usage: siconos_fc3d problem.bin iterations
 * file: int64 contacts, blocks; double friction; int64 first[contacts + 1], column[blocks];
 *       double block[blocks][9], column by column; double q[3 contacts] */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include "SiconosNumerics.h"
#include "NonSmoothDrivers.h"
#include "FrictionContactProblem.h"
#include "SolverOptions.h"
#include "NumericsMatrix.h"
#include "SparseBlockMatrix.h"
#include "Friction_cst.h"

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void* get(size_t size, size_t count, FILE* file) {
  void* data = malloc(size * count);
  if (!data || fread(data, size, count, file) != count) {
    perror("siconos_fc3d");
    exit(1);
  }
  return data;
}

static void solve(FrictionContactProblem* problem, int iterations, double* r, double* u) {
  SolverOptions* options = solver_options_create(SICONOS_FRICTION_3D_NSGS);
  options->iparam[SICONOS_IPARAM_MAX_ITER] = iterations;
  options->dparam[SICONOS_DPARAM_TOL] = 1e-300;
  options->iparam[SICONOS_FRICTION_3D_IPARAM_ERROR_EVALUATION] = SICONOS_FRICTION_3D_NSGS_ERROR_EVALUATION_LIGHT;
  solver_options_update_internal(options, 0, SICONOS_FRICTION_3D_ONECONTACT_NSN);
  memset(r, 0, sizeof(double) * 3 * (size_t)problem->numberOfContacts);
  memset(u, 0, sizeof(double) * 3 * (size_t)problem->numberOfContacts);
  fc3d_driver(problem, r, u, options);
  if (options->iparam[SICONOS_IPARAM_ITER_DONE] != iterations) {
    fprintf(stderr, "siconos_fc3d: it ended early\n");
    exit(1);
  }
  solver_options_delete(options);
}

int main(int argc, char** argv) {
  if (argc != 3) return fprintf(stderr, "usage: siconos_fc3d problem.bin iterations\n"), 1;
  FILE* file = fopen(argv[1], "rb");
  if (!file) return perror(argv[1]), 1;
  long long* counts = get(8, 2, file);
  size_t contacts = (size_t)counts[0], blocks = (size_t)counts[1];
  double* friction = get(8, 1, file);
  size_t *first = get(8, contacts + 1, file), *column = get(8, blocks, file);
  double *values = get(8, 9 * blocks, file), *q = get(8, 3 * contacts, file);
  fclose(file);

  double** block = malloc(sizeof(double*) * blocks);
  for (size_t k = 0; k < blocks; ++k) block[k] = values + 9 * k;
  unsigned *ends = malloc(sizeof(unsigned) * contacts), *diagonal = malloc(sizeof(unsigned) * contacts);
  double* mu = malloc(8 * contacts);
  for (size_t c = 0; c < contacts; ++c) {
    ends[c] = (unsigned)(3 * (c + 1));
    mu[c] = *friction;
    for (size_t k = first[c]; k < first[c + 1]; ++k)
      if (column[k] == c) diagonal[c] = (unsigned)k;
  }
  int n = (int)(3 * contacts);
  NumericsMatrix* m = NM_create(NM_SPARSE_BLOCK, n, n);
  SparseBlockStructuredMatrix* s = m->matrix1;
  s->nbblocks = (unsigned)blocks;
  s->block = block;
  s->blocknumber0 = s->blocknumber1 = (unsigned)contacts;
  s->blocksize0 = s->blocksize1 = ends;
  s->filled1 = contacts + 1;
  s->filled2 = blocks;
  s->index1_data = first;
  s->index2_data = column;
  s->diagonal_blocks = diagonal;
  FrictionContactProblem problem;
  memset(&problem, 0, sizeof problem);
  problem.dimension = 3;
  problem.numberOfContacts = (int)contacts;
  problem.M = m;
  problem.q = q;
  problem.mu = mu;

  /* what a solution needs besides its iterations is in both */
  double *r = malloc(8 * (size_t)n), *u = malloc(8 * (size_t)n);
  int few = 2, many = atoi(argv[2]);
  double start = now();
  solve(&problem, few, r, u);
  double middle = now();
  solve(&problem, many, r, u);
  double seconds = (now() - middle) - (middle - start), squares = 0;
  for (int k = 0; k < n; ++k) squares += r[k] * r[k];
  printf("ns=%.1f impulses=%.17g\n", 1e9 * seconds / (many - few) / (double)contacts, sqrt(squares));
  return 0;
}
