// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded into the worker and its solver: a disk that takes its time to say that it has something.
//   FORMWRIGHT_SLOW_FOLDER   below which it is slow, without a slash at its end
//   FORMWRIGHT_SLOW_SECONDS  how much longer each fsync and fdatasync takes
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static void wait_for(int descriptor) {
  const char* folder = getenv("FORMWRIGHT_SLOW_FOLDER");
  const char* seconds = getenv("FORMWRIGHT_SLOW_SECONDS");
  if (!folder || !seconds) return;
  char link[64], path[PATH_MAX];
  const int kept = errno;
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  errno = kept;
  if (length <= 0) return;
  path[length] = '\0';
  const size_t start = strlen(folder);
  if (strncmp(path, folder, start) != 0 || (path[start] != '/' && path[start] != '\0')) return;
  const double s = atof(seconds);
  struct timespec left = {(time_t)s, (long)((s - (double)(time_t)s) * 1e9)};
  while (nanosleep(&left, &left) != 0 && errno == EINTR) {
  }
  errno = kept;
}

int fsync(int descriptor) {
  wait_for(descriptor);
  return NEXT(fsync)(descriptor);
}
int fdatasync(int descriptor) {
  wait_for(descriptor);
  return NEXT(fdatasync)(descriptor);
}
