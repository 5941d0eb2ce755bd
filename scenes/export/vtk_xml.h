// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace tandem::exporting {

/// The text of one of VTK's XML files, whose arrays are compressed and in base64, so that it stays XML.
class VtkXml {
public:
    /// `type` as in the root element: UnstructuredGrid, PolyData.
    explicit VtkXml(std::string_view type);

    /// An element as written: "Points", or "Piece NumberOfPoints=\"4\"".
    void open(std::string_view element);
    void close();
    /// An array of `components` numbers an item.
    void array(std::string_view name, std::size_t components, std::span<const float> values);
    void array(std::string_view name, std::size_t components, std::span<const std::uint32_t> values);
    void array(std::string_view name, std::size_t components, std::span<const std::int64_t> values);
    void array(std::string_view name, std::size_t components, std::span<const std::uint8_t> values);

    /// The whole file, every element closed.
    std::string finish();

private:
    template<class T>
    void add(std::string_view name, std::string_view type, std::size_t components, std::span<const T> values);

    std::string text_;
    std::string open_; ///< names of open elements, outermost first, each ended by a blank
};

} // namespace tandem::exporting
