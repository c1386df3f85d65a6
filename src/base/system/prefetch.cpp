// Asks the processor to fetch numbers that are read soon; it changes no value (interface: prefetch.f90).

extern "C" void sg_prefetch_ahead(const double *first, int ahead, int reals) {
#ifdef __GNUC__
  constexpr int line = 8;    // reals of a cache line
  for (int i = 0; i < reals; i += line) __builtin_prefetch(first + ahead + i);
#else
  (void)first, (void)ahead, (void)reals;
#endif
}
