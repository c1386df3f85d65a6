/* Room on the disk for a file that many processes are going to write: taken beforehand, so that none of them finds the
   disk full alone. Where a file system or an operating system cannot promise room, none is taken. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Take room for the first `bytes` bytes of a file, which keeps its size; a new one is made, or an old one emptied. When
   that fails the answer is not zero, and the reason stands in `why`, of `length` characters. */
int splitgrain_reserve(const char *path, int64_t bytes, int is_new, char *why, int length)
{
  int status = 0;
  int file = open(path, is_new ? O_RDWR | O_CREAT | O_TRUNC : O_RDWR, 0666);

  if (file < 0) {
    status = errno;
  } else {
#ifdef FALLOC_FL_KEEP_SIZE
    if (fallocate(file, FALLOC_FL_KEEP_SIZE, 0, (off_t)bytes) != 0 && (errno == ENOSPC || errno == EDQUOT || errno == EFBIG))
      status = errno;
#endif
    close(file);
  }
  if (status != 0) {
    strncpy(why, strerror(status), (size_t)length - 1);
    why[length - 1] = '\0';
  }
  return status;
}

/* Give back the room beyond the end of a file, which it would keep otherwise. */
void splitgrain_release(const char *path)
{
  struct stat file;

  if (stat(path, &file) == 0 && truncate(path, file.st_size) != 0)
    return;
}
