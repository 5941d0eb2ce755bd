// SPDX-License-Identifier: MIT
// A program that owns a CUDA context and stream, made with the driver API, and lets tandem find candidate
// pairs in them. tandem works on that stream, after the program's own commands, and does not change the
// thread's current context. Prints the number of pairs. Needs no toolkit, because it loads the entry points
// of the driver itself. With the stub of the driver, which runs no kernels, it checks the streams of the
// calls instead of the count.
#include "driver_calls.h"
#include "find_pairs.h"

#include <tandem/backends/cuda/cuda_device.h>

#include <cstddef>
#include <cstdio>
#include <vector>

namespace {

constexpr std::size_t bytes = std::size_t{1} << 20;

bool is_current(Handle context) {
    Handle current = nullptr;
    return call("cuCtxGetCurrent", &current) && current == context;
}

/// Whether tandem reads the application's memory only after the application's own command on the stream.
bool follows(tandem::Device& device, Handle context, Handle stream) {
    Handle before = nullptr;
    Pointer memory = 0;
    bool good = call("cuCtxGetCurrent", &before) && call("cuCtxSetCurrent", context)
                && call("cuMemAlloc_v2", &memory, bytes)
                && call("cuMemsetD8Async", memory, static_cast<unsigned char>(0x5a), bytes, stream)
                && call("cuCtxSetCurrent", before);
    if (!good) return false;
    std::vector<std::byte> back(bytes);
    const tandem::StageScope scope(device, tandem::Stage::read);
    device.download(device.adopt(reinterpret_cast<void*>(memory), bytes, "the application's"), back);
    for (const auto byte : back) good &= byte == std::byte{0x5a};
    return good & call("cuCtxSetCurrent", context) & call("cuMemFree_v2", memory)
           & call("cuCtxSetCurrent", before);
}

/// Runs all checks while `current` is the thread's current context; null: none is.
bool run(Handle context, Handle stream, Handle current) {
    if (!call("cuCtxSetCurrent", current)) return false;
    auto device = tandem::cuda::adopt(context, stream);
    bool good = check(is_current(current), "adopt() changed the current context");
    good &= check(follows(*device, context, stream), "tandem does not follow the application's commands");
    const auto count = candidate_pairs(*device);
    good &= check(is_current(current), "a session changed the current context");
    const bool stub = is_stub();
    good &= check(count > 0 || stub, "no pairs");
    std::printf("%llu candidate pairs%s\n", static_cast<unsigned long long>(count),
                stub ? " (no kernels ran)" : "");
    good &= check(device->bytes_allocated() == 0, "the session left memory behind");
    device.reset();
    return good & check(is_current(current), "the device's end changed the current context");
}

/// With the stub: whether all calls used the application's stream with its context current.
bool arrived(Handle context, Handle stream) {
    auto* const all = entry<unsigned long()>("stub_all_calls");
    if (all == nullptr) return true;
    const auto on_stream = entry<unsigned long(Handle, Handle)>("stub_calls")(stream, context);
    std::printf("%lu calls on a stream, %lu of them on the application's\n", all(), on_stream);
    return on_stream > 50 && on_stream == all();
}

} // namespace

int main() {
    Handle context = nullptr;
    Handle other = nullptr;
    Handle stream = nullptr;
    if (!check(library() != nullptr, "no driver (looked for libcuda.so.1)")) return 77;
    if (!call("cuInit", 0u) || !create(other) || !create(context) || !create_stream(context, stream))
        return 1;
    bool good = true;
    for (auto* current : {context, other, Handle{}}) good &= run(context, stream, current);
    good &= check(arrived(context, stream), "some calls were not on the application's stream");
    // Objects of the application must remain valid after the device that adopted them.
    good &= call("cuCtxSetCurrent", context) && call("cuStreamSynchronize", stream);
    good &= call("cuStreamDestroy_v2", stream) && call("cuCtxDestroy_v2", context)
            && call("cuCtxDestroy_v2", other);
    return good ? 0 : 1;
}
