// Four numbers side by side in a vector register, and what sweeps over groups of contacts load and store by them.
//
// Records of bodies are loaded whole and transposed in registers, four at a time, which Fortran has no words for: loads number
// by number take as long as all the rest. Vectors of four are GNU extensions that g++ and clang translate for any processor.
#pragma once
#pragma GCC diagnostic ignored "-Wpsabi"    // vectors are handed over within single files alone

namespace {
typedef double vec __attribute__((vector_size(32)));
typedef double loose __attribute__((vector_size(32), aligned(8)));    // the same anywhere in memory
typedef long long mask __attribute__((vector_size(32)));

constexpr int lanes = 8, width = 4, halves = lanes / width;

// Places of a contact in a lane, from zero: those of sg_records; records of plain disks are shorter.
namespace disk_lane {
enum { normal_x, normal_y, bias_n, bias_t, inverse_wnn, inverse_wtt, friction, full_length };
enum { plain_inverse_wnn = bias_n + 1, plain_length };
}    // namespace disk_lane
namespace arm_lane {
enum { normal_x, normal_y, moment_nc, moment_tc, moment_na, moment_ta, bias_n, bias_t, w_nn, w_nt, w_tt, friction, lane_length };
}    // namespace arm_lane
namespace ball_lane {
enum { normal_x, normal_y, normal_z, bias_x, bias_y, bias_z, inverse_wnn, inverse_wtt, friction, lane_length };
}    // namespace ball_lane

inline vec load(const double *from) { return *reinterpret_cast<const loose *>(from); }
inline void store(const vec &v, double *to) { *reinterpret_cast<loose *>(to) = v; }

// Ask for what is about to be read and written; nothing happens beyond the end of a list.
inline void ask(const double *first, int reals) {
  for (int i = 0; i < reals; i += 8) __builtin_prefetch(first + i, 1);
}

// Rows become columns.
inline void transpose(vec &a, vec &b, vec &c, vec &d) {
  const vec p = __builtin_shufflevector(a, b, 0, 4, 2, 6), q = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const vec r = __builtin_shufflevector(c, d, 0, 4, 2, 6), s = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(p, r, 0, 1, 4, 5);
  b = __builtin_shufflevector(q, s, 0, 1, 4, 5);
  c = __builtin_shufflevector(p, r, 2, 3, 6, 7);
  d = __builtin_shufflevector(q, s, 2, 3, 6, 7);
}

// Divisors of lanes that are left out anyway are one: debug builds end a run that divides by zero.
inline vec divisor(const vec &v) {
  const vec none = {}, one = none + 1.0;
  return v > none ? v : one;
}

// Square roots of four numbers, none of which is negative.
inline vec root(const vec &v) {
  return vec{__builtin_sqrt(v[0]), __builtin_sqrt(v[1]), __builtin_sqrt(v[2]), __builtin_sqrt(v[3])};
}

inline vec larger(const vec &a, const vec &b) { return a > b ? a : b; }
inline vec smaller(const vec &a, const vec &b) { return a < b ? a : b; }

// Ask for records of contacts some groups ahead: as many contacts follow in the list as `left`; contacts count from one.
template <int length>
inline void ask_records(const int *contact, int left, const double *record) {
  constexpr int ahead = 3;
  if (left < (ahead + 1) * lanes) return;
  for (int i = ahead * lanes; i < (ahead + 1) * lanes; ++i) {
    const double *from = record + static_cast<long>(length) * (contact[i] - 1);
    for (int j = 0; j < length; j += 8) __builtin_prefetch(from + j);
    __builtin_prefetch(from + length - 1);
  }
}

// Slots and impulses of four contacts.
template <int components>
inline void put_pairs(const int *contact, const int *pair, const double *impulse, int *lane_pair, double *lane_impulse) {
  for (int i = 0; i < width; ++i) {
    const long k = contact[i] - 1;
    for (int side = 0; side < 2; ++side) lane_pair[lanes * side + i] = pair[2 * k + side];
    for (int c = 0; c < components; ++c) lane_impulse[lanes * c + i] = impulse[components * k + c];
  }
}

// Four bodies of the plane side by side: places of sg_records, from zero, which kinds with friction share.
struct plane_bodies {
  enum { velocity_x, velocity_y, spin, inverse_mx, inverse_my, inverse_i, length };
  vec x, y, turn, per_mx, per_my, per_i;

  static const double *record(int slot, const double *body) { return body + static_cast<long>(length) * (slot - 1); }

  // Velocities alone. Slots count from one.
  void fetch_velocities(const int *slot, const double *body) {
    x = load(record(slot[0], body)), y = load(record(slot[1], body));
    turn = load(record(slot[2], body)), per_mx = load(record(slot[3], body));
    transpose(x, y, turn, per_mx);
  }

  void fetch(const int *slot, const double *body) {
    fetch_velocities(slot, body);
    vec a = load(record(slot[0], body) + spin), b = load(record(slot[1], body) + spin);
    per_my = load(record(slot[2], body) + spin), per_i = load(record(slot[3], body) + spin);
    transpose(a, b, per_my, per_i);
  }

  // Lanes that change nothing repeat the bodies of the first one, which is stored last.
  void put_back(const int *slot, double *body) const {
    vec row[width] = {x, y, turn, per_mx};
    transpose(row[0], row[1], row[2], row[3]);
    for (int i = width - 1; i >= 0; --i) store(row[i], body + static_cast<long>(length) * (slot[i] - 1));
  }
};

// Four balls side by side: a record fills a cache line.
struct space_bodies {
  enum { second_half = 4, length = 8 };    // three velocities and a spin, then two spins and inverse masses
  vec x, y, z, sx, sy, sz, per_m, per_i;

  static const double *record(int slot, const double *body) { return body + static_cast<long>(length) * (slot - 1); }

  // Slots count from one.
  void fetch(const int *slot, const double *body) {
    x = load(record(slot[0], body)), y = load(record(slot[1], body));
    z = load(record(slot[2], body)), sx = load(record(slot[3], body));
    sy = load(record(slot[0], body) + second_half), sz = load(record(slot[1], body) + second_half);
    per_m = load(record(slot[2], body) + second_half), per_i = load(record(slot[3], body) + second_half);
    transpose(x, y, z, sx);
    transpose(sy, sz, per_m, per_i);
  }

  // Lanes that change nothing repeat the bodies of the first one, which is stored last.
  void put_back(const int *slot, double *body) const {
    vec one[width] = {x, y, z, sx}, other[width] = {sy, sz, per_m, per_i};
    transpose(one[0], one[1], one[2], one[3]);
    transpose(other[0], other[1], other[2], other[3]);
    for (int i = width - 1; i >= 0; --i) {
      double *to = body + static_cast<long>(length) * (slot[i] - 1);
      store(one[i], to);
      store(other[i], to + second_half);
    }
  }
};
}    // namespace
