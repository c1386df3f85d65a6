// Sums that the errors of a solution are made of, over contacts one after the other, from the records of a problem, four contacts
// at a time (interface: error_records.f90).

#include "../kernels/error_maps.hpp"

namespace {
constexpr int before_turn = 32;    // contacts by which records are asked for before their turn
// Places of sg_records, from zero.
namespace arm_record {
enum { cohesion = arm_lane::lane_length, length = cohesion + 4 };    // then two compliances and the kind of law
}
namespace solid_record {
enum { normal_x, normal_y, normal_z, arm_c = 6, arm_a = 9, bias = 12, s1 = 18, friction = 20, cohesion, compliance_n, law = 24,
       inverse_lambda, length };
}

// Four records: values that follow each other from a place on, side by side.
template <int length>
struct records {
  const double *row[width];

  records(const double *first, int left) {
    for (int i = 0; i < width; ++i) row[i] = first + static_cast<long>(length) * (i < left ? i : left - 1);
  }
  void fetch(int place, vec *to) const {
    for (int i = 0; i < width; ++i) to[i] = load(row[i] + place);
    transpose(to[0], to[1], to[2], to[3]);
  }
};

// Slots and impulses of four contacts; what is beyond the last one repeats it.
template <int components>
struct sides {
  int candidate[width], antagonist[width];
  vec r[components];

  sides(const int *pair, const double *impulse, int left) {
    for (int i = 0; i < width; ++i) {
      const int k = i < left ? i : left - 1;
      candidate[i] = pair[2 * k], antagonist[i] = pair[2 * k + 1];
      for (int c = 0; c < components; ++c) r[c][i] = impulse[components * k + c];
    }
  }
};

// Velocities of four bodies with lever arms in space.
struct solid_bodies {
  enum { length = 16 };
  vec x, y, z, sx, sy, sz;

