// What sweeps over groups of contacts load and store by vectors of four: places of records in lanes, and records of bodies.
#pragma once

#include "../../problem/vectors/vectors_of_four.hpp"

namespace {
constexpr int lanes = 8, halves = lanes / width;

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

// Ask for what is about to be read and written; nothing happens beyond the end of a list.
inline void ask(const double *first, int reals) {
  for (int i = 0; i < reals; i += 8) __builtin_prefetch(first + i, 1);
}

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
