// SPDX-License-Identifier: MIT
#pragma once

#include "backends/opencl/queue.h"

#include <map>
#include <memory>
#include <string>

namespace tandem::opencl {

struct OpenclKernel : Kernel::Impl {
    cl_kernel kernel = nullptr;
    OpenclKernel() = default;
    OpenclKernel(const OpenclKernel&) = delete;
    OpenclKernel& operator=(const OpenclKernel&) = delete;
    ~OpenclKernel() override {
        if (kernel) clReleaseKernel(kernel);
    }
};

/// The compiled kernel files of a device. A file is compiled once with each set of options; its entries share
/// the program.
class Programs {
public:
    /// `info` and `context` must outlive it.
    Programs(const DeviceInfo& info, cl_device_id device, cl_context context)
        : info_(info), device_(device), context_(context) {}
    /// No kernel may be in flight.
    ~Programs();
    Programs(const Programs&) = delete;
    Programs& operator=(const Programs&) = delete;

    /// As Device::compile(), with the facts that the driver reports. `queue`: of the same context; its
    /// commands finish before an error of a call is thrown.
    std::shared_ptr<OpenclKernel> compile(Queue& queue, const KernelSource& source, std::string_view entry,
                                          const Defines& defines);

private:
    bool reports_use() const;
    std::string options(const Defines& defines) const;
    cl_program build(Queue& queue, const KernelSource& source, const std::string& options);
    void read_facts(OpenclKernel& kernel, cl_program program, std::string_view entry) const;

    const DeviceInfo& info_;
    const cl_device_id device_;
    const cl_context context_;
    std::map<std::string, cl_program> built_; ///< by file and options
};

} // namespace tandem::opencl
