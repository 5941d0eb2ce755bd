// SPDX-License-Identifier: MIT
// Loaded before a program. It makes one call to the C library fail after main() has started.
//   FAULTS_CALL  a family of calls: malloc, large (malloc of 64 KiB or more; all later ones fail too),
//                open, write, fsync, rename, truncate or thread
//   FAULTS_AT    number of the failing call, from 1; 0: no failure, calls are counted and listed
//   FAULTS_LOG   a file for lines "FAMILY NUMBER OWNER SITE" of the failing call, or of the first call of
//                every site, and at the end "FAMILY total NUMBER"; the failing call is followed by its
//                stack, a line per frame
// OWNER is the library that made the call, ignoring the C and C++ runtime libraries. SITE identifies the
// position in the program. Children of the program are not affected.
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <initializer_list>
#include <sys/uio.h>
#include <unistd.h>

extern "C" {
// glibc's internal allocator; dlsym() would allocate.
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}

namespace {

constexpr std::size_t least_large = 64 << 10;
constexpr int most_frames = 48;
constexpr std::size_t most_sites = 1 << 16, most_stacks = 1 << 18;

char family[16];
long at = 0;
bool keeps_failing = false; ///< later calls fail as well
int log_file = -1;
std::atomic<bool> armed{false};
std::atomic<long> calls{0};
std::atomic<std::uint64_t> sites[most_sites], stacks[most_stacks];
thread_local bool inside = false;

template<class Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

const char* last_part(const char* path) {
    const char* slash = std::strrchr(path, '/');
    return slash == nullptr ? path : slash + 1;
}

bool is_runtime_library(const char* library) {
    for (const char* name :
         {"libc.so", "libstdc++.so", "libgcc_s.so", "ld-linux", "libtandem_faults.so", "libm.so"})
        if (std::strncmp(library, name, std::strlen(name)) == 0) return true;
    return false;
}

struct CallSite {
    char owner[64] = "?";
    std::uint64_t site = 0;
};

std::uint64_t mixed(std::uint64_t hash, std::uint64_t value) { return (hash ^ value) * 0x9E3779B97F4A7C15u; }

std::uint64_t hash_of(void* const* frames, int count) {
    std::uint64_t hash = 0;
    for (int i = 0; i < count; ++i) hash = mixed(hash, reinterpret_cast<std::uintptr_t>(frames[i]));
    return hash;
}

/// The calling library, and a hash of the first three return addresses in its code.
CallSite call_site(void* const* frames, int count) {
    CallSite found;
    const void* base = nullptr;
    int taken = 0;
    for (int i = 0; i < count && taken < 3; ++i) {
        Dl_info info{};
        if (dladdr(frames[i], &info) == 0 || info.dli_fname == nullptr) continue;
        const char* library = last_part(info.dli_fname);
        if (base == nullptr) {
            if (is_runtime_library(library)) continue;
            base = info.dli_fbase;
            std::snprintf(found.owner, sizeof found.owner, "%s", library);
        }
        if (info.dli_fbase != base) continue;
        const auto offset =
            static_cast<std::uint64_t>(static_cast<char*>(frames[i]) - static_cast<char*>(info.dli_fbase));
        found.site = mixed(found.site, offset);
        ++taken;
    }
    return found;
}

void log_line(const char* text, int length) {
    if (log_file >= 0) syscall(SYS_write, log_file, text, length);
}

void log_call(long number, const CallSite& caller) {
    char line[160];
    log_line(line, std::snprintf(line, sizeof line, "%s %ld %s %llx\n", family, number, caller.owner,
                                 static_cast<unsigned long long>(caller.site)));
}

/// Stack of the failing call, for debugging.
void log_stack() {
    void* frames[most_frames];
    if (log_file >= 0) backtrace_symbols_fd(frames, backtrace(frames, most_frames), log_file);
}

/// Whether the table has not had this hash; `when_full` where it cannot tell.
template<std::size_t size>
bool is_new(std::atomic<std::uint64_t> (&table)[size], std::uint64_t hash, bool when_full) {
    const auto key = hash | 1; // 0 marks a free slot
    for (std::size_t i = (key >> 8) % size, tried = 0; tried < size; ++tried, i = (i + 1) % size) {
        std::uint64_t expected = 0;
        if (table[i].compare_exchange_strong(expected, key)) return true;
        if (expected == key) return false;
    }
    return when_full;
}

/// Whether this call is the failing one.
bool fails(const char* name) {
    if (!armed.load(std::memory_order_relaxed) || inside || std::strcmp(name, family) != 0) return false;
    const long number = ++calls;
    if (at != 0 && number > at && keeps_failing) return true;
    if (at != 0 && number != at) return false;
    inside = true;
    void* frames[most_frames];
    const int count = backtrace(frames, most_frames);
    // Equal stacks have one site, and dladdr() takes most of the time.
    if (at != 0 || is_new(stacks, hash_of(frames, count), true)) {
        const auto caller = call_site(frames, count);
        if (at != 0 || is_new(sites, caller.site, false)) log_call(number, caller);
    }
    if (at != 0) log_stack();
    inside = false;
    return at != 0;
}

bool has_none(std::size_t bytes) { return fails("malloc") || (bytes >= least_large && fails("large")); }

using Main = int (*)(int, char**, char**);
Main program = nullptr;

int counted_main(int argc, char** argv, char** environment) {
    armed = family[0] != 0;
    const int status = program(argc, argv, environment);
    armed = false;
    return status;
}

void log_total() {
    char line[64];
    log_line(line, std::snprintf(line, sizeof line, "%s total %ld\n", family, calls.load()));
}

} // namespace

