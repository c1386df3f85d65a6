// Asks the processor to fetch what a sweep over groups of contacts is about to read; it changes no value. Fortran has no word for
// this, and processors foresee neither which bodies come next nor, where a group fills their window, the records.

namespace {
constexpr long line = 64;    // bytes of a cache line

void fetch(const double *first, long reals) {
#ifdef __GNUC__
  const char *byte = reinterpret_cast<const char *>(first);
  for (long i = 0; i < 8 * reals; i += line) __builtin_prefetch(byte + i, 1);
  __builtin_prefetch(byte + 8 * reals - 1, 1);
#else
  (void)first, (void)reals;
#endif
}
}    // namespace

// Records and impulses of a group of eight, and the slots of its bodies.
extern "C" void sg_prefetch_group(const double *record, const double *impulse, const int *pair) {
  fetch(record, 9 * 8);
  fetch(impulse, 3 * 8);
  fetch(reinterpret_cast<const double *>(pair), 8);
}

// Records of the bodies of a group of eight; slots count from one.
extern "C" void sg_prefetch_bodies(const int *pair, const double *body) {
  for (int i = 0; i < 16; ++i) fetch(body + 8L * (pair[i] - 1), 8);
}

// Impulses and records of a row of eight solid contacts (row_length of sg_sweep_solid_order).
extern "C" void sg_prefetch_row(const double *row) { fetch(row, 22 * 8); }
