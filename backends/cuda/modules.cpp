// SPDX-License-Identifier: MIT
#include "backends/cuda/modules.h"

#include "backends/cuda/current_context.h"
#include "backends/ptxas_log.h"

#include <fmt/format.h>

namespace tandem::cuda {

Modules::~Modules() {
    const CurrentContext current(driver(), context_);
    for (const auto& [key, loaded] : loaded_) driver().cuModuleUnload(loaded.module);
}

const Modules::Loaded& Modules::load(const Queue& queue, const KernelSource& source, const Defines& defines) {
    std::string key(source.name);
    for (const auto& [name, value] : defines) key += fmt::format("|{}={}", name, value);
    if (const auto found = loaded_.find(key); found != loaded_.end()) return found->second;
    Loaded loaded;
    try {
        loaded.image = source.name.ends_with(".ptx")
                           ? Image{.bytes = std::string(source.text), .target = "ptx", .log = {}}
                           : libraries_.nvrtc.compile(source, defines, device_.capability);
    } catch (const DeviceError& error) {
        throw DeviceError(fmt::format("{} ({}): {}", device_.info.id, device_.info.name, error.what()));
    }
    queue.check(driver().cuModuleLoadData(&loaded.module, loaded.image.bytes.data()), "cuModuleLoadData",
                [&] { return fmt::format("loading {} ({})", source.name, loaded.image.target); });
    loaded.image.bytes.clear();
    return loaded_[key] = std::move(loaded);
}

std::shared_ptr<CudaKernel> Modules::compile(const Queue& queue, const KernelSource& source,
                                             std::string_view entry, const Defines& defines) {
    const auto& loaded = load(queue, source, defines);
    auto kernel = std::make_shared<CudaKernel>();
    const std::string name(entry);
    queue.check(driver().cuModuleGetFunction(&kernel->function, loaded.module, name.c_str()),
                "cuModuleGetFunction",
                [&] { return fmt::format("looking for '{}' in {}", entry, source.name); });
    const auto attribute = [&](FunctionAttribute which) -> std::int64_t {
        int value = -1;
        return driver().cuFuncGetAttribute(&value, which, kernel->function) == 0 ? value : -1;
    };
    kernel->facts.registers = attribute(function_registers);
    kernel->facts.local_bytes = attribute(function_shared_bytes);
    kernel->facts.max_group_size = attribute(function_max_threads);
    const auto use = use_of(loaded.image.log, entry);
    kernel->facts.spill_bytes = use.spill_bytes;
    kernel->facts.stack_bytes = use.stack_bytes;
    kernel->facts.occupancy = occupancy(kernel->function, defines);
    return kernel;
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
