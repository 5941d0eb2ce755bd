// SPDX-License-Identifier: MIT
#include "python/core/given_rows.h"

#include "python/core/exchange.h"
#include "base/error.h"

#include <charconv>
#include <fmt/format.h>
#include <nanobind/stl/string.h>
#include <string_view>

namespace nb = nanobind;

namespace tandem::python {

namespace {

using Array = nb::ndarray<nb::ro>;
constexpr int host = nb::device::cpu::value, page_locked = nb::device::cuda_host::value;
constexpr int cuda = nb::device::cuda::value, managed = nb::device::cuda_managed::value;

[[noreturn]] void throw_type_error(const std::string& text) { throw nb::type_error(text.c_str()); }

[[noreturn]] void throw_shape(const std::string& shape, const WantedRows& wanted) {
    throw InputError(fmt::format("{}: shape {}; expected (n, {})", wanted.name(), shape, wanted.columns));
}

[[noreturn]] void throw_not_contiguous(const WantedRows& wanted) {
    throw InputError(
        fmt::format("{}: its rows are not contiguous, and device arrays are read without a copy; "
                    "give a contiguous array",
                    wanted.name()));
}

std::string shape_text(const Array& array) {
    std::string text;
    for (std::size_t i = 0; i < array.ndim(); ++i)
        text += fmt::format("{}{}", i > 0 ? ", " : "", array.shape(i));
    return fmt::format("({}{})", text, array.ndim() == 1 ? "," : "");
}

bool has_shape(const Array& array, std::size_t columns) {
    return array.ndim() == 2 && array.shape(1) == columns;
}

bool is_contiguous(const Array& array) {
    const auto columns = static_cast<std::int64_t>(array.shape(1));
    return (array.stride(1) == 1 || columns <= 1) && (array.stride(0) == columns || array.shape(0) <= 1);
}

bool is_aligned(const void* data, Precision precision) {
    return reinterpret_cast<std::uintptr_t>(data) % (precision == Precision::fp64 ? 8 : 4) == 0;
}

GivenRows checked(GivenRows given, const WantedRows& wanted) {
    if (!is_aligned(given.data, given.precision))
        throw InputError(fmt::format("{}: its address is not a multiple of {} bytes; give an aligned array",
                                     wanted.name(), given.precision == Precision::fp64 ? 8 : 4));
    return given;
}

Precision precision_of(const Array& array, const WantedRows& wanted) {
    if (array.dtype() == nb::dtype<double>()) return Precision::fp64;
    if (array.dtype() == nb::dtype<float>()) return Precision::fp32;
    throw_type_error(
        fmt::format("{}: numbers of {} bits that are neither float64 nor float32, and device arrays are read "
                    "without a conversion; convert the array on the device",
                    wanted.name(), array.dtype().bits));
}

/// Number of the group's GPU. None if the group is not one CUDA device.
std::optional<int> gpu_of(const DeviceGroup& devices) {
    if (devices.size() != 1) return std::nullopt;
    const auto own = dlpack_device(*devices.front());
    return own && own->first == cuda ? std::optional(own->second) : std::nullopt;
}

/// Whether memory of that DLPack type and number belongs to the group's device. Throws for memory of another
/// GPU.
bool is_own_memory(int kind, int number, const WantedRows& wanted) {
    const auto own = dlpack_device(*wanted.devices.front());
    if (own && own->first == (kind == managed ? cuda : kind)
        && (kind == managed || kind == host || own->second == number))
        return true;
    if (kind == host || kind == page_locked) return false;
    throw InputError(fmt::format("{}: is in CUDA's memory of GPU {}, and the collider works on {}; copy it "
                                 "to that device, or to the host's memory (.cpu() or .get())",
                                 wanted.name(), number, wanted.devices.front()->info().id));
}

GivenRows rows_of_array(Array array, const WantedRows& wanted) {
    if (!has_shape(array, wanted.columns)) throw_shape(shape_text(array), wanted);
    GivenRows given{const_cast<void*>(array.data()), array.shape(0), precision_of(array, wanted),
                    is_own_memory(array.device_type(), array.device_id(), wanted)};
    if (!is_contiguous(array)) throw_not_contiguous(wanted);
    given.owner = std::make_shared<Array>(std::move(array));
    return checked(std::move(given), wanted);
}

/// Owns a view of Python's buffer protocol.
struct HeldBuffer {
    HeldBuffer() = default;
    HeldBuffer(const HeldBuffer&) = delete;
    HeldBuffer& operator=(const HeldBuffer&) = delete;
    ~HeldBuffer() { PyBuffer_Release(&view); } // no effect on an empty view
    Py_buffer view{};
};

/// None if the object has no buffer, or a copy is needed: frames in host memory are contiguous float64.
std::optional<GivenRows> by_buffer(nb::handle object, const WantedRows& wanted) {
    if (!PyObject_CheckBuffer(object.ptr())) return std::nullopt;
    auto held = std::make_shared<HeldBuffer>();
    const auto& view = held->view;
    if (PyObject_GetBuffer(object.ptr(), &held->view, PyBUF_C_CONTIGUOUS | PyBUF_FORMAT) != 0) {
        PyErr_Clear();
        return std::nullopt;
    }
    const std::string_view format(view.format == nullptr ? "" : view.format);
    if (view.ndim != 2 || view.shape[1] != static_cast<Py_ssize_t>(wanted.columns)
        || (format != "d" && format != "=d") || !is_aligned(view.buf, Precision::fp64))
        return std::nullopt;
    return GivenRows{.data = view.buf, .rows = static_cast<std::size_t>(view.shape[0]), .owner = held};
}

GivenRows by_host_array(nb::handle object, const WantedRows& wanted) {
    const auto rows =
        nb::module_::import_("tandem.arrays").attr("host_array")(object, wanted.name(), wanted.columns);
    return by_buffer(rows, wanted).value();
}

GivenRows on_host(nb::handle object, const WantedRows& wanted) {
    if (auto given = by_buffer(object, wanted)) return std::move(*given);
    return by_host_array(object, wanted);
}

[[noreturn]] void throw_no_gpu(const WantedRows& wanted) {
    std::string names;
    for (const auto* device : wanted.devices) names += (names.empty() ? "" : "+") + device->info().id;
    throw InputError(fmt::format(
        "{}: is in CUDA's memory, and the collider works on {}; make the collider on that GPU, or "
        "copy the array to the host's memory (.cpu() or .get())",
        wanted.name(), names));
}

/// None if the type has no exchange table, or the array is in host memory and needs a copy.
std::optional<GivenRows> by_exchange(nb::handle object, const WantedRows& wanted) {
    auto given = exchanged(object);
    if (!given) return std::nullopt;
    auto& array = given->array;
    const auto kind = array.device_type();
    if (kind == cuda || kind == managed) {
        if (!gpu_of(wanted.devices)) throw_no_gpu(wanted);
        auto rows = rows_of_array(std::move(array), wanted);
        rows.queue = given->stream;
        return rows;
    }
    if ((kind != host && kind != page_locked) || array.dtype() != nb::dtype<double>()
        || !has_shape(array, wanted.columns) || !is_contiguous(array)
        || !is_aligned(array.data(), Precision::fp64))
        return std::nullopt;
    GivenRows rows{.data = const_cast<void*>(array.data()), .rows = array.shape(0)};
    rows.owner = std::make_shared<Array>(std::move(array));
    return rows;
}

/// Rows of __cuda_array_interface__. Its strides are None for contiguous rows.
GivenRows rows_of_interface(nb::handle object, const nb::dict& fields, const WantedRows& wanted) {
    const nb::tuple shape(fields["shape"]);
    const auto type = nb::cast<std::string>(fields["typestr"]);
    if (shape.size() != 2 || nb::cast<std::size_t>(shape[1]) != wanted.columns)
        throw_shape(nb::str(shape).c_str(), wanted);
    if (type != "<f8" && type != "<f4")
        throw_type_error(
            fmt::format("{}: type {} on a GPU, which is read without a conversion; expected float64 or "
                        "float32",
                        wanted.name(), type));
    const std::size_t bytes = type == "<f8" ? 8 : 4;
    const auto strides = fields.get("strides", nb::none());
    if (!strides.is_none() && !strides.equal(nb::make_tuple(wanted.columns * bytes, bytes)))
        throw_not_contiguous(wanted);
    GivenRows given{reinterpret_cast<void*>(nb::cast<std::uintptr_t>(fields["data"][0])),
                    nb::cast<std::size_t>(shape[0]), bytes == 8 ? Precision::fp64 : Precision::fp32, true};
    const auto stream = fields.get("stream", nb::none());
    if (!stream.is_none()) given.queue = reinterpret_cast<void*>(nb::cast<std::uintptr_t>(stream));
    given.owner = std::make_shared<nb::object>(nb::borrow(object));
    return checked(std::move(given), wanted);
}

/// For arrays with both protocols (CuPy): __cuda_array_interface__ gives the stream, which the device follows
/// once a frame; DLPack records one event per array. None if there is no stream or the array is not valid:
/// DLPack then reports the error.
std::optional<GivenRows> by_interface(nb::handle object, const WantedRows& wanted) {
    static nb::handle type_without_stream; // the last such type, so that its arrays are not queried again
    if (object.type().is(type_without_stream)) return std::nullopt;
    const auto fields = nb::getattr(object, "__cuda_array_interface__", nb::none());
    if (!nb::isinstance<nb::dict>(fields) || nb::cast<nb::dict>(fields).get("stream", nb::none()).is_none()) {
        type_without_stream.dec_ref();
        type_without_stream = object.type().inc_ref();
        return std::nullopt;
    }
    try {
        return rows_of_interface(object, nb::cast<nb::dict>(fields), wanted);
    } catch (const nb::builtin_exception&) {
        return std::nullopt;
    }
}

/// The array's library orders its pending work before the next command of the device's queue.
GivenRows by_dlpack(nb::handle object, const WantedRows& wanted) {
    constexpr std::uintptr_t default_stream = 1; // DLPack's number of it; 0 is not allowed
    const auto queue = reinterpret_cast<std::uintptr_t>(wanted.devices.front()->queue());
    nb::object capsule;
    try {
        capsule = object.attr("__dlpack__")(nb::arg("stream") = queue == 0 ? default_stream : queue);
    } catch (nb::python_error& error) { // libraries raise exceptions of any type
        if (!error.matches(PyExc_Exception)) throw;
        const auto text = nb::str(" ").attr("join")(nb::str(error.value()).attr("split")());
        throw InputError(fmt::format("{}: __dlpack__ failed: {}", wanted.name(), nb::str(text).c_str()));
    }
    return rows_of_array(nb::cast<Array>(capsule), wanted);
}

/// DLPack's type and number of the memory, by __dlpack_device__. Arrays with only __cuda_array_interface__ do
/// not give the number and count as managed memory.
std::optional<std::pair<int, int>> memory_of(nb::handle object) {
    if (nb::hasattr(object, "__dlpack_device__")) {
        const nb::object memory = object.attr("__dlpack_device__")();
        const nb::object kind = memory[0], number = memory[1];
        return std::pair(static_cast<int>(nb::int_(kind)), static_cast<int>(nb::int_(number)));
    }
    if (nb::hasattr(object, "__cuda_array_interface__")) return std::pair(managed, 0);
    return std::nullopt;
}

GivenRows on_gpu(nb::handle object, std::pair<int, int> memory, const WantedRows& wanted) {
    const auto gpu = gpu_of(wanted.devices);
    if (!gpu) throw_no_gpu(wanted);
    if (!nb::hasattr(object, "__dlpack__"))
        return rows_of_interface(object, nb::cast<nb::dict>(object.attr("__cuda_array_interface__")), wanted);
    if (memory.first == managed || memory.second == *gpu)
        if (auto given = by_interface(object, wanted)) return std::move(*given);
    auto given = by_dlpack(object, wanted);
    wanted.last_gpu_type = object.type();
    return given;
}

/// For an array whose type equals that of the last GPU array: skips the query of its memory. None if that
/// fails, as it does in host memory, where libraries refuse a stream.
std::optional<GivenRows> by_dlpack_of_last_type(nb::handle object, const WantedRows& wanted) {
    try {
        return by_dlpack(object, wanted);
    } catch (const InputError&) {
    } catch (const nb::builtin_exception&) {}
    return std::nullopt;
}

/// Type numpy.ndarray. Its subclasses, such as masked arrays, are for host_array to judge.
nb::handle numpy_array() {
    static const auto type =
        nb::object(nb::module_::import_("numpy").attr("ndarray")).release(); // never freed
    return type;
}

bool is_numpy_array(nb::handle object) {
    return PyObject_TypeCheck(object.ptr(), reinterpret_cast<PyTypeObject*>(numpy_array().ptr())) != 0;
}

} // namespace

std::string WantedRows::name() const {
    return (of_next ? "next_" : "") + (body ? fmt::format("vertices of body {}", *body) : "poses");
}

std::optional<std::pair<int, int>> dlpack_device(const Device& device) {
    const auto& id = device.info().id;
    if (id == "host") return std::pair(host, 0);
    constexpr std::string_view prefix = "cuda:";
    int number = 0;
    if (!id.starts_with(prefix)) return std::nullopt;
    std::from_chars(id.data() + prefix.size(), id.data() + id.size(), number);
    return std::pair(cuda, number);
}

GivenRows given_rows(nb::handle array, const WantedRows& wanted) {
    if (array.type().is(numpy_array())) return on_host(array, wanted);
    if (is_numpy_array(array)) return by_host_array(array, wanted);
    if (auto given = by_exchange(array, wanted)) return std::move(*given);
    // Arrays on a GPU have no buffer, and JAX raises a slow exception for the query.
    if (!gpu_of(wanted.devices))
        if (auto given = by_buffer(array, wanted)) return std::move(*given);
    if (array.type().is(wanted.last_gpu_type))
        if (auto given = by_dlpack_of_last_type(array, wanted)) return std::move(*given);
    const auto memory = memory_of(array);
    if (memory && (memory->first == cuda || memory->first == managed)) return on_gpu(array, *memory, wanted);
    return on_host(array, wanted);
}

GivenRows device_rows(nb::handle array, const WantedRows& wanted) {
    return rows_of_array(nb::cast<Array>(array), wanted);
}

} // namespace tandem::python
