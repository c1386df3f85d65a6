// Contacts of solids with friction put side by side, eight in a row (interface: sweep_solid_order.f90).

#include <limits>

#include "lanes.hpp"

namespace {
constexpr double least_active = 0.5, least_linear = 1.5, rounding = 8 * std::numeric_limits<double>::epsilon();
// Places of sg_records, from zero.
namespace record {
enum { normal, tangent = 3, bias = 12, wnn = 15, wn1, friction = 20, compliance_n = 22, length = 26 };
}
// Places of a row, from zero: as many as the record has from normal to arms come after the impulses.
enum { impulse_n, impulse_1, impulse_2, row_normal, geometry = 12, row_bias = row_normal + geometry, inverse_wnn, g1, g2, s1, s2,
       row_friction };

// Let half a row that holds no contact change nothing.
inline void clear(double *row) {
  for (int place = impulse_n; place <= row_friction; ++place)
    store(place == s1 || place == s2 ? vec{} + 1.0 : vec{}, row + lanes * place);
}

inline vec size_of(const vec &v) { return v < vec{} ? -v : v; }
inline vec largest_of(const vec &x, const vec &y, const vec &z) { return larger(larger(size_of(x), size_of(y)), size_of(z)); }
}    // namespace

// Put up to eight contacts side by side; contacts count from one, and so many are left in their list. A contact that takes no part,
// and a lane to spare, has no direction, and S = 1. Bit 0 of the flags is set where a law has compliance, or a bias along tangents,
// bit 1 where a contact takes no part or has cohesion.
extern "C" void sg_put_solid_row(int left, int n, const int *contact, const double *record, const double *impulse, double *row,
                                int *flags) {
  const vec none = {}, one = none + 1.0, place = {1, 2, 3, 4};
  mask special = {}, uncommon = {};
  ask_records<record::length>(contact, left, record);
  for (int h = 0; h < halves; ++h, row += width) {
    if (n <= width * h) {
      clear(row);
      continue;
    }
    const double *own[width];
    vec r[3];
    for (int i = 0; i < width; ++i) {
      const long k = contact[width * h + i < n ? width * h + i : n - 1] - 1;
      own[i] = record + record::length * k;
      for (int c = 0; c < 3; ++c) r[c][i] = impulse[3 * k + c];
    }
    const auto fetch = [&own](int from, vec *to) {
      for (int i = 0; i < width; ++i) to[i] = load(own[i] + from);
      transpose(to[0], to[1], to[2], to[3]);
    };
    vec v[record::friction + width], last[width];    // values of records; then compliances, the kind of law and one more
    for (int from = 0; from < record::friction + width; from += width) fetch(from, v + from);
    fetch(record::compliance_n, last);
    const vec &law = last[2], &cohesion = v[record::friction + 1];
    const mask is_used = place <= none + static_cast<double>(n - width * h), takes_part = is_used & (law >= none + least_active);
    const vec *const x = v + record::normal, *const t = v + record::tangent, *const b = v + record::bias;
    const vec inverse = 1.0 / (takes_part ? v[record::wnn] : one);
    const auto fill = [&](const auto &put) {
      put(x[0] * r[0] + x[1] * r[1] + x[2] * r[2] + cohesion, none, impulse_n);
      put(t[0] * r[0] + t[1] * r[1] + t[2] * r[2], none, impulse_1);
      put((x[1] * t[2] - x[2] * t[1]) * r[0] + (x[2] * t[0] - x[0] * t[2]) * r[1] + (x[0] * t[1] - x[1] * t[0]) * r[2], none,
          impulse_2);
      for (int i = 0; i < geometry; ++i) put(v[i], none, row_normal + i);
      // Cohesion is in the impulse, but what yields to a law with compliance is the impulse without it.
      put(x[0] * b[0] + x[1] * b[1] + x[2] * b[2] - last[0] * cohesion, none, row_bias);
      put(inverse, none, inverse_wnn);
      put(v[record::wn1] * inverse, none, g1);
      put(v[record::wn1 + 1] * inverse, none, g2);
      put(v[record::wn1 + 2], one, s1);
      put(v[record::wn1 + 3], one, s2);
      put(law > none + least_linear ? none - 1.0 : v[record::friction], none, row_friction);
    };
    if (takes_part[0] & takes_part[1] & takes_part[2] & takes_part[3])
      fill([row](const vec &value, const vec &, int to) { store(value, row + lanes * to); });
    else
      fill([&](const vec &value, const vec &otherwise, int to) { store(takes_part ? value : otherwise, row + lanes * to); });
    const vec oblique = largest_of(x[1] * b[2] - x[2] * b[1], x[2] * b[0] - x[0] * b[2], x[0] * b[1] - x[1] * b[0]);
    const mask yields = larger(size_of(last[0]), size_of(last[1])) > none;
    uncommon |= is_used & (~takes_part | (cohesion != none));
    special |= is_used & ((oblique > rounding * largest_of(b[0], b[1], b[2])) | yields);
  }
  if (special[0] | special[1] | special[2] | special[3]) *flags |= 1;
  if (uncommon[0] | uncommon[1] | uncommon[2] | uncommon[3]) *flags |= 2;
}
