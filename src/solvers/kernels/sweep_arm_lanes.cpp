// Gauss-Seidel sweep over contacts with arms and Coulomb friction, eight side by side, and what puts contacts side by side
// (interfaces: sweep_arm_lanes.f90, residuals.f90).
//
// The local problem is `coulomb_step` of sweep_arm.f90; what the own impulse of a sticking contact does cancels.

#include "lanes.hpp"

namespace {
constexpr int ahead = 4, before_turn = 32;    // groups, and contacts one by one, by which records are asked for before their turn
using namespace arm_lane;
// Places of sg_records beyond those of a lane.
enum { cohesion = lane_length, compliance_n, compliance_t, law, record_length };
typedef plane_bodies bodies;

// Four contacts: record and impulse lie `lanes` apart.
struct contacts {
  const double *record;
  double *impulse;
  vec u_n, u_t, q_n, r_n, r_t;
  mask slides;

  vec at(int place) const { return load(record + lanes * place); }

  // Impulses of contacts that part or stick, and which ones slide.
  void open_or_stick(const bodies &c, const bodies &a) {
    const vec x = at(normal_x), y = at(normal_y), dx = c.x - a.x, dy = c.y - a.y, none = {};
    u_n = x * dx + y * dy + at(moment_nc) * c.turn - at(moment_na) * a.turn + at(bias_n);
    u_t = y * dx - x * dy + at(moment_tc) * c.turn - at(moment_ta) * a.turn + at(bias_t);
    const vec nn = at(w_nn), nt = at(w_nt), tt = at(w_tt), old_n = load(impulse), old_t = load(impulse + lanes);
    const vec determinant = nn * tt - nt * nt, inverse = 1.0 / divisor(determinant);
    q_n = u_n - nn * old_n - nt * old_t;
    const mask is_open = q_n >= none, is_regular = determinant > none;
    r_n = old_n + (nt * u_t - tt * u_n) * inverse;
    r_t = is_regular ? old_t + (nt * u_n - nn * u_t) * inverse : none;
    const vec size = r_t < none ? -r_t : r_t;
    slides = ~(is_open | (is_regular & (r_n >= none) & (size <= at(friction) * r_n)));
    r_n = is_open ? none : r_n;
    r_t = is_open ? none : r_t;
  }

  // Impulses of contacts that slide: to the side to which they stick, else where no impulse would take them, else to the other.
  void slide() {
    const vec nn = at(w_nn), nt = at(w_nt), tt = at(w_tt), none = {};
    const vec q_t = u_t - nt * load(impulse) - tt * load(impulse + lanes);
    const mask is_left = ((r_t < none) | ((r_t == none) & (q_t >= none)));
    const vec along = is_left ? -at(friction) : at(friction), bend = along * nt, stiffness = nn - bend;
    const vec one = -q_n / divisor(nn + bend), other = -q_n / divisor(stiffness > none ? stiffness : nn);
    const vec slip = q_t + (nt + tt * along) * one;
    const mask is_right = ((is_left ? -slip : slip) <= none) & (nn + bend > none);
    r_n = slides ? (is_right ? one : other) : r_n;
    r_t = slides ? (is_right ? along * one : -along * other) : r_t;
  }

  // Take a share of the change, and let the bodies feel it.
  void push(double relaxation, bodies &c, bodies &a) {
    const vec x = at(normal_x), y = at(normal_y), old_n = load(impulse), old_t = load(impulse + lanes), none = {};
    const mask takes_part = at(friction) >= none;
    const vec d_n = takes_part ? relaxation * (r_n - old_n) : none, d_t = takes_part ? relaxation * (r_t - old_t) : none;
    store(old_n + d_n, impulse);
    store(old_t + d_t, impulse + lanes);
    const vec p_x = x * d_n + y * d_t, p_y = y * d_n - x * d_t;
    c.x += c.per_mx * p_x, c.y += c.per_my * p_y, c.turn += c.per_i * (at(moment_nc) * d_n + at(moment_tc) * d_t);
    a.x -= a.per_mx * p_x, a.y -= a.per_my * p_y, a.turn -= a.per_i * (at(moment_na) * d_n + at(moment_ta) * d_t);
  }
};
}    // namespace

