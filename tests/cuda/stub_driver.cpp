// SPDX-License-Identifier: MIT
// A libcuda.so.1 without a GPU: memory is the host's, and kernels do nothing. As in a driver, the current
// context is thread-local, calls without a context fail, and a stream works only with its own context.
// Variables select faults and attributes: STUB_INIT (code of cuInit), STUB_VERSION, STUB_MEMORY (bytes
// available), STUB_FAULT (launches fault), STUB_LAUNCH, STUB_INSTANTIATE and STUB_GRAPH (codes of
// cuLaunchKernel, of instantiating a graph and of launching one). STUB_UNKNOWN is an attribute that the
// device does not report. STUB_DEVICES is the number of devices (default 1); CUDA_VISIBLE_DEVICES selects
// some of them.
#include "backends/cuda/driver.h"
#include "tests/cuda/stub_driver.h"

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

using namespace tandem::cuda;

namespace {

long number(const char* name, long otherwise) {
    const auto* text = std::getenv(name);
    return text != nullptr ? std::atol(text) : otherwise;
}

bool launched = false;
std::size_t in_use = 0;
std::map<DevicePointer, std::size_t> sizes;

constexpr Result invalid_context = 201;
constexpr Result invalid_handle = 400;
constexpr Result invalid_in_capture = 900;

char primary;                            ///< the device's primary context
thread_local std::vector<Context> stack; ///< a thread's contexts, the current one last

Context current() { return stack.empty() ? nullptr : stack.back(); }
std::map<Stream, Context> streams; ///< context of each created stream
std::map<std::pair<Stream, Context>, unsigned long> calls;
unsigned long waits = 0;

using Work = std::vector<std::function<void()>>;
bool capturing = false;
std::set<Stream> captured_streams; ///< the stream of the capture, and those that were ordered after it
Work captured;                     ///< since the capture began
unsigned long graphs = 0;          ///< live graphs
unsigned long graph_launches = 0, commands_in_graphs = 0;
unsigned long profiler_starts = 0, profiler_stops = 0;
unsigned long event_records = 0;
std::map<EventHandle, Stream> recorded_in;
std::map<std::pair<Stream, Stream>, unsigned long> orderings; ///< by waiting and awaited stream
void (*watcher)(int) = nullptr;
std::map<std::uint64_t, unsigned long> launches_with, copies_of; ///< by address

void watched(int kind) {
    if (watcher != nullptr && !capturing) watcher(kind);
}

/// Runs a command at once or, during a capture, at each launch of the graph.
template<class Command>
void run(const Command& command) {
    if (capturing)
        captured.push_back(command);
    else
        command();
}

/// Return code of a call that needs a context.
Result in_context() { return current() != nullptr ? 0 : invalid_context; }

/// Return code of a call on a stream.
Result on(Stream stream) {
    ++calls[{stream, current()}];
    if (current() == nullptr) return invalid_context;
    const auto found = streams.find(stream);
    return stream == nullptr || (found != streams.end() && found->second == current()) ? 0 : invalid_handle;
}

/// Return code of a command on device memory: an error unless the whole range is allocated.
Result in_memory(DevicePointer first, std::size_t bytes) {
    auto next = sizes.upper_bound(first);
    if (next == sizes.begin()) return 1;
    --next;
    return first + bytes <= next->first + next->second ? 0 : 1;
}

/// Visible devices, by their numbers in the machine.
std::vector<long> visible() {
    std::vector<long> devices;
    const auto count = number("STUB_DEVICES", 1);
    const auto* shown = count > 1 ? std::getenv("CUDA_VISIBLE_DEVICES") : nullptr;
    for (long device = 0; shown == nullptr && device < count; ++device) devices.push_back(device);
    std::istringstream words(shown != nullptr ? shown : "");
    for (std::string word; std::getline(words, word, ',');) devices.push_back(std::stol(word));
    return devices;
}

std::size_t memory() { return static_cast<std::size_t>(number("STUB_MEMORY", 1L << 32)); }

template<class Handle>
Result make(Handle* handle) {
    static char something;
    *handle = reinterpret_cast<Handle>(&something);
    return 0;
}

} // namespace

