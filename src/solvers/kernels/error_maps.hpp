// Sums that the errors of a solution are made of, over contacts four at a time (error_lanes.cpp, error_records.cpp). The maps are
// those of natural_map.f90 and law_violation.f90: each quantity is computed once for all of them.
#pragma once

#include <limits>

#include "lanes.hpp"

namespace {
constexpr double huge = std::numeric_limits<double>::max(), least = std::numeric_limits<double>::min();
constexpr double margin = 1e-6, least_share = 1e-21;    // of law_violation.f90
enum { round, arm, ball, plain_round, solid };         // kinds of contacts

const vec none = {}, one = none + 1.0;

inline vec size_of(const vec &v) { return v < none ? -v : v; }
inline vec with_sign(const vec &size, const vec &of) { return of < none ? -size : size; }

// Nearest point of Coulomb's cone; the fifth argument is 1/(1 + mu^2).
inline void project(const vec &x, const vec &t, const vec &mu, const vec &per_cone, vec &normal, vec &tangential) {
  const vec size = size_of(t), height = larger((x + mu * size) * per_cone, none);
  normal = ((x > none) & (size <= mu * x)) ? x : height;
  tangential = with_sign(smaller(mu * height, size), t);
}

// Sums over contacts, side by side, and the largest bound of the chunk.
struct totals {
  vec sum[6] = {}, worst = {};

