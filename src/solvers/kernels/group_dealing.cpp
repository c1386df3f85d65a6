// Contacts of a block dealt to groups in which no movable body appears twice (interface: group_dealing.f90). Bits of the groups of
// each body, and of the full groups, are held in registers, which gfortran spills.

#include <cstdint>

namespace {
constexpr int most_groups = 63;    // the last of these takes what no other one has room for
}

// Each contact goes to the first group that has room and neither of its movable bodies; contacts and slots count from one. Contacts
// of each group are counted; `top` is the last one with some.
extern "C" void sg_deal_block(int n, const int *chosen, int length, int inverse, int width, const int *pair, const double *body,
                             std::int64_t *groups_of, int *group, int *filled, int *top) {
  typedef std::uint64_t bits;
  bits *const of = reinterpret_cast<bits *>(groups_of) - 1;
  const double *const inverses = body + inverse - 1 - length;
  // Most bodies can move along x: the others are looked at whole.
  const auto moves = [=](long slot) {
    const double *from = inverses + length * slot;
    for (int i = 0; i <= length - inverse; ++i)
      if (from[i] > 0) return true;
    return false;
  };
  bits full = 0, used = 1;
  for (int g = 0; g <= most_groups; ++g) filled[g] = 0;
  for (int i = 0; i < n; ++i) {
    const int *const own = pair + 2L * (chosen[i] - 1);
    const long c = own[0], a = own[1];
    const bits last = bits{1} << most_groups, open = ~(full | of[c] | of[a]) | last, bit = open & (~open + 1);
    const int g = __builtin_ctzll(open);
    group[i] = g;
    used |= bit;
    const bool is_full = ++filled[g] == width;
    if (bit == last) continue;
    if (is_full) full |= bit;
    if (moves(c)) of[c] |= bit;
    if (moves(a)) of[a] |= bit;
  }
  for (int i = 0; i < n; ++i) {
    const int *const own = pair + 2L * (chosen[i] - 1);
    of[own[0]] = 0, of[own[1]] = 0;
  }
  *top = most_groups - __builtin_clzll(used);
}
