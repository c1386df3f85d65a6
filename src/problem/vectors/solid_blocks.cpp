// Blocks of W of contacts between solids with friction, whose laws look at gaps alone, and their relative velocities, four contacts
// at a time (interface: assemble_by_gaps.f90). The formulas are those of delassus.f90 and of largest_eigenvalue in symmetric.f90.

#include <limits>

#include "vectors_of_four.hpp"

namespace {
constexpr double epsilon = std::numeric_limits<double>::epsilon(), tiny = std::numeric_limits<double>::min();
// Places of sg_records, from zero.
namespace record {
enum { normal_z = 2, tangent, arm_c = 6, arm_a = 9, bias = 12, wnn = 15, s2 = 19, compliance_n = 22, law = 24, length = 26 };
}
namespace body {
enum { length = 16 };
}
const vec none = {}, one = none + 1.0;

struct three {
  vec x, y, z;
};
// Upper triangle of a symmetric matrix.
struct matrix {
  vec xx, yy, zz, xy, xz, yz;
};

inline vec dot(const three &a, const three &b) { return a.x * b.x + (a.y * b.y + a.z * b.z); }
inline three cross(const three &a, const three &b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline three times(const matrix &m, const three &v) {
  return {m.xx * v.x + (m.xy * v.y + m.xz * v.z), m.xy * v.x + (m.yy * v.y + m.yz * v.z), m.xz * v.x + (m.yz * v.y + m.zz * v.z)};
}

// Four solids side by side. Slots count from one.
struct solids {
  three velocity, spin, inverse_mass;
  matrix inverse;    // of the inertia

  solids(const int *slot, const double *records) {
    vec v[body::length];
    for (int place = 0; place < body::length; place += width) {
      for (int i = 0; i < width; ++i) v[place + i] = load(records + static_cast<long>(body::length) * (slot[i] - 1) + place);
      transpose(v[place], v[place + 1], v[place + 2], v[place + 3]);
    }
    velocity = {v[0], v[1], v[2]}, spin = {v[3], v[4], v[5]}, inverse_mass = {v[6], v[7], v[8]};
    inverse = {v[9], v[10], v[11], v[12], v[13], v[14]};
  }

  // What one body adds to W in the world's axes: its inverse mass, and that of its inertia at a lever arm.
  void add(const three &arm, matrix &w) const {
    const three x = cross({inverse.xx, inverse.xy, inverse.xz}, arm), y = cross({inverse.xy, inverse.yy, inverse.yz}, arm),
                z = cross({inverse.xz, inverse.yz, inverse.zz}, arm);
    w.xx += inverse_mass.x + (arm.z * y.x - arm.y * z.x);
    w.yy += inverse_mass.y + (arm.x * z.y - arm.z * x.y);
    w.zz += inverse_mass.z + (arm.y * x.z - arm.x * y.z);
    w.xy += arm.z * y.y - arm.y * z.y;
    w.xz += arm.z * y.z - arm.y * z.z;
    w.yz += arm.x * z.z - arm.z * x.z;
  }
};

// Cosine and sine of half the angle of a vector, from -90 to 90 degrees.
inline void find_axis(const vec &x, const vec &y, vec &c, vec &s) {
  const vec length = root(x * x + y * y), size_x = x < none ? -x : x, size_y = y < none ? -y : y, along = size_x + length;
  const mask is_there = length > none;
  const vec share = 1.0 / root(is_there ? 2.0 * length * along : one), large = share * along, small = share * size_y;
  c = is_there ? (x < none ? small : large) : one;
  s = is_there ? (x < none ? large : small) : none;
  s = y < none ? -s : s;
}

// Largest eigenvalue.
inline vec largest_of(const matrix &w) {
  const vec mean = (w.xx + w.yy + w.zz) / 3.0;
  vec x = w.xx - mean, y = w.yy - mean, z = w.zz - mean, xy = w.xy, xz = w.xz, yz = w.yz;
  const vec p = root((x * x + y * y + z * z + 2.0 * (xy * xy + xz * xz + yz * yz)) / 6.0);
  const mask is_spread = p > epsilon * (mean < none ? -mean : mean);
  const vec per_p = 1.0 / (is_spread ? p : one);
  x *= per_p, y *= per_p, z *= per_p, xy *= per_p, xz *= per_p, yz *= per_p;
  const vec turn = 2.0 + (x * (y * z - yz * yz) - xy * (xy * z - yz * xz) + xz * (xy * yz - y * xz));
  const vec t = root(larger(smaller(turn / 4.0, one), none + epsilon * epsilon / 16));
  z = t * (1.154686 + t * (-0.2214748 + t * (0.1004688 + t * (-0.04453444 + t * 0.01086309))));
  const vec value = z * z * (z + 3.0) - 4.0 * t * t, slope = 3.0 * z * (z + 2.0);
  const vec root_of_fit = z - value * slope / (slope * slope - 3.0 * (z + 1.0) * value);
  return is_spread ? mean + p * (1.0 + root_of_fit) : mean;
}
}    // namespace

// Contacts whose records hold normal, tangent, lever arms and bias, and no compliance: set tangents on which S is diagonal, the
// block, the kind of law and 1/lambda_max(W); relative velocities [m/s], and their normal parts.
extern "C" void sg_set_solid_blocks(int n, const int *pair, const double *bodies, double *records, double *velocity,
                                   double *opening) {
  for (int first = 0; first < n; first += width) {
    int slot[2][width];
    double *row[width];
    for (int i = 0; i < width; ++i) {
      const int k = first + i < n ? first + i : n - 1;    // the last contact again beyond the end
      for (int side = 0; side < 2; ++side) slot[side][i] = pair[2 * k + side];
      row[i] = records + static_cast<long>(record::length) * k;
    }
    vec v[record::wnn + 1];
    for (int place = 0; place < record::wnn; place += width) {
      for (int i = 0; i < width; ++i) v[place + i] = load(row[i] + place);
      transpose(v[place], v[place + 1], v[place + 2], v[place + 3]);
    }
    const three normal = {v[0], v[1], v[2]}, tangent = {v[3], v[4], v[5]}, across = cross(normal, tangent);
    const three arm_c = {v[6], v[7], v[8]}, arm_a = {v[9], v[10], v[11]};
    const solids c(slot[0], bodies), a(slot[1], bodies);
    matrix sum = {};
    c.add(arm_c, sum);
    a.add(arm_a, sum);
    const three by_normal = times(sum, normal), by_tangent = times(sum, tangent), by_across = times(sum, across);
    const matrix w = {dot(normal, by_normal),   dot(tangent, by_tangent), dot(across, by_across),
                      dot(normal, by_tangent), dot(normal, by_across),   dot(tangent, by_across)};
    const mask moves = w.xx > none + tiny;
    const vec per_n = 1.0 / (moves ? w.xx : one);
    const vec s11 = moves ? w.yy - w.xy * w.xy * per_n : one, s22 = moves ? w.zz - w.xz * w.xz * per_n : one;
    const vec s12 = moves ? w.yz - w.xy * w.xz * per_n : one;
    vec cosine, sine;
    find_axis(s11 - s22, 2.0 * s12, cosine, sine);
    cosine = moves ? cosine : one, sine = moves ? sine : none;
    // S is positive for bodies that can move; where rounding or a driven body takes that away, a trace of W_nn keeps it so.
    const vec trace = 16 * epsilon * larger(larger(w.xx, w.yy), larger(w.zz, none + tiny));
    const vec cc = cosine * cosine, ss = sine * sine, cs = 2.0 * cosine * sine;
    const vec s1 = larger(trace, cc * s11 + cs * s12 + ss * s22), s2 = larger(trace, ss * s11 - cs * s12 + cc * s22);
    vec turned[width] = {normal.z, cosine * tangent.x + sine * across.x, cosine * tangent.y + sine * across.y,
                         cosine * tangent.z + sine * across.z};
    vec block[width] = {w.xx, cosine * w.xy + sine * w.xz, cosine * w.xz - sine * w.xy, s1};
    const vec largest = largest_of(w);
    vec last[width] = {none, none, moves ? one : none, moves ? 1.0 / (moves ? largest : one) : none};
    const three of_c = cross(c.spin, arm_c), of_a = cross(a.spin, arm_a);
    vec u[width] = {c.velocity.x - a.velocity.x + of_c.x - of_a.x + v[record::bias],
                    c.velocity.y - a.velocity.y + of_c.y - of_a.y + v[record::bias + 1],
                    c.velocity.z - a.velocity.z + of_c.z - of_a.z + v[record::bias + 2], none};
    const vec parting = dot(normal, {u[0], u[1], u[2]});
    transpose(turned[0], turned[1], turned[2], turned[3]);
    transpose(block[0], block[1], block[2], block[3]);
    transpose(last[0], last[1], last[2], last[3]);
    transpose(u[0], u[1], u[2], u[3]);
    for (int i = 0; i < width && first + i < n; ++i) {
      store(turned[i], row[i] + record::normal_z);
      store(block[i], row[i] + record::wnn);
      row[i][record::s2] = s2[i];
      store(last[i], row[i] + record::compliance_n);
      for (int j = 0; j < 3; ++j) velocity[3 * (first + i) + j] = u[i][j];
      opening[first + i] = parting[i];
    }
  }
}
