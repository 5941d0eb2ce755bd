// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/description.h"
#include "backends/cuda/queue.h"

#include <functional>
#include <future>
#include <map>

namespace tandem::cuda {

/// The number of kernel files that this process compiles at the same time: one on each processor.
std::uint32_t compilers_at_once();

struct CudaKernel : Kernel::Impl {
    Function function = nullptr;  ///< valid as long as the Modules that made it; null until complete
    std::function<void()> finish; ///< waits for the compiler and loads the kernel; empty once complete

    void complete() override {
        if (!finish) return;
        finish();
        finish = nullptr;
    }
};

/// The compiled kernel files of a device. A file is compiled once with each set of defines, in a thread of
/// its own; its entries share the module.
class Modules {
public:
    /// `libraries`, `device` and `context` must outlive it; `queue`, of that context, must live while kernels
    /// are completed.
    Modules(const Libraries& libraries, const Description& device, Context context, const Queue& queue)
        : libraries_(libraries), device_(device), context_(context), queue_(queue) {}
    /// No kernel may be in flight. Waits for compilers.
    ~Modules();
    Modules(const Modules&) = delete;
    Modules& operator=(const Modules&) = delete;

    /// Starts to compile, unless that was done before. Kernel::Impl::complete() loads the kernel, with the
    /// facts that the driver and the compiler report; the commands of the queue finish before it throws an
    /// error of the driver.
    std::shared_ptr<CudaKernel> compile(const KernelSource& source, std::string_view entry,
                                        const Defines& defines);

private:
    struct Loaded {
        std::string name;                ///< of the file
        double compile_ms = 0;           ///< of the compiler, until a kernel has taken it
        Module module = nullptr;         ///< null until a kernel of it is complete
        std::shared_future<Image> image; ///< of the compiler; its end waits for that
    };

    const Driver& driver() const { return libraries_.driver; }
    Loaded& start(const KernelSource& source, const Defines& defines);
    void finish(CudaKernel& kernel, Loaded& loaded) const;
    /// As KernelFacts::occupancy.
    double occupancy(Function function, const Defines& defines) const;

    const Libraries& libraries_;
    const Description& device_;
    const Context context_;
    const Queue& queue_;
    std::map<std::string, Loaded> loaded_; ///< by file and defines
};

} // namespace tandem::cuda
