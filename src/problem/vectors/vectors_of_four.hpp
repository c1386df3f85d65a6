// Four numbers side by side in a vector register.
//
// Vectors of four are GNU extensions that g++ and clang translate for any processor. Records are loaded whole and transposed in
// registers, four at a time, which Fortran has no words for: loads number by number take as long as all the rest.
#pragma once
#pragma GCC diagnostic ignored "-Wpsabi"    // vectors are handed over within single files alone

namespace {
typedef double vec __attribute__((vector_size(32)));
typedef double loose __attribute__((vector_size(32), aligned(8)));    // the same anywhere in memory
typedef long long mask __attribute__((vector_size(32)));

constexpr int width = 4;

inline vec load(const double *from) { return *reinterpret_cast<const loose *>(from); }
inline void store(const vec &v, double *to) { *reinterpret_cast<loose *>(to) = v; }

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
}    // namespace
