// Gauss-Seidel sweep over contacts of disks with Coulomb friction, eight side by side, and what puts contacts side by side
// (interface: sweep_round_lanes.f90). The local problem is that of sweep_round.f90.

#include <limits>

#include "lanes.hpp"

namespace {
// Groups by which records, and bodies where they come from far, are asked for before their turn: so many fill the second cache.
constexpr int ahead = 6, bodies_ahead = 3, many_bodies = 80000;
using namespace disk_lane;

// Four contacts; plain ones share friction, and the ratio of 1/W_tt to 1/W_nn.
template <bool are_plain>
inline void update(const double *record, const double *shared, double relaxation, double *impulse, plane_bodies &c,
                   plane_bodies &a) {
  const vec none = {};
  const auto at = [record](int place) { return load(record + lanes * place); };
  const vec x = at(normal_x), y = at(normal_y), dx = c.x - a.x, dy = c.y - a.y;
  const vec per_n = at(are_plain ? int{plain_inverse_wnn} : int{inverse_wnn});
  const vec per_t = are_plain ? shared[1] * per_n : at(inverse_wtt), mu = are_plain ? none + shared[0] : at(friction);
  const vec u_n = x * dx + y * dy + at(bias_n), slip = y * dx - x * dy + c.turn + a.turn;
  const vec u_t = are_plain ? slip : slip + at(bias_t), old_n = load(impulse), old_t = load(impulse + lanes);
  const vec r_n = larger(old_n - u_n * per_n, none), limit = mu * r_n;
  const vec r_t = larger(smaller(old_t - u_t * per_t, limit), -limit);
  const vec d_n = relaxation * (r_n - old_n), d_t = relaxation * (r_t - old_t);
  store(old_n + d_n, impulse);
  store(old_t + d_t, impulse + lanes);
  const vec p_x = x * d_n + y * d_t, p_y = y * d_n - x * d_t;
  c.x += c.per_mx * p_x, c.y += c.per_my * p_y, c.turn += c.per_i * d_t;
  a.x -= a.per_mx * p_x, a.y -= a.per_my * p_y, a.turn += a.per_i * d_t;
}

template <bool are_plain, bool is_far>
void sweep(int n_groups, const int *pair, const double *record, const double *shared, double relaxation, double *impulse,
           double *body) {
  constexpr int length = are_plain ? int{plain_length} : int{full_length};
  for (int g = 0; g < n_groups; ++g, pair += 2 * lanes, record += lanes * length, impulse += 2 * lanes) {
    ask(record + ahead * lanes * length, lanes * length);
    ask(impulse + ahead * 2 * lanes, 2 * lanes);
    if (is_far && g + bodies_ahead < n_groups)
      for (int i = 0; i < 2 * lanes; ++i) __builtin_prefetch(plane_bodies::record(pair[bodies_ahead * 2 * lanes + i], body), 1);
    plane_bodies candidate[halves], antagonist[halves];
    for (int h = 0; h < halves; ++h) candidate[h].fetch(pair + width * h, body);
    for (int h = 0; h < halves; ++h) antagonist[h].fetch(pair + lanes + width * h, body);
    for (int h = 0; h < halves; ++h)
      update<are_plain>(record + width * h, shared, relaxation, impulse + width * h, candidate[h], antagonist[h]);
    for (int h = halves - 1; h >= 0; --h) candidate[h].put_back(pair + width * h, body);
    for (int h = halves - 1; h >= 0; --h) antagonist[h].put_back(pair + lanes + width * h, body);
  }
}
}    // namespace

extern "C" void sg_sweep_round_groups(int n_groups, int are_plain, int n_bodies, const int *pair, const double *record,
                                     const double *shared, double relaxation, double *impulse, double *body) {
  const auto kernel = n_bodies < many_bodies ? (are_plain ? sweep<true, false> : sweep<false, false>)
                                             : (are_plain ? sweep<true, true> : sweep<false, true>);
  kernel(n_groups, pair, record, shared, relaxation, impulse, body);
}

// Put contacts side by side, group by group; contacts count from one, and so many are left in their list. Where records are to be
// plain: are they?
extern "C" void sg_put_round_groups(int n_groups, const int *group_size, int left, int are_plain, const double *shared,
                                  const int *contact, const int *pair, const double *record, const double *impulse, int *lane_pair,
                                  double *lane_record, double *lane_impulse, int *is_done) {
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
  const vec none = {};
  mask differs = {};
  for (int g = 0; g < n_groups; ++g) {
    const int n = group_size[g];
    const members own(contact, n);
    ask_records<full_length>(contact, left, record);
    for (int h = 0; h < halves; ++h) {
      const int *const four = own.contact + width * h;
      double *const lane = lane_record + width * h;
      const double *row[width];
      for (int i = 0; i < width; ++i) row[i] = record + static_cast<long>(full_length) * (four[i] - 1);
      vec one[width], other[width];    // normal and bias; then bias along the tangent once more, and the rest
      for (int i = 0; i < width; ++i) one[i] = load(row[i]);
      for (int i = 0; i < width; ++i) other[i] = load(row[i] + bias_t);
      transpose(one[0], one[1], one[2], one[3]);
      transpose(other[0], other[1], other[2], other[3]);
      for (int i = 0; i < bias_t; ++i) store(one[i], lane + lanes * i);
      if (are_plain) {
        const vec error = other[2] - shared[1] * other[1], size = error < none ? -error : error;
        differs |= (other[0] != none) | (other[3] != none + shared[0]) | (size > rounding * other[2]);
        store(other[1], lane + lanes * plain_inverse_wnn);
      } else {
        for (int i = 0; i < width; ++i) store(other[i], lane + lanes * (bias_t + i));
      }
      put_pairs<2>(four, pair, impulse, lane_pair + width * h, lane_impulse + width * h);
    }
    if (are_plain) clear_lanes<2, plain_length>(n, lane_pair, lane_record, lane_impulse);
    else clear_lanes<2, full_length>(n, lane_pair, lane_record, lane_impulse);
    contact += n, left -= n;
    lane_pair += 2 * lanes, lane_record += (are_plain ? int{plain_length} : int{full_length}) * lanes, lane_impulse += 2 * lanes;
  }
  *is_done = (differs[0] | differs[1] | differs[2] | differs[3]) == 0;
}
