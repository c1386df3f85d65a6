// Records of contacts whose laws look at gaps alone, and their relative velocities without impulses, four contacts at a time
// (interface: assemble_by_gaps.f90; the formulas are those of delassus.f90). A contact beyond the end repeats the last one.

#include <cstdint>
#include <limits>

#include "bodies_of_four.hpp"

namespace {
const vec none = {}, one = none + 1.0;
typedef double two __attribute__((vector_size(16), aligned(8)));

inline two load_two(const double *from) { return *reinterpret_cast<const two *>(from); }

// Four pairs of numbers become two vectors.
inline void split(const double *const (&from)[width], vec &x, vec &y) {
  const two a = load_two(from[0]), b = load_two(from[1]), c = load_two(from[2]), d = load_two(from[3]);
  const vec low = __builtin_shufflevector(a, c, 0, 1, 2, 3), high = __builtin_shufflevector(b, d, 0, 1, 2, 3);
  x = __builtin_shufflevector(low, high, 0, 4, 2, 6);
  y = __builtin_shufflevector(low, high, 1, 5, 3, 7);
}

// Inverse of a diagonal term of W; zero where nothing can move.
inline vec inverse_of(const vec &w) {
  const mask moves = w > none + std::numeric_limits<double>::min();
  return moves ? 1.0 / (moves ? w : one) : none;
}

// Four contacts of a list of n.
struct contacts {
  int first, left, index[width], slot[2][width];

  contacts(int begin, int n, const int *pair) : first(begin), left(n - begin) {
    for (int i = 0; i < width; ++i) {
      index[i] = first + (i < left ? i : left - 1);
      for (int side = 0; side < 2; ++side) slot[side][i] = pair[2 * index[i] + side];
    }
  }
  vec values(const double *of) const {
    if (left >= width) return load(of + first);
    return vec{of[index[0]], of[index[1]], of[index[2]], of[index[3]]};
  }
  void pairs(const double *of, vec &x, vec &y) const {
    const double *const from[width] = {of + 2 * index[0], of + 2 * index[1], of + 2 * index[2], of + 2 * index[3]};
    split(from, x, y);
  }
  // Ask for records before their turn: they come from the third cache even if they are only written.
  template <int length>
  void ask(const double *records) const {
    constexpr int ahead = 6;    // times four contacts
    for (int i = 0; i < width * length; i += 8)
      __builtin_prefetch(records + static_cast<long>(length) * (first + ahead * width) + i, 1);
  }
  // Write four values of each record from a place on.
  template <int length>
  void put(vec a, vec b, vec c, vec d, int place, double *records) const {
    transpose(a, b, c, d);
    const vec rows[width] = {a, b, c, d};
    for (int i = 0; i < width && i < left; ++i) store(rows[i], records + static_cast<long>(length) * (first + i) + place);
  }
  void put_velocities(const vec &u, const vec &v, const vec &w, const vec &parting, double *velocity, double *opening) const {
    for (int i = 0; i < width && i < left; ++i) {
      double *const to = velocity + 3 * (first + i);
      to[0] = u[i], to[1] = v[i], to[2] = w[i];
      opening[first + i] = parting[i];
    }
  }
};
}    // namespace

// Disks: normal, two biases, inverses of W_nn and W_tt, friction.
extern "C" void sg_put_disk_records(int n, const int *pair, const double *normal, const double *bias, const double *friction,
                                   const double *body, double *record, double *velocity, double *opening) {
  enum { bias_t = 3, length = 7 };
  for (int first = 0; first < n; first += width) {
    const contacts own(first, n, pair);
    own.ask<length>(record);
    vec x, y;
    own.pairs(normal, x, y);
    const vec b = own.values(bias), mu = own.values(friction);
    plane_bodies c, a;
    c.fetch(own.slot[0], body), a.fetch(own.slot[1], body);
    const vec mx = c.per_mx + a.per_mx, my = c.per_my + a.per_my, cross = x * y * (mx - my), w_nt = cross < none ? -cross : cross;
    const vec w_n = x * x * mx + y * y * my + w_nt, w_t = y * y * mx + x * x * my + c.per_i + a.per_i + w_nt;
    own.put<length>(x, y, b, none, 0, record);
    own.put<length>(none, inverse_of(w_n), inverse_of(w_t), mu, bias_t, record);
    const vec dx = c.x - a.x, dy = c.y - a.y, u = x * dx + y * dy + b;
    own.put_velocities(u, y * dx - x * dy + (c.turn + a.turn), none, u, velocity, opening);
  }
}

