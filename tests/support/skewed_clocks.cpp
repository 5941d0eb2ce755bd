// SPDX-License-Identifier: MIT
// For LD_PRELOAD: the steady clock runs at SKEW_PERCENT of its pace. Without this variable that of each rank
// has its own pace, and reading it sometimes sleeps: ranks that decide by their own clocks then reach
// different decisions.
#include <cstdlib>
#include <ctime>
#include <dlfcn.h>
#include <random>
#include <unistd.h>

namespace {

int number_of(const char* variable) {
    const char* text = std::getenv(variable);
    return text == nullptr ? 0 : std::atoi(text);
}

} // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* time) {
    using Original = int (*)(clockid_t, timespec*);
    static const auto original = reinterpret_cast<Original>(dlsym(RTLD_NEXT, "clock_gettime"));
    static const int rank = number_of("OMPI_COMM_WORLD_RANK");
    static const int percent = number_of("SKEW_PERCENT");
    static thread_local std::minstd_rand random(
        static_cast<unsigned>(1 + 31 * rank + number_of("SKEW_SEED")));
    const int result = original(clock, time);
    if (clock != CLOCK_MONOTONIC || result != 0) return result;
    const long long ns = time->tv_sec * 1'000'000'000LL + time->tv_nsec;
    const long long skewed = ns / 100 * (percent != 0 ? percent : 100 + 50 * rank);
    time->tv_sec = skewed / 1'000'000'000;
    time->tv_nsec = skewed % 1'000'000'000;
    if (percent == 0 && random() % 200 == 0) usleep(static_cast<useconds_t>(random() % 2000));
    return result;
}