  solid_bodies(const int *slot, const double *body) {
    const auto record = [=](int i) { return body + static_cast<long>(length) * (slot[i] - 1); };
    vec rest[2];
    x = load(record(0)), y = load(record(1)), z = load(record(2)), sx = load(record(3));
    sy = load(record(0) + width), sz = load(record(1) + width);
    rest[0] = load(record(2) + width), rest[1] = load(record(3) + width);
    transpose(x, y, z, sx);
    transpose(sy, sz, rest[0], rest[1]);
  }
};

// Judge four contacts; have they all a law that this file has maps for, unilateral with friction alone, or none?
inline bool judge_rounds(int left, const mask &in_use, bool with_e1, const int *pair, const double *record, const double *impulse,
                  const double *body, totals &to, double *closing) {
  const records<disk_lane::full_length> own(record, left);
  const sides<2> of(pair, impulse, left);
  vec v[8];
  own.fetch(disk_lane::bias_t, v + disk_lane::bias_t);
  own.fetch(0, v);
  plane_bodies c, a;
  c.fetch_velocities(of.candidate, body), a.fetch_velocities(of.antagonist, body);
  judge_round<false>(in_use, with_e1, [&v](int place) { return v[place]; }, 0, 0, c, a, of.r[0], of.r[1], to, closing);
  return true;
}

inline bool judge_arms(int left, const mask &in_use, bool with_e1, const int *pair, const double *record, const double *impulse,
                const double *body, totals &to, double *closing) {
  const records<arm_record::length> own(record, left);
  const sides<2> of(pair, impulse, left);
  vec v[arm_record::length];
  for (int place = 0; place < arm_record::length; place += width) own.fetch(place, v + place);
  const vec *const rest = v + arm_record::cohesion;
  const mask is_strange = (rest[0] != none) | (rest[1] != none) | (rest[2] != none) | (rest[3] > one);
  plane_bodies c, a;
  c.fetch_velocities(of.candidate, body), a.fetch_velocities(of.antagonist, body);
  judge_arm(in_use, with_e1, [&v](int place) { return v[place]; }, rest[3] == one, c, a, of.r[0], of.r[1], to, closing);
  return !(is_strange[0] | is_strange[1] | is_strange[2] | is_strange[3]);
}

inline bool judge_balls(int left, const mask &in_use, bool with_e1, const int *pair, const double *record, const double *impulse,
                 const double *body, totals &to, double *closing) {
  using namespace ball_lane;
  const records<lane_length> own(record, left);
  const sides<3> of(pair, impulse, left);
  vec v[lane_length];
  own.fetch(0, v), own.fetch(width, v + width);
  for (int i = 0; i < width; ++i) v[friction][i] = own.row[i][friction];
  space_bodies c, a;
  c.fetch(of.candidate, body), a.fetch(of.antagonist, body);
  judge_ball(in_use, with_e1, [&v](int place) { return v[place]; }, c, a, of.r[0], of.r[1], of.r[2], to, closing);
  return true;
}

inline bool judge_solids(int left, const mask &in_use, bool with_e1, const int *pair, const double *record, const double *impulse,
                  const double *body, totals &to, double *closing) {
  using namespace solid_record;
  const records<length> own(record, left);
  const sides<3> of(pair, impulse, left);
  vec n[4], v[12], middle[4], last[4];
  own.fetch(0, n), own.fetch(4, v), own.fetch(8, v + 4), own.fetch(bias, v + 8);
  own.fetch(s1, middle), own.fetch(compliance_n, last);
  const vec *const arm_c = v + 2, *const arm_a = v + 5, *const b = v + 8, mu = middle[2];
  const mask is_strange = (middle[3] != none) | (last[0] != none) | (last[1] != none) | (last[2] > one);
  const solid_bodies c(of.candidate, body), a(of.antagonist, body);
  const vec ux = c.x - a.x + b[0] + (c.sy * arm_c[2] - c.sz * arm_c[1]) - (a.sy * arm_a[2] - a.sz * arm_a[1]);
  const vec uy = c.y - a.y + b[1] + (c.sz * arm_c[0] - c.sx * arm_c[2]) - (a.sz * arm_a[0] - a.sx * arm_a[2]);
  const vec uz = c.z - a.z + b[2] + (c.sx * arm_c[1] - c.sy * arm_c[0]) - (a.sx * arm_a[1] - a.sy * arm_a[0]);
  judge_space(in_use, with_e1, n[0], n[1], n[2], ux, uy, uz, of.r[0], of.r[1], of.r[2], mu, last[3], to, closing);
  return !(is_strange[0] | is_strange[1] | is_strange[2] | is_strange[3]);
}

template <int length, int components, auto judge>
bool measure(int n, const int *pair, const double *record, const double *impulse, const double *body, bool with_e1, totals &to,
             double *closing) {
  const vec place = {1, 2, 3, 4};
  bool is_done = true;
  for (int first = 0; first < n && is_done; first += width) {
    const double *const later = record + static_cast<long>(length) * (first + before_turn);
    for (int i = 0; i < width * length; i += 8) __builtin_prefetch(later + i);
    const int left = n - first;
    is_done = judge(left, place <= none + static_cast<double>(left), with_e1, pair + 2 * first,
                    record + static_cast<long>(length) * first, impulse + components * first, body, to, closing + first);
  }
  return is_done;
}
}    // namespace

// Add contacts to four sums each of six, which lie `stride` apart, and find their bound where e1 is wanted. Have all of them a law
// that there are maps for? Else nothing has been added.
extern "C" void sg_measure_records(int kind, int n, const int *pair, const double *record, const double *impulse,
                                  const double *body, int with_e1, int stride, double *sums, double *closing, double *bound,
                                  int *is_done) {
  const auto kernel = kind == round  ? measure<disk_lane::full_length, 2, judge_rounds>
                      : kind == arm  ? measure<arm_record::length, 2, judge_arms>
                      : kind == ball ? measure<ball_lane::lane_length, 3, judge_balls>
                                     : measure<solid_record::length, 3, judge_solids>;
  totals to;
  *is_done = kernel(n, pair, record, impulse, body, with_e1 != 0, to, closing);
  if (!*is_done) return;
  for (int i = 0; i < 6; ++i) store(load(sums + static_cast<long>(stride) * i) + to.sum[i], sums + static_cast<long>(stride) * i);
  *bound = to.worst[0];
  for (int i = 1; i < width; ++i) *bound = to.worst[i] > *bound ? to.worst[i] : *bound;
}
