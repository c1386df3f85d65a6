// Contacts of a block dealt to groups in which no movable body appears twice (interfaces: group_dealing.f90, and
// sweep_solid_order.f90 for chains). Bits of the groups of each body, and of the full groups, are held in registers, which gfortran
// spills.

#include <cstdint>

namespace {
typedef std::uint64_t bits;

constexpr int most_groups = 63;    // of single contacts, the last of these takes what no other one has room for
constexpr int lanes = 8, most_points = 4, block_chains = 256;    // chains of a group, contacts of a chain, chains of a block

// Bodies that impulses can move. Most bodies can move along x: the others are looked at whole.
struct movable {
  const double *inverses;
  int length, reals;

  movable(int length, int inverse, const double *body) : inverses(body + inverse - 1 - length), length(length),
                                                         reals(length - inverse + 1) {}
  bool operator()(long slot) const {
    const double *from = inverses + length * slot;
    for (int i = 0; i < reals; ++i)
      if (from[i] > 0) return true;
    return false;
  }
};

// Contacts of each group, digit by digit: a bit of a number for each group. So counting takes no memory and no branch.
struct counts_of_groups {
  bits ones = 0, twos = 0, fours = 0;

  // Count one more in a group below its width, which is four or eight; the group if that fills it.
  bits add(bits group, int width) {
    const bits by_two = ones & group, by_four = twos & by_two, by_eight = fours & by_four;
    ones ^= group, twos ^= by_two, fours ^= by_four;
    return width == 4 ? by_four : by_eight;
  }
  int of(int g) const { return (ones >> g & 1) + 2 * (twos >> g & 1) + 4 * (fours >> g & 1); }
};

// Chains of a block of contacts: where each begins, and the end of the last one; the same by length, long ones first.
struct chains {
  int n = 0, head[block_chains + 1], by_length[block_chains];

  chains(int contacts, const int *chosen, const int *pair) {
    int first = 0, of_length[most_points + 1] = {}, place[most_points + 1];
    for (; first < contacts && n < block_chains; ++n) {
      const int *const own = pair + 2L * (chosen[first] - 1);
      head[n] = first++;
      while (first < contacts && first < head[n] + most_points) {
        const int *const next = pair + 2L * (chosen[first] - 1);
        if (next[0] != own[0] || next[1] != own[1]) break;
        ++first;
      }
      ++of_length[first - head[n]];
    }
    head[n] = first;
    place[most_points] = 0;
    for (int length = most_points; length > 1; --length) place[length - 1] = place[length] + of_length[length];
    for (int c = 0; c < n; ++c) by_length[place[length(c)]++] = c;
  }
  int length(int c) const { return head[c + 1] - head[c]; }
};

// Rows that grow, and their contacts.
struct rows_of_groups {
  const int *chosen;
  int *contact, *n_groups, *n_rows, *last_row, *row_size;

  // Add the rows of a group; its longest chain is the first.
  void add(const chains &all, int n, const int *chain) {
    for (int point = 0; point < all.length(chain[0]); ++point) {
      int in_row = 0;
      for (; in_row < n && point < all.length(chain[in_row]); ++in_row) *contact++ = chosen[all.head[chain[in_row]] + point];
      row_size[(*n_rows)++] = in_row;
    }
    last_row[(*n_groups)++] = *n_rows;
  }
};
}    // namespace

// Each contact goes to the first group that has room and neither of its movable bodies; contacts and slots count from one. Contacts
// of each group are counted; `top` is the last one with some.
extern "C" void sg_deal_block(int n, const int *chosen, int length, int inverse, int width, const int *pair, const double *body,
                             std::int64_t *groups_of, int *group, int *filled, int *top) {
  bits *const of = reinterpret_cast<bits *>(groups_of) - 1;
  const movable moves(length, inverse, body);
  const bits last = bits{1} << most_groups;
  counts_of_groups counts;
  bits full = 0, used = 1;
  int in_last = 0;
  for (int i = 0; i < n; ++i) {
    const int *const own = pair + 2L * (chosen[i] - 1);
    const long c = own[0], a = own[1];
    const bits open = ~(full | of[c] | of[a]) | last, bit = open & (~open + 1);
    group[i] = __builtin_ctzll(open);
    used |= bit;
    if (bit == last) {
      ++in_last;
      continue;
    }
    full |= counts.add(bit, width);
    if (moves(c)) of[c] |= bit;
    if (moves(a)) of[a] |= bit;
  }
  *top = most_groups - __builtin_clzll(used);
  for (int g = 0; g <= *top; ++g) filled[g] = g == most_groups ? in_last : full >> g & 1 ? width : counts.of(g);
  for (int i = 0; i < n; ++i) {
    const int *const own = pair + 2L * (chosen[i] - 1);
    of[own[0]] = 0, of[own[1]] = 0;
  }
}

// Deal the first block of the chosen contacts to rows of new groups, chain by chain, long ones first, so that the rows of a group are
// filled from their beginning. A chain for which no group is left has one of its own, before the others. The contacts of the block
// are counted.
extern "C" void sg_deal_chains(int n, const int *chosen, int length, int inverse, const int *pair, const double *body,
                              std::int64_t *groups_of, int *contact, int *n_groups, int *n_rows, int *last_row, int *row_size,
                              int *done) {
  bits *const of = reinterpret_cast<bits *>(groups_of) - 1;
  const movable moves(length, inverse, body);
  const chains all(n, chosen, pair);
  rows_of_groups rows{chosen, contact, n_groups, n_rows, last_row, row_size};
  int chain[most_groups][lanes], filled[most_groups] = {};
  bits full = bits{1} << most_groups;
  for (int i = 0; i < all.n; ++i) {
    const int *const own = pair + 2L * (chosen[all.head[all.by_length[i]]] - 1);
    const long c = own[0], a = own[1];
    const bits open = ~(full | of[c] | of[a]), bit = open & (~open + 1);
    if (open == 0) {
      rows.add(all, 1, all.by_length + i);
      continue;
    }
    const int g = __builtin_ctzll(open);
    chain[g][filled[g]++] = all.by_length[i];
    if (filled[g] == lanes) full |= bit;
    if (moves(c)) of[c] |= bit;
    if (moves(a)) of[a] |= bit;
  }
  for (int g = 0; g < most_groups; ++g)
    if (filled[g] > 0) rows.add(all, filled[g], chain[g]);
  for (int c = 0; c < all.n; ++c) {
    const int *const own = pair + 2L * (chosen[all.head[c]] - 1);
    of[own[0]] = 0, of[own[1]] = 0;
  }
  *done += all.head[all.n];
}