extern "C" void sg_sweep_arm_groups(int n_groups, const int *pair, const double *record, double relaxation, double *impulse,
                                   double *body) {
  for (int g = 0; g < n_groups; ++g, pair += 2 * lanes, record += lanes * lane_length, impulse += 2 * lanes) {
    ask(record + ahead * lanes * lane_length, lanes * lane_length);
    ask(impulse + ahead * 2 * lanes, 2 * lanes);
    bodies candidate[halves], antagonist[halves];
    contacts contact[halves];
    mask slides = {};
    for (int h = 0; h < halves; ++h) candidate[h].fetch(pair + width * h, body);
    for (int h = 0; h < halves; ++h) antagonist[h].fetch(pair + lanes + width * h, body);
    for (int h = 0; h < halves; ++h) {
      contact[h].record = record + width * h;
      contact[h].impulse = impulse + width * h;
      contact[h].open_or_stick(candidate[h], antagonist[h]);
      slides |= contact[h].slides;
    }
    if (slides[0] | slides[1] | slides[2] | slides[3])
      for (int h = 0; h < halves; ++h) contact[h].slide();
    for (int h = 0; h < halves; ++h) contact[h].push(relaxation, candidate[h], antagonist[h]);
    for (int h = halves - 1; h >= 0; --h) candidate[h].put_back(pair + width * h, body);
    for (int h = halves - 1; h >= 0; --h) antagonist[h].put_back(pair + lanes + width * h, body);
  }
}

// Put contacts side by side, group by group; contacts count from one, and so many are left in their list. What is put ends, and is
// counted, before the first group with a law that is not unilateral with friction alone, or with a contact that takes no part.
extern "C" void sg_put_arm_groups(int n_groups, const int *group_size, int left, const int *contact, const int *pair,
                                 const double *record, const double *impulse, int *lane_pair, double *lane_record,
                                 double *lane_impulse, int *put) {
  const vec plain = {0, 0, 0, 1};
  for (*put = 0; *put < n_groups; ++*put) {
    const int n = group_size[*put];
    const members own(contact, n);
    mask is_plain = {-1, -1, -1, -1};
    ask_records<record_length>(contact, left, record);
    for (int h = 0; h < halves; ++h) {
      const int *const four = own.contact + width * h;
      const double *row[width];
      for (int i = 0; i < width; ++i) row[i] = record + static_cast<long>(record_length) * (four[i] - 1);
      for (int place = 0; place < lane_length; place += width) {
        vec v[width];
        for (int i = 0; i < width; ++i) v[i] = load(row[i] + place);
        transpose(v[0], v[1], v[2], v[3]);
        for (int i = 0; i < width; ++i) store(v[i], lane_record + lanes * (place + i) + width * h);
      }
      for (int i = 0; i < width; ++i) is_plain &= load(row[i] + cohesion) == plain;
      put_pairs<2>(four, pair, impulse, lane_pair + width * h, lane_impulse + width * h);
    }
    if (!(is_plain[0] & is_plain[1] & is_plain[2] & is_plain[3])) return;
    clear_lanes<2, lane_length>(n, lane_pair, lane_record, lane_impulse);
    for (int i = n; i < lanes; ++i) {
      lane_record[lanes * w_nn + i] = 1, lane_record[lanes * w_tt + i] = 1;
      lane_record[lanes * friction + i] = -1;
    }
    contact += n, left -= n;
    lane_pair += 2 * lanes, lane_record += lane_length * lanes, lane_impulse += 2 * lanes;
  }
}

// What errors need of contacts one after the other, four at a time: relative velocities, impulses with cohesion, then friction,
// the block and the kind of law.
extern "C" void sg_gather_arms(int n, const int *pair, const double *record, const double *impulse, const double *body, double *u_n,
                               double *u_t, double *r_n, double *r_t, double *mu, double *nn, double *nt, double *tt, double *kind) {
  for (int first = 0; first < n; first += width, pair += 2 * width, impulse += 2 * width) {
    ask(record + static_cast<long>(record_length) * (first + before_turn), width * record_length);
    vec v[record_length];
    for (int place = 0; place < record_length; place += width) {
      for (int i = 0; i < width; ++i) v[place + i] = load(record + static_cast<long>(record_length) * (first + i) + place);
      transpose(v[place], v[place + 1], v[place + 2], v[place + 3]);
    }
    bodies c, a;
    const int candidates[width] = {pair[0], pair[2], pair[4], pair[6]}, antagonists[width] = {pair[1], pair[3], pair[5], pair[7]};
    c.fetch(candidates, body);
    a.fetch(antagonists, body);
    const vec one = load(impulse), other = load(impulse + width), none = {};
    const vec n_part = __builtin_shufflevector(one, other, 0, 2, 4, 6), t_part = __builtin_shufflevector(one, other, 1, 3, 5, 7);
    const vec x = v[normal_x], y = v[normal_y], dx = c.x - a.x, dy = c.y - a.y;
    store(x * dx + y * dy + v[moment_nc] * c.turn - v[moment_na] * a.turn + v[bias_n] + v[compliance_n] * n_part, u_n + first);
    store(y * dx - x * dy + v[moment_tc] * c.turn - v[moment_ta] * a.turn + v[bias_t] + v[compliance_t] * t_part, u_t + first);
    store(n_part + (v[law] > 0.5 ? v[cohesion] : none), r_n + first);
    store(t_part, r_t + first);
    store(v[friction], mu + first);
    store(v[w_nn], nn + first);
    store(v[w_nt], nt + first);
    store(v[w_tt], tt + first);
    store(v[law], kind + first);
  }
}