extern "C" {
Result cuInit(unsigned) { return static_cast<Result>(number("STUB_INIT", 0)); }
Result cuDriverGetVersion(int* version) {
    *version = static_cast<int>(number("STUB_VERSION", 13000));
    return 0;
}
Result cuGetErrorName(Result code, const char** name) {
    static const std::map<Result, const char*> names{{out_of_memory, "CUDA_ERROR_OUT_OF_MEMORY"},
                                                     {100, "CUDA_ERROR_NO_DEVICE"},
                                                     {invalid_context, "CUDA_ERROR_INVALID_CONTEXT"},
                                                     {invalid_handle, "CUDA_ERROR_INVALID_HANDLE"},
                                                     {700, "CUDA_ERROR_ILLEGAL_ADDRESS"}};
    *name = names.contains(code) ? names.at(code) : nullptr;
    return *name != nullptr ? 0 : 1;
}
Result cuGetErrorString(Result, const char** text) {
    *text = "the stub's words";
    return 0;
}
Result cuDeviceGetCount(int* count) {
    *count = static_cast<int>(visible().size());
    return 0;
}
Result cuDeviceGet(DeviceHandle* device, int index) {
    *device = index;
    return 0;
}
Result cuDeviceGetName(char* name, int size, DeviceHandle) {
    std::strncpy(name, "Stub GPU", static_cast<std::size_t>(size));
    return 0;
}
Result cuDeviceGetUuid_v2(unsigned char* uuid, DeviceHandle device) {
    std::memset(uuid, 0x5a, 16);
    uuid[15] = static_cast<unsigned char>(uuid[15] + visible()[static_cast<std::size_t>(device)]);
    return 0;
}
Result cuDeviceGetAttribute(int* value, int what, DeviceHandle) {
    static const std::map<int, int> values{
        {max_threads_per_block, 1024}, {max_shared_per_block, 49152},
        {multiprocessor_count, 2},     {max_threads_per_multiprocessor, 2048},
        {clock_rate_khz, 1980000},     {memory_clock_rate_khz, 3201000},
        {memory_bus_bits, 6144},       {capability_major, 9},
        {capability_minor, 0}};
    const auto found = what == number("STUB_UNKNOWN", -1) ? values.end() : values.find(what);
    if (found == values.end())
        return 1; // CUDA_ERROR_INVALID_VALUE, as for an attribute that the driver does not support
    *value = found->second;
    return 0;
}
Result cuDeviceTotalMem_v2(std::size_t* bytes, DeviceHandle) {
    *bytes = memory();
    return 0;
}
Result cuDevicePrimaryCtxRetain(Context* context, DeviceHandle) {
    *context = reinterpret_cast<Context>(&primary);
    return 0;
}
Result cuDevicePrimaryCtxRelease_v2(DeviceHandle) { return 0; }
Result cuCtxCreate_v2(Context* context, unsigned, DeviceHandle) {
    stack.push_back(reinterpret_cast<Context>(new char));
    *context = stack.back();
    return 0;
}
Result cuCtxDestroy_v2(Context context) {
    std::erase(stack, context);
    delete reinterpret_cast<char*>(context);
    return 0;
}
Result cuCtxGetCurrent(Context* context) {
    *context = current();
    return 0;
}
Result cuCtxSetCurrent(Context context) {
    // As in the driver: the top of the stack is replaced; a null context pops it.
    if (!stack.empty()) stack.pop_back();
    if (context != nullptr) stack.push_back(context);
    return 0;
}
Result cuCtxPopCurrent_v2(Context* context) {
    *context = current();
    if (stack.empty()) return invalid_context;
    stack.pop_back();
    return 0;
}
Result cuCtxGetDevice(DeviceHandle* device) {
    *device = 0;
    return in_context();
}
Result cuMemGetInfo_v2(std::size_t* free, std::size_t* total) {
    *total = memory();
    *free = *total - in_use;
    return in_context();
}
Result cuMemAlloc_v2(DevicePointer* pointer, std::size_t bytes) {
    if (current() == nullptr) return invalid_context;
    if (in_use + bytes > memory()) return out_of_memory;
    *pointer = reinterpret_cast<DevicePointer>(std::calloc(1, bytes));
    sizes[*pointer] = bytes;
    in_use += bytes;
    return 0;
}
Result cuMemFree_v2(DevicePointer pointer) {
    if (current() == nullptr) return invalid_context;
    in_use -= sizes.at(pointer);
    sizes.erase(pointer);
    std::free(reinterpret_cast<void*>(pointer));
    return 0;
}
Result cuMemHostAlloc(void** memory, std::size_t bytes, unsigned) {
    *memory = std::malloc(bytes);
    return in_context();
}
Result cuMemFreeHost(void* memory) {
    std::free(memory);
    return in_context();
}
Result cuMemcpyHtoDAsync_v2(DevicePointer to, const void* from, std::size_t bytes, Stream stream) {
    ++copies_of[to];
    if (const auto code = in_memory(to, bytes); code != 0) return code;
    watched(1);
    run([=] { std::memcpy(reinterpret_cast<void*>(to), from, bytes); });
    return on(stream);
}
Result cuMemcpyDtoHAsync_v2(void* to, DevicePointer from, std::size_t bytes, Stream stream) {
    ++copies_of[from];
    if (const auto code = in_memory(from, bytes); code != 0) return code;
    watched(1);
    run([=] { std::memcpy(to, reinterpret_cast<const void*>(from), bytes); });
    return on(stream);
}
Result cuMemsetD8Async(DevicePointer to, unsigned char value, std::size_t bytes, Stream stream) {
    if (const auto code = in_memory(to, bytes); code != 0) return code;
    watched(2);
    run([=] { std::memset(reinterpret_cast<void*>(to), value, bytes); });
    return on(stream);
}
Result cuStreamCreate(Stream* stream, unsigned) {
    *stream = reinterpret_cast<Stream>(new char);
    streams[*stream] = current();
    return in_context();
}
Result cuStreamDestroy_v2(Stream stream) {
    streams.erase(stream);
    delete reinterpret_cast<char*>(stream);
    return in_context();
}
Result cuStreamSynchronize(Stream stream) {
    ++waits;
    if (capturing) return invalid_in_capture;
    return launched && number("STUB_FAULT", 0) != 0 ? 700 : on(stream);
}
Result cuEventCreate(EventHandle* event, unsigned) {
    return current() != nullptr ? make(event) : invalid_context;
}
Result cuEventDestroy_v2(EventHandle) { return in_context(); }
Result cuEventRecord(EventHandle event, Stream stream) {
    ++event_records;
    recorded_in[event] = stream;
    return on(stream);
}
Result cuStreamWaitEvent(Stream stream, EventHandle event, unsigned) {
    ++orderings[{stream, recorded_in.at(event)}];
    if (captured_streams.contains(recorded_in.at(event))) captured_streams.insert(stream);
    return on(stream);
}
Result cuEventElapsedTime(float* ms, EventHandle, EventHandle) {
    *ms = 0.001f;
    return in_context();
}
Result cuStreamBeginCapture_v2(Stream stream, int) {
    capturing = true;
    captured_streams = {stream};
    return on(stream);
}
Result cuStreamEndCapture(Stream stream, Graph* graph) {
    capturing = false;
    captured_streams.clear();
    *graph = reinterpret_cast<Graph>(new Work(std::exchange(captured, {})));
    return on(stream);
}
Result cuStreamIsCapturing(Stream stream, int* status) {
    *status = captured_streams.contains(stream) ? 1 : 0;
    return on(stream);
}
Result cuGraphInstantiateWithFlags(GraphExec* executable, Graph graph, unsigned long long) {
    if (const auto code = number("STUB_INSTANTIATE", 0); code != 0) return static_cast<Result>(code);
    ++graphs;
    *executable = reinterpret_cast<GraphExec>(new Work(*reinterpret_cast<Work*>(graph)));
    return in_context();
}
Result cuGraphLaunch(GraphExec executable, Stream stream) {
    const auto& work = *reinterpret_cast<Work*>(executable);
    ++graph_launches;
    commands_in_graphs += work.size();
    for (const auto& command : work) command();
    const auto code = on(stream);
    return code != 0 ? code : static_cast<Result>(number("STUB_GRAPH", 0));
}
Result cuGraphExecDestroy(GraphExec executable) {
    --graphs;
    delete reinterpret_cast<Work*>(executable);
    return in_context();
}
Result cuGraphDestroy(Graph graph) {
    delete reinterpret_cast<Work*>(graph);
    return in_context();
}
Result cuModuleLoadData(Module* module, const void*) {
    return current() != nullptr ? make(module) : invalid_context;
}
Result cuModuleUnload(Module) { return in_context(); }
Result cuModuleGetFunction(Function* function, Module, const char*) { return make(function); }
Result cuFuncGetAttribute(int* value, int what, Function) {
    *value = what == function_max_threads ? 1024 : 1;
    return 0;
}
#ifndef STUB_OLD
Result cuOccupancyMaxActiveBlocksPerMultiprocessor(int* groups, Function, int threads, std::size_t) {
    *groups = 1024 / threads;
    return in_context();
}
Result cuProfilerStart() {
    ++profiler_starts;
    return in_context();
}
Result cuProfilerStop() {
    ++profiler_stops;
    return in_context();
}
Result cuLaunchKernel(Function, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned, unsigned,
                      Stream stream, void** arguments, void**) {
    watched(10);
    for (; *arguments != nullptr; ++arguments)
        ++launches_with[*static_cast<const std::uint64_t*>(*arguments)];
    run([] { launched = true; });
    const auto code = on(stream);
    return code != 0 ? code : static_cast<Result>(number("STUB_LAUNCH", 0));
}
#endif

unsigned long stub_calls(Stream stream, Context context) {
    const auto found = calls.find({stream, context});
    return found == calls.end() ? 0 : found->second;
}
unsigned long stub_waits() { return waits; }
unsigned long stub_launches_with(unsigned long long address) { return launches_with[address]; }
unsigned long stub_copies_of(unsigned long long address) { return copies_of[address]; }
unsigned long stub_event_records() { return event_records; }
unsigned long stub_orderings(Stream stream, Stream before) {
    const auto found = orderings.find({stream, before});
    return found == orderings.end() ? 0 : found->second;
}
void stub_watch(void (*by)(int)) { watcher = by; }
unsigned long stub_profiler_starts() { return profiler_starts; }
unsigned long stub_profiler_stops() { return profiler_stops; }
unsigned long stub_graphs() { return graphs; }
unsigned long stub_graph_launches() { return graph_launches; }
unsigned long stub_commands_in_graphs() { return commands_in_graphs; }
unsigned long stub_all_calls() {
    unsigned long sum = 0;
    for (const auto& [where, count] : calls) sum += count;
    return sum;
}
}
