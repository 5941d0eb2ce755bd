// SPDX-License-Identifier: MIT
#include "backends/opencl/programs.h"

#include "backends/opencl/description.h"
#include "backends/opencl/drivers.h"
#include "backends/ptxas_log.h"
#include "base/text_lines.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <sstream>
#include <string_view>

namespace tandem::opencl {

namespace {

std::string build_log(cl_program program, cl_device_id device) {
    std::size_t size = 0;
    clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
    std::string log(size, '\0');
    clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
    while (!log.empty() && log.back() == '\0') log.pop_back();
    return log;
}

/// The first line of a build log that has an error, else its first line with text.
std::string decisive_line(const std::string& log) {
    std::istringstream lines(log);
    std::string first;
    for (std::string line; std::getline(lines, line);) {
        if (line.find("error") != std::string::npos) return visible(line);
        if (first.empty() && line.find_first_not_of(" \t\r") != std::string::npos) first = line;
    }
    return first.empty() ? "the driver gives no build log" : visible(first);
}

/// A property of a kernel; zero when the driver does not report it.
template<class T>
T kernel_value(cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info what) {
    T value{};
    clGetKernelWorkGroupInfo(kernel, device, what, sizeof(T), &value, nullptr);
    return value;
}

} // namespace

Programs::~Programs() {
    for (const auto& [key, program] : built_) clReleaseProgram(program);
}

/// Whether NVIDIA's compiler can write the resources of each entry into the build log.
bool Programs::reports_use() const { return has_extension(device_, "cl_nv_compiler_options"); }

std::string Programs::options(const Defines& defines) const {
    std::string options = "-cl-std=CL1.2";
    const auto floats = device_value<cl_device_fp_config>(device_, CL_DEVICE_SINGLE_FP_CONFIG);
    if ((floats & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0)
        options += " -cl-fp32-correctly-rounded-divide-sqrt";
    if (reports_use()) options += " -cl-nv-verbose";
    for (const auto& [name, value] : defines) options += fmt::format(" -D{}={}", name, value);
    return options;
}

cl_program Programs::build(Queue& queue, const KernelSource& source, const std::string& options) {
    const auto key = fmt::format("{} {}", source.name, options);
    if (const auto found = built_.find(key); found != built_.end()) return found->second;
    cl_int code = CL_SUCCESS;
    const char* text = source.text.data();
    const std::size_t length = source.text.size();
    auto* program = clCreateProgramWithSource(context_, 1, &text, &length, &code);
    queue.check(code, "clCreateProgramWithSource", "compiling");
    // A second time, because PoCL fails when processes write the same program into its cache at once: the one
    // that removes the older file second finds none. The cache then has the program.
    for (int attempt = 0; attempt < 2; ++attempt) {
        code = clBuildProgram(program, 1, &device_, options.c_str(), nullptr, nullptr);
        if (code == CL_SUCCESS) return built_[key] = program;
    }
    const auto log = build_log(program, device_);
    clReleaseProgram(program);
    const auto cache = cache_problem(device_);
    throw DeviceError(fmt::format("{}: {} does not compile with {} (code {}): {}{}{}", info_.id, source.name,
                                  options, code, decisive_line(log), cache.empty() ? "" : "; ", cache));
}

std::shared_ptr<OpenclKernel> Programs::compile(Queue& queue, const KernelSource& source,
                                                std::string_view entry, const Defines& defines) {
    auto kernel = std::make_shared<OpenclKernel>();
    auto* program = build(queue, source, options(defines));
    cl_int code = CL_SUCCESS;
    kernel->kernel = clCreateKernel(program, std::string(entry).c_str(), &code);
    queue.check(code, "clCreateKernel",
                [&] { return fmt::format("looking for '{}' in {}", entry, source.name); });
    read_facts(*kernel, program, entry);
    return kernel;
}

void Programs::read_facts(OpenclKernel& kernel, cl_program program, std::string_view entry) const {
    auto& facts = kernel.facts;
    if (reports_use()) {
        const auto use = use_of(build_log(program, device_), entry);
        facts.registers = use.registers;
        facts.spill_bytes = use.spill_bytes;
        facts.stack_bytes = use.stack_bytes;
    }
    facts.local_bytes =
        static_cast<std::int64_t>(kernel_value<cl_ulong>(kernel.kernel, device_, CL_KERNEL_LOCAL_MEM_SIZE));
    // A kernel runs at the size that it is compiled for: NVIDIA's driver reports 256 for kernels that run in
    // groups of 992.
    const auto reported = kernel_value<std::size_t>(kernel.kernel, device_, CL_KERNEL_WORK_GROUP_SIZE);
    const auto compiled =
        kernel_value<std::array<std::size_t, 3>>(kernel.kernel, device_, CL_KERNEL_COMPILE_WORK_GROUP_SIZE);
    facts.max_group_size = static_cast<std::int64_t>(std::max(reported, compiled[0]));
}

} // namespace tandem::opencl
