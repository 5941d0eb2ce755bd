// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

namespace tandem {

/// Compile-time parameters of a kernel (name -> value), emitted as defines under the same names.
using Defines = std::map<std::string, std::string>;

/// A kernel file with its headers, flattened into one text. If its name ends with ".ptx", it is PTX of a
/// baseline, which only CUDA devices load.
struct KernelSource {
    std::string_view name; ///< "algorithms/chunked/chunked.cl"
    std::string_view text; ///< complete, with the text of its headers
};

/// A handle of device memory. The last copy frees the memory and must be destroyed before the device. Freeing
/// never fails.
class Buffer {
public:
    /// Base class of an adaptor's buffer, which adds the vendor's handle.
    struct Impl : std::enable_shared_from_this<Impl> {
        virtual ~Impl() = default;
        /// The vendor's handle, as Device::adopt takes it.
        virtual void* native() const = 0;
        std::size_t bytes = 0; ///< at least the requested size
        std::string label;     ///< its name in traces and errors
        bool is_table = false; ///< made by uploaded(); Device::fill_buffers() keeps its content
    };

    Buffer() = default;
    /// A handle of an adaptor's buffer; null makes an empty handle.
    explicit Buffer(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

    explicit operator bool() const { return impl_ != nullptr; } ///< false for an empty handle
    /// Size in bytes, at least the requested one; 0 for an empty handle.
    std::size_t bytes() const { return impl_ ? impl_->bytes : 0; }
    Impl& impl() const { return *impl_; } ///< requires a non-empty handle
    /// The vendor's handle, valid as long as this one: a host or CUDA pointer, or a cl_mem; null for an empty
    /// handle.
    void* native() const { return impl_ ? impl_->native() : nullptr; }

private:
    std::shared_ptr<Impl> impl_;
};

/// Cost and resources of a compiled kernel; -1: the backend does not report the value.
struct KernelFacts {
    std::string entry;                ///< name of the entry point
    Defines defines;                  ///< those given to Device::compile
    double compile_ms = 0;            ///< 0 when it was compiled before
    std::int64_t registers = -1;      ///< of a work-item
    std::int64_t local_bytes = -1;    ///< of a work-group
    std::int64_t spill_bytes = -1;    ///< stores and loads of a work-item
    std::int64_t stack_bytes = -1;    ///< of a work-item's private arrays that are not in registers
    std::int64_t max_group_size = -1; ///< work-items; launch() refuses more
    /// Largest fraction of a compute unit's work-items that groups of GROUP_SIZE can fill, given registers
    /// and local memory; negative when the backend does not report it.
    double occupancy = -1;
};

/// A compiled entry point of one device. Copies are cheap.
class Kernel {
public:
    /// Base class of an adaptor's kernel, which adds the vendor's handle.
    struct Impl {
        virtual ~Impl() = default;
        /// Waits for its compiler, if that still runs, and completes the facts. Throws what the compiler
        /// reports, each time it is called.
        virtual void complete() {}
        KernelFacts facts; ///< complete when Device::compile, or Device::compile_together, returns
    };

    Kernel() = default;
    /// A handle of an adaptor's kernel; null makes an empty handle.
    explicit Kernel(std::shared_ptr<Impl> impl) : impl_(std::move(impl)) {}

    explicit operator bool() const { return impl_ != nullptr; } ///< false for an empty handle

    /// Requires a non-empty handle; valid as long as the device.
    const KernelFacts& facts() const { return impl_->facts; }
    Impl& impl() const { return *impl_; } ///< requires a non-empty handle

private:
    std::shared_ptr<Impl> impl_;
};

/// A kernel argument: a buffer, which must outlive the call, or a scalar of at most 8 bytes. The scalar's
/// type must have the size of the kernel's parameter.
class Argument {
public:
    /// The bytes of a scalar.
    struct Scalar {
        std::array<std::byte, 8> bytes{}; ///< the value, in the first `size` bytes
        std::size_t size = 0;             ///< size of the type, at most 8
    };

    /// Refers to a buffer; requires a non-empty handle.
    Argument(const Buffer& buffer) : value_(&buffer.impl()) {}
    /// Copies a scalar.
    template<class T>
    requires(std::is_arithmetic_v<T> && sizeof(T) <= 8) Argument(T scalar) {
        Scalar copy;
        copy.size = sizeof(T);
        std::memcpy(copy.bytes.data(), &scalar, sizeof(T));
        value_ = copy;
    }

    /// For adaptors: the buffer or the scalar.
    const std::variant<Buffer::Impl*, Scalar>& value() const { return value_; }

private:
    std::variant<Buffer::Impl*, Scalar> value_;
};

/// One-dimensional grid: groups x group_size work-items. `group_size` is the define GROUP_SIZE of the kernel.
struct Grid {
    std::uint64_t groups = 1;     ///< number of work-groups; 0: the launch does nothing
    std::uint32_t group_size = 1; ///< work-items of a group; launch() refuses 0
};

/// A scalar argument that only a value of type T converts to, so that a call with another type does not
/// compile.
template<class T>
class Exact {
public:
    template<std::same_as<T> U>
    Exact(U value) : value_(value) {}            // NOLINT(google-explicit-constructor)
    operator Argument() const { return value_; } ///< copies the value

private:
    T value_;
};

/// A compiled kernel of the project, with the type of its arguments. The build generates that type for each
/// kernel from its signature, in the header FILE.cl.h (cmake/kernel_arguments.py): a member per parameter, in
/// their order and without defaults, so that the compiler reports missing, misnamed and mistyped arguments.
template<class Arguments>
class KernelOf {
public:
    KernelOf() = default;
    /// Requires a kernel with the signature of `Arguments`.
    explicit KernelOf(Kernel kernel) : kernel_(std::move(kernel)) {}

    explicit operator bool() const { return static_cast<bool>(kernel_); } ///< false for an empty handle
    const KernelFacts& facts() const { return kernel_.facts(); }          ///< requires a non-empty handle
    const Kernel& untyped() const { return kernel_; }                     ///< for the functions of a device

private:
    Kernel kernel_;
};

} // namespace tandem
