// SPDX-License-Identifier: MIT
#include "python/core/device_input.h"

#include "scenes/error.h"

#include <charconv>
#include <fmt/format.h>

namespace nb = nanobind;

namespace tandem::python {

namespace {

constexpr std::size_t pose_numbers = 7, coordinates = 3;
constexpr std::size_t most_adopted = 64;

using Array = nb::ndarray<nb::ro>;

[[noreturn]] void throw_type_error(const std::string& text) { throw nb::type_error(text.c_str()); }

std::string shape_text(const Array& array) {
    std::string text;
    for (std::size_t i = 0; i < array.ndim(); ++i)
        text += fmt::format("{}{}", i > 0 ? ", " : "", array.shape(i));
    return fmt::format("({}{})", text, array.ndim() == 1 ? "," : "");
}

bool rows_are_beside_each_other(const Array& array) {
    const auto columns = static_cast<std::int64_t>(array.shape(1));
    return (array.stride(1) == 1 || columns <= 1) && (array.stride(0) == columns || array.shape(0) <= 1);
}

Precision precision_of(const Array& array, const std::string& what) {
    if (array.dtype() == nb::dtype<double>()) return Precision::fp64;
    if (array.dtype() == nb::dtype<float>()) return Precision::fp32;
    throw_type_error(
        fmt::format("{}: numbers of {} bits that are neither float64 nor float32, and what is on a "
                    "device is read as it is; convert it there",
                    what, array.dtype().bits));
}

/// Whether the array is in memory of the device; throws where it is in that of another.
bool is_there(const Array& array, const std::string& what, const Device& device) {
    const auto there = dlpack_device(device);
    const auto type = array.device_type();
    const bool managed = type == nb::device::cuda_managed::value;
    if (there && there->first == (managed ? nb::device::cuda::value : type)
        && (managed || type == nb::device::cpu::value || there->second == array.device_id()))
        return true;
    if (type == nb::device::cpu::value || type == nb::device::cuda_host::value) return false;
    throw InputError(fmt::format("{}: is in CUDA's memory of GPU {}, and the collider works on {}; copy it "
                                 "there, or to the host's memory (.cpu() or .get())",
                                 what, array.device_id(), device.info().id));
}

void check_aligned(const GivenRows& given, const std::string& what) {
    const std::size_t bytes = given.precision == Precision::fp64 ? 8 : 4;
    if (reinterpret_cast<std::uintptr_t>(given.data) % bytes != 0)
        throw InputError(
            fmt::format("{}: begins at no multiple of {} bytes; give an array that does", what, bytes));
}

GivenRows of_array(const Array& array, std::size_t columns, const std::string& what, const Device& device) {
    if (array.ndim() != 2 || array.shape(1) != columns)
        throw InputError(
            fmt::format("{}: shape {}, and (n, {}) is wanted", what, shape_text(array), columns));
    GivenRows given{const_cast<void*>(array.data()), array.shape(0), precision_of(array, what),
                    is_there(array, what, device)};
    if (!rows_are_beside_each_other(array))
        throw InputError(
            fmt::format("{}: its rows are not beside each other, and what is on a device is read "
                        "as it is; give a contiguous array",
                        what));
    return given;
}

GivenRows of_interface(const nb::tuple& fields) {
    GivenRows given{reinterpret_cast<void*>(nb::cast<std::uintptr_t>(fields[0])),
                    nb::cast<std::size_t>(fields[1]),
                    nb::cast<int>(fields[2]) == 64 ? Precision::fp64 : Precision::fp32, true};
    if (!fields[3].is_none()) given.queue = reinterpret_cast<void*>(nb::cast<std::uintptr_t>(fields[3]));
    return given;
}

} // namespace

std::optional<std::pair<int, int>> dlpack_device(const Device& device) {
    const auto& id = device.info().id;
    if (id == "host") return std::pair(nb::device::cpu::value, 0);
    constexpr std::string_view cuda = "cuda:";
    int number = 0;
    if (!id.starts_with(cuda)) return std::nullopt;
    std::from_chars(id.data() + cuda.size(), id.data() + id.size(), number);
    return std::pair(nb::device::cuda::value, number);
}

std::optional<GivenRows> given_rows(nb::handle value, std::size_t columns, const std::string& what,
                                    const Device& device) {
    if (value.is_none()) return std::nullopt;
    GivenRows given;
    if (nb::isinstance<nb::tuple>(value)) {
        given = of_interface(nb::cast<nb::tuple>(value));
    } else {
        auto array = nb::cast<Array>(value);
        given = of_array(array, columns, what, device);
        given.keeper = std::move(array);
    }
    check_aligned(given, what);
    return given;
}

/// A handle an array; all go at once when there are many, as with libraries that never use memory again.
Buffer DeviceInput::adopted(void* data, std::size_t bytes) {
    const auto found = adopted_.find({data, bytes});
    if (found != adopted_.end()) return found->second;
    if (adopted_.size() >= most_adopted) adopted_.clear();
    return adopted_[{data, bytes}] = device_.adopt(data, bytes, "rows of an application");
}

DeviceRows DeviceInput::uploaded(const void* data, std::size_t bytes, Precision precision, Upload& upload) {
    if (upload.buffer.bytes() < bytes) upload.buffer = device_.allocate(bytes, "rows of the host");
    const StageScope scope(device_, Stage::write);
    device_.upload(upload.buffer, {static_cast<const std::byte*>(data), bytes});
    upload.at_rest = false;
    return {upload.buffer, precision};
}

DeviceRows DeviceInput::rows_of(const GivenRows& given, std::size_t columns, Upload& upload) {
    const auto bytes = given.rows * columns * (given.precision == Precision::fp64 ? 8 : 4);
    if (!given.on_device) return uploaded(given.data, bytes, given.precision, upload);
    if (given.queue) device_.follow(*given.queue);
    return {adopted(given.data, bytes), given.precision};
}

DeviceRows DeviceInput::at_rest(std::size_t body) {
    auto& upload = uploads_[body];
    const auto& vertices = scene_.meshes[scene_.bodies[body].mesh].vertices;
    const auto bytes = vertices.size() * sizeof(vertices.front());
    if (!upload.at_rest) uploaded(vertices.data(), bytes, Precision::fp64, upload);
    upload.at_rest = true;
    return {upload.buffer, Precision::fp64};
}

const DeviceFrame& DeviceInput::frame(const std::optional<GivenRows>& poses,
                                      const std::vector<std::optional<GivenRows>>& vertices) {
    const auto bodies = scene_.bodies.size();
    frame_.deformed.resize(bodies);
    if (poses && poses->rows != bodies)
        throw InputError(
            fmt::format("poses: {} rows for {} bodies; give each body its row", poses->rows, bodies));
    frame_.poses = poses ? rows_of(*poses, pose_numbers, uploads_.back()) : DeviceRows{};
    for (std::size_t body = 0; body < bodies; ++body) {
        if (!scene_.bodies[body].deformable) continue;
        const auto count = scene_.meshes[scene_.bodies[body].mesh].vertices.size();
        const bool given = body < vertices.size() && vertices[body];
        if (given && vertices[body]->rows != count)
            throw InputError(fmt::format("vertices: {} rows for body {}, whose mesh has {} vertices",
                                         vertices[body]->rows, body, count));
        frame_.deformed[body] = given ? rows_of(*vertices[body], coordinates, uploads_[body]) : at_rest(body);
    }
    return frame_;
}

std::vector<std::uintptr_t> DeviceInput::addresses() const {
    const auto address = [](const DeviceRows& rows) {
        return reinterpret_cast<std::uintptr_t>(rows.buffer.native());
    };
    std::vector<std::uintptr_t> all{address(frame_.poses)};
    for (const auto& rows : frame_.deformed)
        if (rows.buffer) all.push_back(address(rows));
    return all;
}

} // namespace tandem::python
