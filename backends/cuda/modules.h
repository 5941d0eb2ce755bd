// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/description.h"
#include "backends/cuda/queue.h"

#include <map>

namespace tandem::cuda {

struct CudaKernel : Kernel::Impl {
    Function function = nullptr; ///< valid as long as the Modules that made it
};

/// The compiled kernel files of a device. A file is compiled once with each set of defines; its entries share
/// the module.
class Modules {
public:
    /// `libraries`, `device` and `context` must outlive it.
    Modules(const Libraries& libraries, const Description& device, Context context)
        : libraries_(libraries), device_(device), context_(context) {}
    /// No kernel may be in flight.
    ~Modules();
    Modules(const Modules&) = delete;
    Modules& operator=(const Modules&) = delete;

    /// As Device::compile(), with the facts that the driver and the compiler report. `queue`: of the same
    /// context; its commands finish before an error of the driver is thrown. Requires a Queue::Scope.
    std::shared_ptr<CudaKernel> compile(const Queue& queue, const KernelSource& source,
                                        std::string_view entry, const Defines& defines);

private:
    struct Loaded {
        Module module = nullptr;
        Image image; ///< without its bytes
    };

    const Driver& driver() const { return libraries_.driver; }
    const Loaded& load(const Queue& queue, const KernelSource& source, const Defines& defines);
    /// As KernelFacts::occupancy.
    double occupancy(Function function, const Defines& defines) const;

    const Libraries& libraries_;
    const Description& device_;
    const Context context_;
    std::map<std::string, Loaded> loaded_; ///< by file and defines
};

} // namespace tandem::cuda
