// Sums that the errors of a solution are made of, over contacts side by side, from the records of sweeps (interface:
// error_lanes.f90).

#include "error_maps.hpp"

namespace {
constexpr int chunk = 16, ahead = 8;    // groups that share a bound, and groups by which records are asked for before their turn

template <int kind>
int measure(int n_groups, int length, const int *group_size, const int *pair, const double *record, const double *shared,
            const double *impulse, const double *body, bool with_e1, double *sums, double *closing, double *bounds) {
  constexpr int components = kind == ball ? 3 : 2;
  const vec place = {1, 2, 3, 4};
  const double friction = shared[0], ratio = shared[1];
  totals to;
  mask is_lost = {}, none_of = {};
  for (int g = 0; g < n_groups; ++g) {
    ask(record + ahead * lanes * length, lanes * length);
    for (int h = 0; h < halves; ++h) {
      const mask in_use = place <= none + static_cast<double>(group_size[g] - width * h);
      const int i = width * h;
      const auto at = [record, i](int value) { return load(record + i + lanes * value); };
      const vec r = load(impulse + i), r_next = load(impulse + i + lanes);
      if constexpr (kind == ball) {
        space_bodies c, a;
        c.fetch(pair + i, body), a.fetch(pair + i + lanes, body);
        judge_ball(in_use, with_e1, at, c, a, r, r_next, load(impulse + i + 2 * lanes), to, closing + i);
        continue;
      }
      plane_bodies c, a;
      c.fetch_velocities(pair + i, body), a.fetch_velocities(pair + i + lanes, body);
      if constexpr (kind == arm) {
        // A lane in use that stands for a contact that takes no part has lost its record.
        is_lost |= in_use & (at(arm_lane::friction) < none);
        judge_arm(in_use, with_e1, at, ~none_of, c, a, r, r_next, to, closing + i);
      } else {
        judge_round<kind == plain_round>(in_use, with_e1, at, friction, ratio, c, a, r, r_next, to, closing + i);
      }
    }
    pair += 2 * lanes, record += lanes * length, impulse += components * lanes, closing += lanes;
    if (!with_e1 || (g % chunk != chunk - 1 && g != n_groups - 1)) continue;
    double largest = to.worst[0];
    for (int i = 1; i < width; ++i) largest = to.worst[i] > largest ? to.worst[i] : largest;
    bounds[g / chunk] = largest;
    to.worst = none;
  }
  for (int i = 0; i < 6; ++i) sums[i] = (to.sum[i][0] + to.sum[i][1]) + (to.sum[i][2] + to.sum[i][3]);
  return !(is_lost[0] | is_lost[1] | is_lost[2] | is_lost[3]);
}
}    // namespace

// Are records of all contacts there? Else nothing is to be used.
extern "C" int sg_measure_lanes(int kind, int n_groups, int length, const int *group_size, const int *pair, const double *record,
                               const double *shared, const double *impulse, const double *body, int with_e1,
                               double *sums, double *closing, double *bounds) {
  const auto kernel = kind == round         ? measure<round>
                      : kind == plain_round ? measure<plain_round>
                      : kind == arm         ? measure<arm>
                                            : measure<ball>;
  return kernel(n_groups, length, group_size, pair, record, shared, impulse, body, with_e1 != 0, sums,
                closing, bounds);
}
