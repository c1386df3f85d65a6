// Decimal digits of a real, which formatted output of Fortran takes twenty times as many instructions to find.
#include <charconv>

// Writes a finite number with so many decimals, as in 1.25e+00: the nearest decimal number, as Fortran does. `written` is how many
// letters it took, or 0 where `length` do not hold them all.
extern "C" void splitgrain_write_real(double value, int decimals, int length, char *letters, int *written)
{
  const auto end = std::to_chars(letters, letters + length, value, std::chars_format::scientific, decimals);
  *written = end.ec == std::errc() ? static_cast<int>(end.ptr - letters) : 0;
}
