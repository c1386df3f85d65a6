// Bodies of four contacts side by side: places of their records are those of sg_records, from zero.
#pragma once

#include "vectors_of_four.hpp"

namespace {
// Four bodies of the plane: places that kinds with friction share.
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