  // Of contacts in use: squares of the maps with rho = 1 and rho, of impulse and velocity, and a bound of the broken law.
  void add(const mask &in_use, bool with_e1, const vec &one_square, const vec &square, const vec &r2, const vec &u2,
           const vec &broken2, const vec &rho, const vec &per_mass, const mask &carries, const vec &u_n, double *closing) {
    const mask takes_part = rho > none;
    if (with_e1) {
      const vec raised = takes_part ? broken2 * (1 + margin) + least_share * (u2 + r2 * per_mass * per_mass) : none;
      const vec bound = in_use ? raised : none;
      worst = larger(bound, worst);
      worst = bound <= none + huge ? worst : none + huge;
      sum[0] += in_use ? one_square : none;
    }
    sum[1] += in_use ? square : none;
    sum[2] += in_use ? square * per_mass * per_mass : none;
    sum[3] += in_use ? r2 : none;
    sum[4] += in_use ? u2 : none;
    sum[5] += (in_use & carries) ? one : none;
    store(in_use ? (takes_part ? (carries ? none - huge : u_n) : none + huge) : none - huge, closing);
  }
};

// Contacts of the plane.
inline void judge_plane(const mask &in_use, bool with_e1, const vec &u_n, const vec &u_t, const vec &r_n, const vec &r_t,
                        const vec &mu, const vec &rho, totals &to, double *closing) {
  const vec slip = mu * size_of(u_t), per_cone = 1.0 / (1.0 + mu * mu), per_mass = rho > none ? 1.0 / divisor(rho) : none;
  const vec tried = r_t - rho * u_t;
  vec f_n, f_t, one_square = {}, broken2 = {};
  if (with_e1) {
    const vec unit = rho > none ? one : none;
    project(r_n - unit * (u_n + slip), r_t - unit * u_t, mu, per_cone, f_n, f_t);
    one_square = (r_n - f_n) * (r_n - f_n) + (r_t - f_t) * (r_t - f_t);
    const vec broken_n = smaller(u_n, r_n * per_mass);
    const vec broken_t = (r_t - with_sign(smaller(size_of(tried), mu * larger(r_n, none)), tried)) * per_mass;
    broken2 = broken_n * broken_n + broken_t * broken_t;
  }
  project(r_n - rho * (u_n + slip), tried, mu, per_cone, f_n, f_t);
  const vec square = (r_n - f_n) * (r_n - f_n) + (r_t - f_t) * (r_t - f_t);
  to.add(in_use, with_e1, one_square, square, r_n * r_n + r_t * r_t, u_n * u_n + u_t * u_t, broken2, rho, per_mass,
         size_of(r_n) + size_of(r_t) > none, u_n, closing);
}

// Four contacts of disks: plain records, or those of sg_records. `at` gives the values of their records, side by side.
template <bool are_plain, class values>
inline void judge_round(const mask &in_use, bool with_e1, const values &at, double shared_friction, double ratio,
                        const plane_bodies &c, const plane_bodies &a, const vec &r_n, const vec &r_t, totals &to, double *closing) {
  using namespace disk_lane;
  const vec x = at(normal_x), y = at(normal_y), dx = c.x - a.x, dy = c.y - a.y, slip = y * dx - x * dy + c.turn + a.turn;
  const vec per_n = at(are_plain ? int{plain_inverse_wnn} : int{inverse_wnn});
  const vec per_t = are_plain ? ratio * per_n : at(inverse_wtt), mu = are_plain ? none + shared_friction : at(friction);
  judge_plane(in_use, with_e1, x * dx + y * dy + at(bias_n), are_plain ? slip : slip + at(bias_t), r_n, r_t, mu,
              mu > none ? smaller(per_n, per_t) : per_n, to, closing);
}

// Four contacts with arms; which of them take part.
template <class values>
inline void judge_arm(const mask &in_use, bool with_e1, const values &at, const mask &takes_part, const plane_bodies &c,
                      const plane_bodies &a, const vec &r_n, const vec &r_t, totals &to, double *closing) {
  using namespace arm_lane;
  const vec x = at(normal_x), y = at(normal_y), dx = c.x - a.x, dy = c.y - a.y;
  const vec nn = at(w_nn), nt = at(w_nt), tt = at(w_tt);
  const vec half = 0.5 * (nn - tt), largest = 0.5 * (nn + tt) + root(half * half + nt * nt);
  judge_plane(in_use, with_e1, x * dx + y * dy + at(moment_nc) * c.turn - at(moment_na) * a.turn + at(bias_n),
              y * dx - x * dy + at(moment_tc) * c.turn - at(moment_ta) * a.turn + at(bias_t), r_n, r_t, larger(at(friction), none),
              takes_part ? 1.0 / larger(largest, none + least) : none, to, closing);
}

// Squares of the map in space: normal parts x and r_n of the point and of the impulse, and their parts across.
inline vec space_square(const vec &x, const vec &r_n, const vec &mu, const vec &per_cone, const vec (&s)[3], const vec (&t)[3]) {
  const vec length = root(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
  vec height, share;
  project(x, length, mu, per_cone, height, share);
  share /= larger(length, none + least);
  const vec d = r_n - height, dx = t[0] - share * s[0], dy = t[1] - share * s[1], dz = t[2] - share * s[2];
  return d * d + dx * dx + dy * dy + dz * dz;
}

// Four contacts in space: their normals, relative velocities and impulses.
__attribute__((always_inline)) inline void judge_space(const mask &in_use, bool with_e1, const vec &x, const vec &y, const vec &z,
                                                       const vec &ux, const vec &uy, const vec &uz, const vec &rx, const vec &ry,
                                                       const vec &rz, const vec &mu, const vec &rho, totals &to, double *closing) {
  const vec unit = rho > none ? one : none, per_mass = rho > none ? 1.0 / divisor(rho) : none;
  const vec u_n = x * ux + y * uy + z * uz, r_n = x * rx + y * ry + z * rz;
  const vec v[3] = {ux - u_n * x, uy - u_n * y, uz - u_n * z}, t[3] = {rx - r_n * x, ry - r_n * y, rz - r_n * z};
  const vec s[3] = {t[0] - rho * v[0], t[1] - rho * v[1], t[2] - rho * v[2]};
  const vec per_cone = 1.0 / (1.0 + mu * mu), slip = mu * root(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  vec one_square = {}, broken2 = {};
  if (with_e1) {
    const vec s1[3] = {t[0] - unit * v[0], t[1] - unit * v[1], t[2] - unit * v[2]};
    one_square = space_square(r_n - unit * (u_n + slip), r_n, mu, per_cone, s1, t);
    const vec radius = mu * larger(r_n, none);
    const vec share = radius / larger(larger(radius, root(s[0] * s[0] + s[1] * s[1] + s[2] * s[2])), none + least);
    const vec b = smaller(u_n, r_n * per_mass), bx = t[0] - share * s[0], by = t[1] - share * s[1], bz = t[2] - share * s[2];
    broken2 = b * b + (bx * bx + by * by + bz * bz) * per_mass * per_mass;
  }
  to.add(in_use, with_e1, one_square, space_square(r_n - rho * (u_n + slip), r_n, mu, per_cone, s, t), rx * rx + ry * ry + rz * rz,
         ux * ux + uy * uy + uz * uz, broken2, rho, per_mass, size_of(rx) + size_of(ry) + size_of(rz) > none, u_n, closing);
}

// Four contacts of balls.
template <class values>
inline void judge_ball(const mask &in_use, bool with_e1, const values &at, const space_bodies &c, const space_bodies &a,
                       const vec &rx, const vec &ry, const vec &rz, totals &to, double *closing) {
  using namespace ball_lane;
  const vec x = at(normal_x), y = at(normal_y), z = at(normal_z), mu = at(friction), per_n = at(inverse_wnn);
  const vec wx = c.sx + a.sx, wy = c.sy + a.sy, wz = c.sz + a.sz;
  judge_space(in_use, with_e1, x, y, z, c.x - a.x + at(bias_x) - wy * z + wz * y, c.y - a.y + at(bias_y) - wz * x + wx * z,
              c.z - a.z + at(bias_z) - wx * y + wy * x, rx, ry, rz, mu, mu > none ? smaller(per_n, at(inverse_wtt)) : per_n, to,
              closing);
}
}    // namespace
