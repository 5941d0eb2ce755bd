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
    throw InputError(
        fmt::format("{}: shape {}, and (n, {}) is wanted", wanted.name(), shape, wanted.columns));
}

[[noreturn]] void throw_not_beside_each_other(const WantedRows& wanted) {
    throw InputError(fmt::format("{}: its rows are not beside each other, and what is on a device is read as "
                                 "it is; give a contiguous array",
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

bool rows_are_beside_each_other(const Array& array) {
    const auto columns = static_cast<std::int64_t>(array.shape(1));
    return (array.stride(1) == 1 || columns <= 1) && (array.stride(0) == columns || array.shape(0) <= 1);
}

bool is_aligned(const void* data, Precision precision) {
    return reinterpret_cast<std::uintptr_t>(data) % (precision == Precision::fp64 ? 8 : 4) == 0;
}

GivenRows checked(GivenRows given, const WantedRows& wanted) {
    if (!is_aligned(given.data, given.precision))
        throw InputError(fmt::format("{}: begins at no multiple of {} bytes; give an array that does",
                                     wanted.name(), given.precision == Precision::fp64 ? 8 : 4));
    return given;
}

Precision precision_of(const Array& array, const WantedRows& wanted) {
    if (array.dtype() == nb::dtype<double>()) return Precision::fp64;
    if (array.dtype() == nb::dtype<float>()) return Precision::fp32;
    throw_type_error(
        fmt::format("{}: numbers of {} bits that are neither float64 nor float32, and what is on a "
                    "device is read as it is; convert it there",
                    wanted.name(), array.dtype().bits));
}

/// Number of the GPU whose memory frames are read from; none where the group is of something else.
std::optional<int> gpu_of(const DeviceGroup& devices) {
    if (devices.size() != 1) return std::nullopt;
    const auto there = dlpack_device(*devices.front());
    return there && there->first == cuda ? std::optional(there->second) : std::nullopt;
}

/// Whether memory of that kind is of the group's device; throws where it is of another GPU.
bool is_there(int kind, int number, const WantedRows& wanted) {
    const auto there = dlpack_device(*wanted.devices.front());
    if (there && there->first == (kind == managed ? cuda : kind)
        && (kind == managed || kind == host || there->second == number))
        return true;
    if (kind == host || kind == page_locked) return false;
    throw InputError(fmt::format("{}: is in CUDA's memory of GPU {}, and the collider works on {}; copy it "
                                 "there, or to the host's memory (.cpu() or .get())",
                                 wanted.name(), number, wanted.devices.front()->info().id));
}

GivenRows of_array(Array array, const WantedRows& wanted) {
    if (!has_shape(array, wanted.columns)) throw_shape(shape_text(array), wanted);
    GivenRows given{const_cast<void*>(array.data()), array.shape(0), precision_of(array, wanted),
                    is_there(array.device_type(), array.device_id(), wanted)};
    if (!rows_are_beside_each_other(array)) throw_not_beside_each_other(wanted);
    given.keeper = std::make_shared<Array>(std::move(array));
    return checked(std::move(given), wanted);
}

/// Given back when it goes.
struct HeldBuffer {
    HeldBuffer() = default;
    HeldBuffer(const HeldBuffer&) = delete;
    HeldBuffer& operator=(const HeldBuffer&) = delete;
    ~HeldBuffer() { PyBuffer_Release(&view); } // nothing where none was given
    Py_buffer view{};
};

/// None where the object is something else, or not as the host's frames are read.
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
    return GivenRows{.data = view.buf, .rows = static_cast<std::size_t>(view.shape[0]), .keeper = held};
}

GivenRows on_host(nb::handle object, const WantedRows& wanted) {
    if (auto given = by_buffer(object, wanted)) return std::move(*given);
    const auto rows =
        nb::module_::import_("tandem.arrays").attr("host_array")(object, wanted.name(), wanted.columns);
    return by_buffer(rows, wanted).value();
}

[[noreturn]] void throw_no_gpu(const WantedRows& wanted) {
    std::string names;
    for (const auto* device : wanted.devices) names += (names.empty() ? "" : "+") + device->info().id;
    throw InputError(
        fmt::format("{}: is in CUDA's memory, and the collider works on {}; make it on that GPU, or copy the "
                    "array to the host's memory (.cpu() or .get())",
                    wanted.name(), names));
}

/// None where the array is in the host's memory and has to be copied.
std::optional<GivenRows> by_exchange(nb::handle object, const WantedRows& wanted) {
    auto given = exchanged(object);
    if (!given) return std::nullopt;
    auto& array = given->array;
    const auto kind = array.device_type();
    if (kind == cuda || kind == managed) {
        if (!gpu_of(wanted.devices)) throw_no_gpu(wanted);
        auto rows = of_array(std::move(array), wanted);
        rows.queue = given->stream;
        return rows;
    }
    if ((kind != host && kind != page_locked) || array.dtype() != nb::dtype<double>()
        || !has_shape(array, wanted.columns) || !rows_are_beside_each_other(array)
        || !is_aligned(array.data(), Precision::fp64))
        return std::nullopt;
    GivenRows rows{.data = const_cast<void*>(array.data()), .rows = array.shape(0)};
    rows.keeper = std::make_shared<Array>(std::move(array));
    return rows;
}

/// The value of __cuda_array_interface__, whose strides are None where rows are beside each other.
GivenRows of_interface(nb::handle object, const nb::dict& fields, const WantedRows& wanted) {
    const nb::tuple shape(fields["shape"]);
    const auto type = nb::cast<std::string>(fields["typestr"]);
    if (shape.size() != 2 || nb::cast<std::size_t>(shape[1]) != wanted.columns)
        throw_shape(nb::str(shape).c_str(), wanted);
    if (type != "<f8" && type != "<f4")
        throw_type_error(
            fmt::format("{}: type {} on a GPU, where it is read as it is, and float64 or float32 "
                        "is wanted",
                        wanted.name(), type));
    const std::size_t bytes = type == "<f8" ? 8 : 4;
    const auto strides = fields.get("strides", nb::none());
    if (!strides.is_none() && !strides.equal(nb::make_tuple(wanted.columns * bytes, bytes)))
        throw_not_beside_each_other(wanted);
    GivenRows given{reinterpret_cast<void*>(nb::cast<std::uintptr_t>(fields["data"][0])),
                    nb::cast<std::size_t>(shape[0]), bytes == 8 ? Precision::fp64 : Precision::fp32, true};
    const auto stream = fields.get("stream", nb::none());
    if (!stream.is_none()) given.queue = reinterpret_cast<void*>(nb::cast<std::uintptr_t>(stream));
    given.keeper = std::make_shared<nb::object>(nb::borrow(object));
    return checked(std::move(given), wanted);
}

/// Of what has both protocols (CuPy's): with the stream's name it can be followed once a frame, where DLPack
/// makes an event an array. None where there is none, or numbers are of another type: DLPack has the words.
std::optional<GivenRows> by_interface(nb::handle object, const WantedRows& wanted) {
    static nb::handle type_without; // the last that names none, kept: its arrays are not asked again
    if (object.type().is(type_without)) return std::nullopt;
    const auto fields = nb::getattr(object, "__cuda_array_interface__", nb::none());
    if (!nb::isinstance<nb::dict>(fields) || nb::cast<nb::dict>(fields).get("stream", nb::none()).is_none()) {
        type_without.dec_ref();
        type_without = object.type().inc_ref();
        return std::nullopt;
    }
    try {
        return of_interface(object, nb::cast<nb::dict>(fields), wanted);
    } catch (const nb::builtin_exception&) {
        return std::nullopt;
    }
}

/// Its library makes it written before what the device's queue gets next.
GivenRows by_dlpack(nb::handle object, const WantedRows& wanted) {
    constexpr std::uintptr_t default_stream = 1; // its name where 0 is none
    const auto queue = reinterpret_cast<std::uintptr_t>(wanted.devices.front()->queue());
    nb::object capsule;
    try {
        capsule = object.attr("__dlpack__")(nb::arg("stream") = queue == 0 ? default_stream : queue);
    } catch (nb::python_error& error) { // what libraries raise here is of any kind
        if (!error.matches(PyExc_Exception)) throw;
        const auto text = nb::str(" ").attr("join")(nb::str(error.value()).attr("split")());
        throw InputError(fmt::format("{}: is not given by DLPack: {}", wanted.name(), nb::str(text).c_str()));
    }
    return of_array(nb::cast<Array>(capsule), wanted);
}

/// Kind and number of the memory, by __dlpack_device__; of what has __cuda_array_interface__ alone nobody
/// knows the number.
std::optional<std::pair<int, int>> place_of(nb::handle object) {
    if (nb::hasattr(object, "__dlpack_device__")) {
        const nb::object place = object.attr("__dlpack_device__")();
        const nb::object kind = place[0], number = place[1];
        return std::pair(static_cast<int>(nb::int_(kind)), static_cast<int>(nb::int_(number)));
    }
    if (nb::hasattr(object, "__cuda_array_interface__")) return std::pair(managed, 0);
    return std::nullopt;
}

GivenRows on_gpu(nb::handle object, std::pair<int, int> place, const WantedRows& wanted) {
    const auto gpu = gpu_of(wanted.devices);
    if (!gpu) throw_no_gpu(wanted);
    if (!nb::hasattr(object, "__dlpack__"))
        return of_interface(object, nb::cast<nb::dict>(object.attr("__cuda_array_interface__")), wanted);
    if (place.first == managed || place.second == *gpu)
        if (auto given = by_interface(object, wanted)) return std::move(*given);
    auto given = by_dlpack(object, wanted);
    wanted.last_there = object.type();
    return given;
}

/// Of an array beside which others of its type are on the GPU, and it is, most likely: a library that is told
/// a stream for memory of the host's refuses. None where anything is otherwise, which is then asked first.
std::optional<GivenRows> like_the_last(nb::handle object, const WantedRows& wanted) {
    try {
        return by_dlpack(object, wanted);
    } catch (const InputError&) {
    } catch (const nb::builtin_exception&) {}
    return std::nullopt;
}

bool is_of_numpy(nb::handle object) {
    static const auto type = nb::object(nb::module_::import_("numpy").attr("ndarray")).release(); // kept
    return PyObject_TypeCheck(object.ptr(), reinterpret_cast<PyTypeObject*>(type.ptr())) != 0;
}

} // namespace

std::string WantedRows::name() const { return body ? fmt::format("vertices of body {}", *body) : "poses"; }

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
    if (is_of_numpy(array)) return on_host(array, wanted);
    if (auto given = by_exchange(array, wanted)) return std::move(*given);
    // On a GPU there is no buffer, and JAX makes an exception of saying so.
    if (!gpu_of(wanted.devices))
        if (auto given = by_buffer(array, wanted)) return std::move(*given);
    if (array.type().is(wanted.last_there))
        if (auto given = like_the_last(array, wanted)) return std::move(*given);
    const auto place = place_of(array);
    if (place && (place->first == cuda || place->first == managed)) return on_gpu(array, *place, wanted);
    return on_host(array, wanted);
}

GivenRows device_rows(nb::handle array, const WantedRows& wanted) {
    return of_array(nb::cast<Array>(array), wanted);
}

} // namespace tandem::python
