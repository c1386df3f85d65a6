// What sweeps over groups of contacts load and store by vectors of four: places of records in lanes.
#pragma once

#include "../../problem/vectors/bodies_of_four.hpp"

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

// Contacts of a group; the last one once more for each lane to spare.
struct members {
  int contact[lanes];

  members(const int *from, int n) {
    for (int i = 0; i < lanes; ++i) contact[i] = from[i < n ? i : n - 1];
  }
};

// Let lanes to spare, from one on, change nothing: the pair of the first lane, no impulse, and a record of zeros.
template <int components, int length>
inline void clear_lanes(int from, int *lane_pair, double *lane_record, double *lane_impulse) {
  for (int i = from; i < lanes; ++i) {
    for (int side = 0; side < 2; ++side) lane_pair[lanes * side + i] = lane_pair[lanes * side];
    for (int c = 0; c < components; ++c) lane_impulse[lanes * c + i] = 0;
    for (int c = 0; c < length; ++c) lane_record[lanes * c + i] = 0;
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
}    // namespace
