// Records of balls, and velocities of the solution back to the bodies, four at a time (interface: problem_bodies.f90). Spins of a
// record are in the world's axes, times the radius, those of a body in its own.

#include "bodies_of_four.hpp"

namespace {
enum { orientation = 3, place_length = 7, velocity_length = 6, spins = 2 };    // the last two of places; velocities from `spins` on
const vec none = {};

// Four bodies of a list of n; slots beyond the end repeat the last one.
struct balls {
  int left;
  long of[width];
  vec radius, q[width];

  balls(int first, int n, const int *body_of, const double *radii, const double *middle) : left(n - first) {
    for (int i = 0; i < width; ++i) {
      of[i] = body_of[i < left ? first + i : n - 1] - 1;
      radius[i] = radii[of[i]];
      q[i] = load(middle + place_length * of[i] + orientation);
    }
    transpose(q[0], q[1], q[2], q[3]);
  }
  // Four values of each body, from a place on.
  void fetch(const double *list, int place, vec *v) const {
    for (int i = 0; i < width; ++i) v[i] = load(list + velocity_length * of[i] + place);
    transpose(v[0], v[1], v[2], v[3]);
  }
  // Turn vectors by the orientations, or back where the sign is -1.
  void turn(double sign, vec &x, vec &y, vec &z) const {
    const vec a = sign * q[1], b = sign * q[2], c = sign * q[3];
    const vec tx = 2.0 * (b * z - c * y), ty = 2.0 * (c * x - a * z), tz = 2.0 * (a * y - b * x);
    x = x + q[0] * tx + b * tz - c * ty, y = y + q[0] * ty + c * tx - a * tz, z = z + q[0] * tz + a * ty - b * tx;
  }
};
}    // namespace

extern "C" void sg_load_balls(int n, const int *body_of, const double *radius, const double *middle, const double *free_velocity,
                             const double *inverse_mass, double *body) {
  for (int first = 0; first < n; first += width) {
    const balls own(first, n, body_of, radius, middle);
    vec v[width], w[width], m[width];
    own.fetch(free_velocity, spins, w);
    own.fetch(free_velocity, 0, v);
    own.fetch(inverse_mass, 0, m);
    own.turn(1, w[1], w[2], w[3]);
    const mask is_round = own.radius > none;
    for (int i = 1; i < width; ++i) w[i] = is_round ? own.radius * w[i] : none;
    const vec most = larger(m[0], larger(m[1], m[2])), fewest = smaller(m[0], smaller(m[1], m[2]));
    // Driven along some axes only: marks of the free ones in place of the inverse inertia.
    const vec marks = (m[0] > none ? none - 1.0 : none) + (m[1] > none ? none - 2.0 : none) + (m[2] > none ? none - 4.0 : none);
    vec one[width] = {v[0], v[1], v[2], w[1]};
    vec other[width] = {w[2], w[3], most, ((most > none) & ~(fewest > none)) ? marks : own.radius * own.radius * m[3]};
    transpose(one[0], one[1], one[2], one[3]);
    transpose(other[0], other[1], other[2], other[3]);
    for (int i = 0; i < width && i < own.left; ++i) {
      double *const to = body + static_cast<long>(space_bodies::length) * (first + i);
      store(one[i], to);
      store(other[i], to + space_bodies::second_half);
    }
  }
}

extern "C" void sg_unload_balls(int n, const int *body_of, const double *radius, const double *middle, const double *body,
                               double *free_velocity) {
  for (int first = 0; first < n; first += width) {
    const balls own(first, n, body_of, radius, middle);
    int slot[width];
    for (int i = 0; i < width; ++i) slot[i] = (i < own.left ? first + i : n - 1) + 1;
    space_bodies c;
    c.fetch(slot, body);
    own.turn(-1, c.sx, c.sy, c.sz);
    const vec divisors = divisor(own.radius);
    vec row[width] = {c.z, c.sx / divisors, c.sy / divisors, c.sz / divisors};
    transpose(row[0], row[1], row[2], row[3]);
    for (int i = 0; i < width && i < own.left; ++i) {
      double *const to = free_velocity + velocity_length * own.of[i];
      to[0] = c.x[i], to[1] = c.y[i], to[2] = c.z[i];
      if (own.radius[i] > 0) store(row[i], to + spins);
    }
  }
}
