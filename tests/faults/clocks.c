/* LD_PRELOAD: the wall clock and the clock that counts sleep go wrong by as much as a shared file says.

   The file (SHIFTED_CLOCKS) holds two int64 in ns: what is added to CLOCK_REALTIME, and to CLOCK_BOOTTIME. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static volatile int64_t *shifts;

__attribute__((constructor)) static void map_shifts(void) {
    const char *path = getenv("SHIFTED_CLOCKS");
    int file = path ? open(path, O_RDONLY | O_CLOEXEC) : -1;
    if (file < 0) return;
    void *mapped = mmap(NULL, 16, PROT_READ, MAP_SHARED, file, 0);
    close(file);
    if (mapped != MAP_FAILED) shifts = mapped;
}

int clock_gettime(clockid_t id, struct timespec *ts) {
    long failed = syscall(SYS_clock_gettime, id, ts);
    if (failed || !shifts || (id != CLOCK_REALTIME && id != CLOCK_BOOTTIME)) return (int)failed;
    int64_t ns = ts->tv_sec * INT64_C(1000000000) + ts->tv_nsec + shifts[id == CLOCK_BOOTTIME];
    ts->tv_sec = ns / 1000000000;
    ts->tv_nsec = ns % 1000000000;
    return 0;
}

int gettimeofday(struct timeval *restrict tv, void *restrict zone) {
    struct timespec ts;
    (void)zone;
    int failed = clock_gettime(CLOCK_REALTIME, &ts);
    tv->tv_sec = ts.tv_sec;
    tv->tv_usec = ts.tv_nsec / 1000;
    return failed;
}

time_t time(time_t *out) {
    struct timespec ts;
    clock_gettime(CLOCK_REALTIME, &ts);
    if (out) *out = ts.tv_sec;
    return ts.tv_sec;
}