extern "C" {

int __libc_start_main(Main main, int argc, char** argv, void (*init)(), void (*fini)(), void (*rtld_fini)(),
                      void* stack_end) {
    program = main;
    if (const char* name = std::getenv("FAULTS_CALL")) std::snprintf(family, sizeof family, "%s", name);
    keeps_failing = std::strcmp(family, "large") == 0;
    if (const char* number = std::getenv("FAULTS_AT")) at = std::atol(number);
    if (const char* path = std::getenv("FAULTS_LOG"))
        log_file = static_cast<int>(
            syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
    for (const char* name : {"LD_PRELOAD", "FAULTS_CALL", "FAULTS_AT", "FAULTS_LOG"}) unsetenv(name);
    void* frames[4];
    backtrace(frames, 4); // loads the unwinder
    std::atexit(log_total);
    using Start = int(Main, int, char**, void (*)(), void (*)(), void (*)(), void*);
    return next<Start>("__libc_start_main")(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}

void* malloc(std::size_t bytes) {
    if (has_none(bytes)) return errno = ENOMEM, nullptr;
    return __libc_malloc(bytes);
}
void* calloc(std::size_t count, std::size_t bytes) {
    if (has_none(count * bytes)) return errno = ENOMEM, nullptr;
    return __libc_calloc(count, bytes);
}
void* realloc(void* old, std::size_t bytes) {
    if (has_none(bytes)) return errno = ENOMEM, nullptr;
    return __libc_realloc(old, bytes);
}
void* memalign(std::size_t alignment, std::size_t bytes) {
    if (has_none(bytes)) return errno = ENOMEM, nullptr;
    return __libc_memalign(alignment, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) { return memalign(alignment, bytes); }
int posix_memalign(void** out, std::size_t alignment, std::size_t bytes) {
    void* const made = memalign(alignment, bytes);
    if (made == nullptr) return ENOMEM;
    *out = made;
    return 0;
}

#define TANDEM_FAULT(result, family, name, parameters, arguments, code)                                      \
    result name parameters {                                                                                 \
        if (fails(family)) return errno = code, static_cast<result>(-1);                                     \
        static auto* const real = next<result parameters>(#name);                                            \
        return real arguments;                                                                               \
    }
TANDEM_FAULT(ssize_t, "write", write, (int file, const void* data, std::size_t bytes), (file, data, bytes),
             ENOSPC)
TANDEM_FAULT(ssize_t, "write", writev, (int file, const struct iovec* parts, int count), (file, parts, count),
             ENOSPC)
TANDEM_FAULT(int, "fsync", fsync, (int file), (file), EIO)
TANDEM_FAULT(int, "fsync", fdatasync, (int file), (file), EIO)
TANDEM_FAULT(int, "rename", rename, (const char* from, const char* to), (from, to), EIO)
TANDEM_FAULT(int, "truncate", ftruncate, (int file, off_t bytes), (file, bytes), EIO)
#undef TANDEM_FAULT

#define TANDEM_OPEN(name)                                                                                    \
    int name(const char* path, int flags, ...) {                                                             \
        if (fails("open")) return errno = EMFILE, -1;                                                        \
        va_list more;                                                                                        \
        va_start(more, flags);                                                                               \
        const auto mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : mode_t{0};           \
        va_end(more);                                                                                        \
        static auto* const real = next<int(const char*, int, ...)>(#name);                                   \
        return real(path, flags, mode);                                                                      \
    }
TANDEM_OPEN(open)
TANDEM_OPEN(open64)
#undef TANDEM_OPEN

#define TANDEM_FOPEN(name)                                                                                   \
    FILE* name(const char* path, const char* mode) {                                                         \
        if (fails("open")) return errno = EMFILE, nullptr;                                                   \
        static auto* const real = next<FILE*(const char*, const char*)>(#name);                              \
        return real(path, mode);                                                                             \
    }
TANDEM_FOPEN(fopen)
TANDEM_FOPEN(fopen64)
#undef TANDEM_FOPEN

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*entry)(void*),
                   void* argument) {
    if (fails("thread")) return EAGAIN;
    static auto* const real =
        next<int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*)>("pthread_create");
    return real(thread, attributes, entry, argument);
}

} // extern "C"
