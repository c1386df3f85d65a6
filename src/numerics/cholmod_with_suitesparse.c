/* Cholesky factors by CHOLMOD, of SuiteSparse: what cholmod_with_suitesparse.f90 calls.
 *
 * CHOLMOD keeps settings and factors in structures whose members a caller must read and set; that is best left to C. */
#include <stdlib.h>
#include <string.h>

#include "cholmod.h"

/* Procedures of CHOLMOD, which is opened for the first factors: in the order of `names` in cholmod_with_suitesparse.f90. */
struct cholmod {
  int (*start)(cholmod_common *);
  int (*finish)(cholmod_common *);
  cholmod_factor *(*analyze)(cholmod_sparse *, cholmod_common *);
  int (*factorize)(cholmod_sparse *, cholmod_factor *, cholmod_common *);
  int (*solve2)(int, cholmod_factor *, cholmod_dense *, cholmod_sparse *, cholmod_dense **, cholmod_sparse **,
                cholmod_dense **, cholmod_dense **, cholmod_common *);
  int (*free_factor)(cholmod_factor **, cholmod_common *);
  int (*free_dense)(cholmod_dense **, cholmod_common *);
  /* OpenMP's nested regions that run in parallel; both null in a CHOLMOD without OpenMP. */
  int (*levels)(void);
  void (*set_levels)(int);
};

/* Factors of one matrix, with the memory of their solutions. */
struct factors {
  struct cholmod call;
  cholmod_common common;
  cholmod_factor *l;
  cholmod_dense *x, *y, *e;
};

/* Answers: done, not positive definite, out of memory, anything else. */
enum { done = 0, not_definite = 1, no_memory = 2, failed = 3 };

static int answer(const cholmod_common *common) {
  if (common->status == CHOLMOD_OK) return done;
  if (common->status == CHOLMOD_NOT_POSDEF) return not_definite;
  return common->status == CHOLMOD_OUT_OF_MEMORY || common->status == CHOLMOD_TOO_LARGE ? no_memory : failed;
}

/* A view of a matrix in compressed rows, counted from 0: the lower triangle by rows is the upper one by columns. */
static cholmod_sparse view(int n, int *first, int *column, double *value) {
  cholmod_sparse a;

  memset(&a, 0, sizeof a);
  a.nrow = a.ncol = (size_t)n;
  a.nzmax = (size_t)first[n];
  a.p = first;
  a.i = column;
  a.x = value;
  a.stype = 1;
  a.itype = CHOLMOD_INT;
  a.xtype = value ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = a.packed = 1;
  return a;
}

/* Give back what belongs to one matrix. */
void splitgrain_cholmod_free(struct factors *self) {
  if (!self) return;
  self->call.free_factor(&self->l, &self->common);
  self->call.free_dense(&self->x, &self->common);
  self->call.free_dense(&self->y, &self->common);
  self->call.free_dense(&self->e, &self->common);
  self->call.finish(&self->common);
  free(self);
}

/* Analyse a pattern; gives its factors, without values, their entries, and the floating-point operations that they take. */
int splitgrain_cholmod_analyse(const struct cholmod *call, int n, int *first, int *column, struct factors **made, double *entries,
                               double *flops) {
  struct factors *self = calloc(1, sizeof *self);
  cholmod_sparse a = view(n, first, column, NULL);
  int status = no_memory;

  *made = NULL;
  if (!self) return status;
  self->call = *call;
  self->call.start(&self->common);
  self->common.print = 0;
  /* L L^T in any case: L D L^T would take indefinite matrices. */
  self->common.final_ll = 1;
  self->common.quick_return_if_not_posdef = 1;
  self->l = self->call.analyze(&a, &self->common);
  status = answer(&self->common);
  if (self->l && status == done) {
    *entries = self->common.lnz;
    *flops = self->common.fl;
    *made = self;
    return done;
  }
  splitgrain_cholmod_free(self);
  return status == done ? failed : status;
}

/* Factorise; where the matrix is not positive definite, `lost` is the column, from 1, at which that shows. */
int splitgrain_cholmod_factorise(struct factors *self, int n, int *first, int *column, double *value, int *lost) {
  cholmod_sparse a = view(n, first, column, value);
  int is_done, status, levels = 0;

  *lost = 0;
  /* CHOLMOD asks for four threads wherever it can, whose waiting costs more than they gain: no region is parallel here. */
  if (self->call.levels) {
    levels = self->call.levels();
    self->call.set_levels(0);
  }
  is_done = self->call.factorize(&a, self->l, &self->common);
  if (self->call.levels) self->call.set_levels(levels);
  status = answer(&self->common);
  if (status == done && is_done && self->l->minor == self->l->n) return done;
  if (status != no_memory && self->l->minor < self->l->n) {
    *lost = 1 + ((int *)self->l->Perm)[self->l->minor];
    return not_definite;
  }
  return status == done ? failed : status;
}

/* Solve for k right-hand sides of n entries each. */
int splitgrain_cholmod_solve(struct factors *self, int n, int k, double *b, double *x) {
  cholmod_dense right;

  memset(&right, 0, sizeof right);
  right.nrow = right.d = (size_t)n;
  right.ncol = (size_t)k;
  right.nzmax = (size_t)n * (size_t)k;
  right.x = b;
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  if (!self->call.solve2(CHOLMOD_A, self->l, &right, NULL, &self->x, NULL, &self->y, &self->e, &self->common)) return failed;
  memcpy(x, self->x->x, right.nzmax * sizeof(double));
  return done;
}
