/* Preloaded into LinuxCNC's real-time process: its monotonic clock runs PEER_WARP times as fast as the wall clock. Its threads then run that much faster,
   while every cycle computes the same as before. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <time.h>

typedef long long nanoseconds;
static int (*real_gettime)(clockid_t, struct timespec *);
static int (*real_nanosleep)(clockid_t, int, const struct timespec *, struct timespec *);
static nanoseconds origin;
static int warp;

static nanoseconds from_timespec(const struct timespec *t) { return t->tv_sec * 1000000000LL + t->tv_nsec; }
static void to_timespec(nanoseconds n, struct timespec *t) {
  t->tv_sec = n / 1000000000LL;
  t->tv_nsec = n % 1000000000LL;
}
static void begin(void) {
  if (origin) return;
  const char *setting = getenv("PEER_WARP");
  warp = setting ? atoi(setting) : 1;
  if (warp < 1) warp = 1;
  real_gettime = dlsym(RTLD_NEXT, "clock_gettime");
  real_nanosleep = dlsym(RTLD_NEXT, "clock_nanosleep");
  struct timespec now;
  real_gettime(CLOCK_MONOTONIC, &now);
  origin = from_timespec(&now);
}

int clock_gettime(clockid_t id, struct timespec *t) {
  begin();
  const int result = real_gettime(id, t);
  if (result == 0 && id == CLOCK_MONOTONIC) to_timespec(origin + (from_timespec(t) - origin) * warp, t);
  return result;
}

int clock_nanosleep(clockid_t id, int flags, const struct timespec *request, struct timespec *remain) {
  begin();
  if (id != CLOCK_MONOTONIC) return real_nanosleep(id, flags, request, remain);
  struct timespec scaled;
  if (flags & TIMER_ABSTIME) {
    to_timespec(origin + (from_timespec(request) - origin) / warp, &scaled);
  } else {
    to_timespec(from_timespec(request) / warp, &scaled);
  }
  return real_nanosleep(id, flags, &scaled, remain);
}
