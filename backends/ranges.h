// SPDX-License-Identifier: MIT
// Named ranges of a thread's time for a profiler's timeline. They use NVTX when the build finds its header;
// otherwise they do nothing. Without a profiler a call only tests a pointer.
#pragma once

namespace tandem::ranges {

/// Whether this build has NVTX.
bool available();

/// Begins a range on this thread; `name` ends with a zero and is copied. Never throws.
void push(const char* name);
/// Ends the innermost range of this thread.
void pop();

/// A range for the lifetime of the object.
class ProfilerRange {
public:
    explicit ProfilerRange(const char* name) { push(name); }
    ~ProfilerRange() { pop(); }
    ProfilerRange(const ProfilerRange&) = delete;
    ProfilerRange& operator=(const ProfilerRange&) = delete;
};

} // namespace tandem::ranges
