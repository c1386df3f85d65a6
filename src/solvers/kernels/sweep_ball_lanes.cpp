// Gauss-Seidel sweep over contacts of balls with Coulomb friction, eight side by side (interface: sweep_ball_lanes.f90). The local
// problem is that of sweep_ball.f90, without its branches: sticking, sliding and open contacts take the same time.

#include <limits>

#include "lanes.hpp"

namespace {
constexpr int ahead = 6, bodies_ahead = 3;    // groups by which records, and bodies, are asked for before their turn
using namespace ball_lane;

inline bool any_negative(const vec &v) { return v[0] < 0 || v[1] < 0 || v[2] < 0 || v[3] < 0; }

// Change of the impulses of four contacts, and what changes spins by them.
struct change {
  vec px, py, pz, sx, sy, sz;

  void find(const double *record, double relaxation, const space_bodies &c, const space_bodies &a, double *impulse) {
    const auto at = [record](int place) { return load(record + lanes * place); };
    const vec x = at(normal_x), y = at(normal_y), z = at(normal_z), none = {};
    const vec wx = c.sx + a.sx, wy = c.sy + a.sy, wz = c.sz + a.sz;
    const vec ux = c.x - a.x + at(bias_x) - wy * z + wz * y, uy = c.y - a.y + at(bias_y) - wz * x + wx * z;
    const vec uz = c.z - a.z + at(bias_z) - wx * y + wy * x;
    const vec rx = load(impulse), ry = load(impulse + lanes), rz = load(impulse + 2 * lanes), per_t = at(inverse_wtt);
    const vec u_n = x * ux + y * uy + z * uz, p_n = x * rx + y * ry + z * rz;
    const vec r_n = larger(p_n - u_n * at(inverse_wnn), none), along = p_n - u_n * per_t;
    const vec tx = rx - ux * per_t - along * x, ty = ry - uy * per_t - along * y, tz = rz - uz * per_t - along * z;
    const vec square = larger(tx * tx + ty * ty + tz * tz, none + std::numeric_limits<double>::min());
    const vec share = smaller(at(friction) * r_n / root(square), none + 1.0);
    px = relaxation * (r_n * x + share * tx - rx);
    py = relaxation * (r_n * y + share * ty - ry);
    pz = relaxation * (r_n * z + share * tz - rz);
    store(rx + px, impulse);
    store(ry + py, impulse + lanes);
    store(rz + pz, impulse + 2 * lanes);
    sx = py * z - pz * y, sy = pz * x - px * z, sz = px * y - py * x;
  }

  // Let both bodies feel it.
  void push_both(space_bodies &c, space_bodies &a) const {
    if (any_negative(smaller(c.per_i, a.per_i))) {
      push_driven(1, c);
      push_driven(-1, a);
    } else {
      push(1, c);
      push(-1, a);
    }
  }

  // The sign is that of their impulses, spins of both change alike.
  void push(double sign, space_bodies &b) const {
    const vec m = sign * b.per_m;
    b.x += m * px, b.y += m * py, b.z += m * pz;
    b.sx += b.per_i * sx, b.sy += b.per_i * sy, b.sz += b.per_i * sz;
  }

  // The same for bodies that may be driven in part, one by one: marks of free directions stand in place of the inverse inertia.
  void push_driven(double sign, space_bodies &b) const {
    for (int i = 0; i < width; ++i) {
      const int bits = b.per_i[i] < 0 ? static_cast<int>(0.5 - b.per_i[i]) : 7;
      const double m = sign * b.per_m[i], turning = b.per_i[i] > 0 ? b.per_i[i] : 0.0;
      if (bits & 1) b.x[i] += m * px[i];
      if (bits & 2) b.y[i] += m * py[i];
      if (bits & 4) b.z[i] += m * pz[i];
      b.sx[i] += turning * sx[i], b.sy[i] += turning * sy[i], b.sz[i] += turning * sz[i];
    }
  }
};

}    // namespace

extern "C" void sg_sweep_ball_groups(int n_groups, const int *pair, const double *record, double relaxation, double *impulse,
                                    double *body) {
  for (int g = 0; g < n_groups; ++g, pair += 2 * lanes, record += lanes * lane_length, impulse += 3 * lanes) {
    ask(record + ahead * lanes * lane_length, lanes * lane_length);
    ask(impulse + ahead * 3 * lanes, 3 * lanes);
    if (g + bodies_ahead < n_groups)
      for (int i = 0; i < 2 * lanes; ++i) __builtin_prefetch(space_bodies::record(pair[bodies_ahead * 2 * lanes + i], body), 1);
    space_bodies candidate[halves], antagonist[halves];
    for (int h = 0; h < halves; ++h) candidate[h].fetch(pair + width * h, body);
    for (int h = 0; h < halves; ++h) antagonist[h].fetch(pair + lanes + width * h, body);
    for (int h = 0; h < halves; ++h) {
      change by;
      by.find(record + width * h, relaxation, candidate[h], antagonist[h], impulse + width * h);
      by.push_both(candidate[h], antagonist[h]);
    }
    for (int h = halves - 1; h >= 0; --h) candidate[h].put_back(pair + width * h, body);
    for (int h = halves - 1; h >= 0; --h) antagonist[h].put_back(pair + lanes + width * h, body);
  }
}

// Put contacts side by side, group by group; contacts count from one, and so many are left in their list.
extern "C" void sg_put_ball_groups(int n_groups, const int *group_size, int left, const int *contact, const int *pair,
                                  const double *record, const double *impulse, int *lane_pair, double *lane_record,
                                  double *lane_impulse) {
  for (int g = 0; g < n_groups; ++g) {
    const int n = group_size[g];
    const members own(contact, n);
    ask_records<lane_length>(contact, left, record);
    for (int h = 0; h < halves; ++h) {
      const int *const four = own.contact + width * h;
      double *const lane = lane_record + width * h;
      const double *row[width];
      for (int i = 0; i < width; ++i) row[i] = record + static_cast<long>(lane_length) * (four[i] - 1);
      for (int place = 0; place < friction; place += width) {
        vec v[width];
        for (int i = 0; i < width; ++i) v[i] = load(row[i] + place);
        transpose(v[0], v[1], v[2], v[3]);
        for (int i = 0; i < width; ++i) store(v[i], lane + lanes * (place + i));
      }
      for (int i = 0; i < width; ++i) lane[lanes * friction + i] = row[i][friction];
      put_pairs<3>(four, pair, impulse, lane_pair + width * h, lane_impulse + width * h);
    }
    clear_lanes<3, lane_length>(n, lane_pair, lane_record, lane_impulse);
    contact += n, left -= n;
    lane_pair += 2 * lanes, lane_record += lane_length * lanes, lane_impulse += 3 * lanes;
  }
}
