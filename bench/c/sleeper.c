/* A bare periodic loop: how late the kernel itself wakes a sleeper. Prints, for every half second, p50, p99 and
   largest lateness in microseconds, ticks run and ticks missed.  sleeper RATE_HZ SECONDS PRIORITY (0: ordinary) */
#define _GNU_SOURCE
#include <sched.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>

static int64_t now_ns(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec * 1000000000LL + t.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv) {
    if (argc != 4) return 2;
    int64_t period = 1000000000LL / atoll(argv[1]);
    int64_t ends = now_ns() + atoll(argv[2]) * 1000000000LL;
    struct sched_param parameters = {.sched_priority = atoi(argv[3])};
    if (parameters.sched_priority && sched_setscheduler(0, SCHED_FIFO, &parameters)) return 3;
    mlockall(MCL_CURRENT | MCL_FUTURE);
    int64_t window = 500000000LL / period, late[window], deadline = now_ns();
    while (deadline < ends) {
        int64_t count = 0, missed = 0;
        while (count + missed < window) {
            deadline += period;
            int64_t behind = now_ns() - deadline;
            if (behind > period) {
                missed += behind / period;
                deadline += behind / period * period;
            }
            struct timespec until = {deadline / 1000000000LL, deadline % 1000000000LL};
            clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
            if (count < window) late[count++] = now_ns() - deadline;
        }
        qsort(late, count, sizeof late[0], ascending);
        printf("%.1f %.1f %.1f %lld %lld\n", late[count / 2] / 1e3, late[count * 99 / 100] / 1e3,
               late[count - 1] / 1e3, (long long)count, (long long)missed);
        fflush(stdout);
    }
    return 0;
}
