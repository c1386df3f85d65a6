// Files whose names match a pattern, which Fortran cannot list.
#include <algorithm>
#include <glob.h>
#include <string>
#include <vector>

// Names of the files that match a pattern, in ascending order of their bytes, each ended by a zero; returns their length in
// bytes with these zeros. Names are written where `length` bytes hold them all, else nothing is.
extern "C" long splitgrain_list_files(const char *pattern, long length, char *names)
{
  std::vector<std::string> found;
  glob_t matches;

  if (glob(pattern, GLOB_MARK, nullptr, &matches) == 0) {
    for (size_t i = 0; i < matches.gl_pathc; i++) {
      const std::string name = matches.gl_pathv[i];
      if (name.back() != '/') found.push_back(name);
    }
  }
  globfree(&matches);
  std::sort(found.begin(), found.end());
  long needed = 0;
  for (const auto &name : found) needed += static_cast<long>(name.size()) + 1;
  if (needed > length) return needed;
  for (const auto &name : found) names = std::copy(name.c_str(), name.c_str() + name.size() + 1, names);
  return needed;
}
