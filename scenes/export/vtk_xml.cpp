// SPDX-License-Identifier: MIT
#include "scenes/export/vtk_xml.h"

#include "base/base64.h"
#include "scenes/recording/bytes.h"

#include <fmt/format.h>
#include <stdexcept>
#include <zlib.h>

namespace tandem::exporting {

namespace {

/// Compresses to a zlib stream, the format of vtkZLibDataCompressor.
std::string deflated(std::string_view bytes) {
    auto size = compressBound(bytes.size());
    std::string out(size, '\0');
    constexpr int fast = 1;
    if (compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                  bytes.size(), fast)
        != Z_OK)
        throw std::bad_alloc(); // the only failure of compress2 with a sufficient buffer
    out.resize(size);
    return out;
}

/// VTK's layout: number of parts, size of a part, size of the last part if smaller, compressed sizes, data.
/// Header and data are separate base64 texts.
std::string encoded(std::string_view bytes) {
    constexpr std::size_t part = 1 << 20;
    std::string header, data;
    const auto parts = (bytes.size() + part - 1) / part;
    recording::put(header, std::uint64_t{parts});
    recording::put(header, std::uint64_t{part});
    recording::put(header, std::uint64_t{bytes.size() % part});
    for (std::size_t i = 0; i < parts; ++i) {
        const auto packed = deflated(bytes.substr(i * part, part));
        recording::put(header, std::uint64_t{packed.size()});
        data += packed;
    }
    return base64::encode(header) + base64::encode(data);
}

void put_number(std::string& out, float value) { recording::put_float(out, value); }
void put_number(std::string& out, double value) { recording::put_double(out, value); }
void put_number(std::string& out, std::int64_t value) {
    recording::put(out, static_cast<std::uint64_t>(value));
}
void put_number(std::string& out, std::uint32_t value) { recording::put(out, value); }
void put_number(std::string& out, std::uint8_t value) { recording::put(out, value); }

} // namespace

VtkXml::VtkXml(std::string_view type) {
    text_ = "<?xml version=\"1.0\"?>\n";
    open(fmt::format("VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
                     "compressor=\"vtkZLibDataCompressor\"",
                     type));
}

void VtkXml::open(std::string_view element) {
    text_ += fmt::format("<{}>\n", element);
    open_ += fmt::format("{} ", element.substr(0, element.find(' ')));
}

void VtkXml::close() {
    open_.pop_back();
    const auto start = open_.rfind(' ') + 1; // npos + 1 is 0: the root
    text_ += fmt::format("</{}>\n", open_.substr(start));
    open_.resize(start);
}

template<class T>
void VtkXml::add(std::string_view name, std::string_view type, std::size_t components,
                 std::span<const T> values) {
    std::string bytes;
    bytes.reserve(values.size_bytes());
    for (const T value : values) put_number(bytes, value);
    text_ +=
        fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">\n{}\n"
                    "</DataArray>\n",
                    type, name, components, encoded(bytes));
}

void VtkXml::array(std::string_view name, std::size_t components, std::span<const float> values) {
    add(name, "Float32", components, values);
}

void VtkXml::array(std::string_view name, std::size_t components, std::span<const double> values) {
    add(name, "Float64", components, values);
}

void VtkXml::array(std::string_view name, std::size_t components, std::span<const std::uint32_t> values) {
    add(name, "UInt32", components, values);
}

void VtkXml::array(std::string_view name, std::size_t components, std::span<const std::int64_t> values) {
    add(name, "Int64", components, values);
}

void VtkXml::array(std::string_view name, std::size_t components, std::span<const std::uint8_t> values) {
    add(name, "UInt8", components, values);
}

std::string VtkXml::finish() {
    while (!open_.empty()) close();
    return std::move(text_);
}

} // namespace tandem::exporting
