// Permissions of files, which Fortran cannot ask for: the record that `stat` fills differs from system to system.
#include <sys/stat.h>

// Give a file the permissions of another one, where there is that other one; not zero when they cannot be given.
extern "C" int splitgrain_take_mode(const char *from, const char *to)
{
  struct stat old_file, new_file;

  if (stat(from, &old_file) != 0) return 0;
  if (stat(to, &new_file) != 0) return -1;
  // Some file systems have one mode for all files, and refuse any change.
  if (((old_file.st_mode ^ new_file.st_mode) & 0777) == 0) return 0;
  return chmod(to, old_file.st_mode & 0777);
}
