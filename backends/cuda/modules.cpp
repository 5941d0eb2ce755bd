// SPDX-License-Identifier: MIT
#include "backends/cuda/modules.h"

#include "backends/cuda/current_context.h"
#include "backends/ptxas_log.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <memory>
#include <semaphore>
#include <thread>
#include <utility>

namespace tandem::cuda {

namespace {

/// Limits the compilers of this process to the number of processors.
std::counting_semaphore<>& free_processors() {
    static std::counting_semaphore<> count(compilers_at_once());
    return count;
}

/// Starts `compile` in a thread of its own, which then sets `ms` to the time it took.
template<class Compile>
std::shared_future<Image> started(double& ms, const Compile& compile) {
    return std::async(std::launch::async, [&ms, compile] {
        auto& free = free_processors();
        free.acquire();
        const auto release = [&free](auto*) { free.release(); };
        const std::unique_ptr<std::counting_semaphore<>, decltype(release)> held(&free, release);
        const auto begin = std::chrono::steady_clock::now();
        auto image = compile();
        ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
        return image;
    });
}

} // namespace

std::uint32_t compilers_at_once() { return std::max(1U, std::thread::hardware_concurrency()); }

Modules::~Modules() {
    const CurrentContext current(driver(), context_);
    for (const auto& [key, loaded] : loaded_)
        if (loaded.module != nullptr) driver().cuModuleUnload(loaded.module);
}

Modules::Loaded& Modules::start(const KernelSource& source, const Defines& defines) {
    std::string key(source.name);
    for (const auto& [name, value] : defines) key += fmt::format("|{}={}", name, value);
    const auto [found, is_new] = loaded_.try_emplace(key);
    auto& loaded = found->second;
    if (!is_new) return loaded;
    loaded.name = source.name;
    const std::string text(source.text);
    if (source.name.ends_with(".ptx")) {
        std::promise<Image> known;
        known.set_value({.bytes = text, .target = "ptx", .log = {}});
        loaded.image = known.get_future();
    } else {
        loaded.image = started(loaded.compile_ms, [this, name = loaded.name, text, defines] {
            try {
                return libraries_.nvrtc.compile({name, text}, defines, device_.capability);
            } catch (const DeviceError& error) {
                throw DeviceError(
                    fmt::format("{} ({}): {}", device_.info.id, device_.info.name, error.what()));
            }
        });
    }
    return loaded;
}

std::shared_ptr<CudaKernel> Modules::compile(const KernelSource& source, std::string_view entry,
                                             const Defines& defines) {
    auto kernel = std::make_shared<CudaKernel>();
    kernel->facts.entry = entry;
    kernel->facts.defines = defines;
    kernel->finish = [this, own = kernel.get(), &loaded = start(source, defines)] { finish(*own, loaded); };
    return kernel;
}

/// Requires what compile() has set in the kernel.
void Modules::finish(CudaKernel& kernel, Loaded& loaded) const {
    const Queue::Scope scope(queue_);
    const auto& image = loaded.image.get();
    const auto check = [&](Result code, const char* call, std::string_view doing) {
        queue_.check(code, call, [&] { return fmt::format("{} {} ({})", doing, loaded.name, image.target); });
    };
    if (loaded.module == nullptr)
        check(driver().cuModuleLoadData(&loaded.module, image.bytes.data()), "cuModuleLoadData", "loading");
    auto& facts = kernel.facts;
    check(driver().cuModuleGetFunction(&kernel.function, loaded.module, facts.entry.c_str()),
          "cuModuleGetFunction", fmt::format("looking for '{}' in", facts.entry));
    const auto attribute = [&](FunctionAttribute which) -> std::int64_t {
        int value = -1;
        return driver().cuFuncGetAttribute(&value, which, kernel.function) == 0 ? value : -1;
    };
    facts.compile_ms += std::exchange(loaded.compile_ms, 0);
    facts.registers = attribute(function_registers);
    facts.local_bytes = attribute(function_shared_bytes);
    facts.max_group_size = attribute(function_max_threads);
    // NVRTC has a cache of its own since CUDA 12.9, whose images have no log. Without private memory nothing
    // spills.
    const auto use = use_of(image.log, facts.entry);
    const auto bytes = attribute(function_private_bytes);
    facts.spill_bytes = use.spill_bytes < 0 && bytes == 0 ? 0 : use.spill_bytes;
    facts.stack_bytes = use.stack_bytes < 0 ? bytes : use.stack_bytes;
    facts.occupancy = occupancy(kernel.function, facts.defines);
}

/// A group occupies whole warps.
double Modules::occupancy(Function function, const Defines& defines) const {
    const auto group_size = defines.find("GROUP_SIZE");
    if (driver().cuOccupancyMaxActiveBlocksPerMultiprocessor == nullptr || group_size == defines.end()
        || device_.threads_per_unit <= 0)
        return -1;
    constexpr int warp = 32;
    const int threads = std::stoi(group_size->second);
    int groups = 0;
    if (driver().cuOccupancyMaxActiveBlocksPerMultiprocessor(&groups, function, threads, 0) != 0) return -1;
    const int held = (threads + warp - 1) / warp * warp;
    return static_cast<double>(groups) * held / device_.threads_per_unit;
}

} // namespace tandem::cuda
