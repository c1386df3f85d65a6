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

// Impulses and records of a row of eight solid contacts (row_length of sg_sweep_solid_order).
extern "C" void sg_prefetch_row(const double *row) { fetch(row, 22 * 8); }
