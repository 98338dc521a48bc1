// SPDX-License-Identifier: GPL-3.0-or-later
// Preloaded into the worker and its solver: the n-th change of the disk below a folder fails. Counted over all processes.
//   FORMWRIGHT_FAULT_FOLDER   below which it counts, without a slash at its end
//   FORMWRIGHT_FAULT_COUNTER  a file of eight zero bytes, elsewhere: how many there were
//   FORMWRIGHT_FAULT_AT       n, from 1
//   FORMWRIGHT_FAULT_ERROR    the number of the error (28 ENOSPC, 5 EIO)
//   FORMWRIGHT_FAULT_STAYS    1: all after the n-th fail, too
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

static _Atomic unsigned long* counter;
static const char* folder;
static unsigned long fault_at;
static int fault_error, fault_stays;

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

__attribute__((constructor)) static void begin(void) {
  const char* at = getenv("FORMWRIGHT_FAULT_AT");
  const char* error = getenv("FORMWRIGHT_FAULT_ERROR");
  const char* stays = getenv("FORMWRIGHT_FAULT_STAYS");
  const char* path = getenv("FORMWRIGHT_FAULT_COUNTER");
  if (!at || !path) return;
  const int descriptor = NEXT(open)(path, O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return;
  void* shared = mmap(NULL, sizeof *counter, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
  close(descriptor);
  if (shared == MAP_FAILED) return;
  fault_at = strtoul(at, NULL, 10);
  fault_error = error ? atoi(error) : ENOSPC;
  fault_stays = stays && *stays == '1';
  folder = getenv("FORMWRIGHT_FAULT_FOLDER");
  counter = shared;
}

static int below_folder(const char* path) {
  const size_t length = folder ? strlen(folder) : 0;
  return length > 0 && strncmp(path, folder, length) == 0 && (path[length] == '/' || path[length] == '\0');
}

// Whether this one is to fail; errno is set then.
static int fails(const char* path) {
  if (!counter || !below_folder(path)) return 0;
  const unsigned long number = atomic_fetch_add(counter, 1) + 1;
  if (number != fault_at && !(fault_stays && number > fault_at)) return 0;
  errno = fault_error;
  return 1;
}

static int descriptor_fails(int descriptor) {
  if (!counter) return 0;
  char link[64], path[PATH_MAX];
  const int kept = errno;
  snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  errno = kept;
  if (length <= 0) return 0;
  path[length] = '\0';
  return fails(path);
}

#define OPEN(name)                                     \
  int name(const char* path, int flags, ...) {         \
    mode_t mode = 0;                                   \
    if (flags & (O_CREAT | __O_TMPFILE)) {             \
      va_list rest;                                    \
      va_start(rest, flags);                           \
      mode = va_arg(rest, mode_t);                     \
      va_end(rest);                                    \
    }                                                  \
    if ((flags & O_CREAT) && fails(path)) return -1;   \
    return NEXT(name)(path, flags, mode);              \
  }
OPEN(open)
OPEN(open64)

ssize_t write(int descriptor, const void* bytes, size_t count) {
  return descriptor_fails(descriptor) ? -1 : NEXT(write)(descriptor, bytes, count);
}
ssize_t writev(int descriptor, const struct iovec* parts, int count) {
  return descriptor_fails(descriptor) ? -1 : NEXT(writev)(descriptor, parts, count);
}
int fsync(int descriptor) { return descriptor_fails(descriptor) ? -1 : NEXT(fsync)(descriptor); }
int fdatasync(int descriptor) { return descriptor_fails(descriptor) ? -1 : NEXT(fdatasync)(descriptor); }
int rename(const char* from, const char* to) { return fails(to) ? -1 : NEXT(rename)(from, to); }
int mkdir(const char* path, mode_t mode) { return fails(path) ? -1 : NEXT(mkdir)(path, mode); }
int link(const char* from, const char* to) { return fails(to) ? -1 : NEXT(link)(from, to); }
