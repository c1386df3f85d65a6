/* Convex hull of points in space by Qhull: what convex_hull_with_qhull.f90 calls.
 *
 * Qhull keeps its state in a structure of thousands of bytes whose members a caller must read, and jumps over its
 * callers on errors; both are best left to C. */
#include <stdint.h>
#include <stdlib.h>

#include "libqhull_r/qhull_ra.h"

/* What is called of Qhull, which is opened when the first hull is made: in the order of `names` in convex_hull_with_qhull.f90. */
struct qhull {
  void (*zero)(qhT *, FILE *);
  int (*new_qhull)(qhT *, int, int, coordT *, boolT, char *, FILE *, FILE *);
  void (*freeqhull)(qhT *, boolT);
  void (*memfreeshort)(qhT *, int *, int *);
  int (*setsize)(qhT *, setT *);
  setT *(*facet3vertex)(qhT *, facetT *);
  int (*pointid)(qhT *, pointT *);
  void (*settempfree)(qhT *, setT **);
};

/* Number the corners of all faces; 0, or -1 where there is no room. */
static int copy_faces(const struct qhull *qhull, qhT *qh, int *n_faces, int32_t **first, int32_t **corner) {
  facetT *facet;
  vertexT *vertex, **vertexp;
  setT *around;
  size_t room = 0, k = 0;
  int f = 0;

  /* A face that Qhull has merged has as many corners as ridges. */
  FORALLfacets { room += (size_t)qhull->setsize(qh, facet->simplicial ? facet->vertices : facet->ridges); }
  *first = malloc((size_t)(qh->num_facets + 1) * sizeof **first);
  *corner = malloc((room + 1) * sizeof **corner);
  if (!*first || !*corner) return -1;
  FORALLfacets {
    (*first)[f++] = (int32_t)k + 1;
    around = qhull->facet3vertex(qh, facet);
    FOREACHvertex_(around) {
      if (k < room) (*corner)[k++] = qhull->pointid(qh, vertex->point) + 1;
    }
    qhull->settempfree(qh, &around);
  }
  (*first)[f] = (int32_t)k + 1;
  *n_faces = f;
  return 0;
}

/* Faces of the hull of n points, three reals each: corners of face f are corner[first[f]] to corner[first[f + 1] - 1],
 * point numbers from 1, in order around the face. Returns Qhull's exit code, 0 when all went well; the arrays are to be
 * given back by splitgrain_hull_free. */
int splitgrain_hull(const struct qhull *qhull, int n, const double *points, int *n_faces, int32_t **first, int32_t **corner) {
  qhT state;
  qhT *qh = &state;
  char command[] = "qhull";
  FILE *silent = fopen("/dev/null", "w");
  int code, short_memory, total_memory;

  *n_faces = 0;
  *first = NULL;
  *corner = NULL;
  qhull->zero(qh, silent);
  code = qhull->new_qhull(qh, 3, n, (coordT *)points, False, command, NULL, silent);
  if (code == 0) {
    /* Qhull comes back here when it fails on the way through its faces. */
    code = setjmp(qh->errexit);
    if (code == 0) {
      qh->NOerrexit = False;
      code = copy_faces(qhull, qh, n_faces, first, corner);
    }
    qh->NOerrexit = True;
  }
  qhull->freeqhull(qh, !qh_ALL);
  qhull->memfreeshort(qh, &short_memory, &total_memory);
  if (silent) fclose(silent);
  return code;
}

/* Give back the arrays of splitgrain_hull. */
void splitgrain_hull_free(int32_t *first, int32_t *corner) {
  free(first);
  free(corner);
}
