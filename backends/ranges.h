// SPDX-License-Identifier: MIT
// Named stretches of a thread's time for a profiler's timeline: NVTX where the build has found its header,
// nothing elsewhere. Without a profiler a call is a test of a pointer.
#pragma once

namespace tandem::ranges {

/// Whether this build has NVTX.
bool available();

/// Begins a range on this thread; `name` is copied, and ends with a zero. Never throws.
void push(const char* name);
/// Ends the range of this thread that was begun last.
void pop();

/// A range as long as it lives.
class ProfilerRange {
public:
    explicit ProfilerRange(const char* name) { push(name); }
    ~ProfilerRange() { pop(); }
    ProfilerRange(const ProfilerRange&) = delete;
    ProfilerRange& operator=(const ProfilerRange&) = delete;
};

} // namespace tandem::ranges