// Contacts with lever arms in the plane, from their points and the middles of their bodies.
extern "C" void sg_put_arm_records(int n, int n_middle, const int *pair, const int *body_of, const double *normal,
                                  const double *point, const double *gap, const std::int8_t *image, const double *middle,
                                  double period, const double *bias, const double *friction, const double *body, double *record,
                                  double *velocity, double *opening) {
  enum { length = 16 };
  for (int first = 0; first < n; first += width) {
    const contacts own(first, n, pair);
    own.ask<length>(record);
    const double *centre[2][width];
    vec x, y, px, py, cx, cy, ax, ay, shift;
    for (int i = 0; i < width; ++i) {
      for (int side = 0; side < 2; ++side)
        centre[side][i] = middle + static_cast<long>(n_middle) * (body_of[2 * own.index[i] + side] - 1);
      shift[i] = period * image[own.index[i]];
    }
    own.pairs(normal, x, y);
    own.pairs(point, px, py);
    split(centre[0], cx, cy);
    split(centre[1], ax, ay);
    const vec half = 0.5 * own.values(gap), b = own.values(bias), mu = own.values(friction);
    cx = px + half * x - cx, cy = py + half * y - cy;
    ax = px - half * x - ax - shift, ay = py - half * y - ay;
    const vec nc = cx * y - cy * x, tc = -cy * y - cx * x, na = ax * y - ay * x, ta = -ay * y - ax * x;
    plane_bodies c, a;
    c.fetch(own.slot[0], body), a.fetch(own.slot[1], body);
    const vec mx = c.per_mx + a.per_mx, my = c.per_my + a.per_my;
    const vec w_nn = x * x * mx + y * y * my + nc * nc * c.per_i + na * na * a.per_i;
    const vec w_nt = x * y * (mx - my) + nc * tc * c.per_i + na * ta * a.per_i;
    const vec w_tt = y * y * mx + x * x * my + tc * tc * c.per_i + ta * ta * a.per_i;
    own.put<length>(x, y, nc, tc, 0, record);
    own.put<length>(na, ta, b, none, 4, record);
    own.put<length>(w_nn, w_nt, w_tt, mu, 8, record);
    own.put<length>(none, none, none, w_nn > none + std::numeric_limits<double>::min() ? one : none, 12, record);
    const vec dx = c.x - a.x, dy = c.y - a.y, u = x * dx + y * dy + nc * c.turn - na * a.turn + b;
    own.put_velocities(u, y * dx - x * dy + tc * c.turn - ta * a.turn, none, u, velocity, opening);
  }
}

// Balls: normal, bias as a vector, inverses of W_nn and W_tt, friction.
extern "C" void sg_put_ball_records(int n, const int *pair, const double *normal, const double *bias, const double *friction,
                                   const double *body, double *record, double *velocity, double *opening) {
  enum { middle = 4, friction_place = 8, length };
  for (int first = 0; first < n; first += width) {
    const contacts own(first, n, pair);
    own.ask<length>(record);
    vec x, y, z;
    for (int i = 0; i < width; ++i) {
      const double *const from = normal + 3 * own.index[i];
      x[i] = from[0], y[i] = from[1], z[i] = from[2];
    }
    const vec b = own.values(bias), bx = b * x, by = b * y, bz = b * z;
    space_bodies c, a;
    c.fetch(own.slot[0], body), a.fetch(own.slot[1], body);
    const vec w = c.per_m + a.per_m, turn_c = c.per_i > none ? c.per_i : none, turn_a = a.per_i > none ? a.per_i : none;
    own.put<length>(x, y, z, bx, 0, record);
    own.put<length>(by, bz, inverse_of(w), inverse_of(w + turn_c + turn_a), middle, record);
    for (int i = 0; i < width && i < own.left; ++i)
      record[static_cast<long>(length) * (first + i) + friction_place] = friction[first + i];
    const vec sx = c.sx + a.sx, sy = c.sy + a.sy, sz = c.sz + a.sz;
    const vec u = c.x - a.x - sy * z + sz * y + bx, v = c.y - a.y - sz * x + sx * z + by, t = c.z - a.z - sx * y + sy * x + bz;
    own.put_velocities(u, v, t, x * u + y * v + z * t, velocity, opening);
  }
}
