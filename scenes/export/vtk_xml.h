// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace tandem::exporting {

/// Builds the text of a VTK XML file. Arrays are compressed and in base64, so that the file is valid XML.
class VtkXml {
public:
    /// `type` of the root element: UnstructuredGrid or PolyData.
    explicit VtkXml(std::string_view type);

    /// Opens an element with its attributes: "Points", or "Piece NumberOfPoints=\"4\"".
    void open(std::string_view element);
    void close();
    /// Adds an array with `components` numbers an item.
    void array(std::string_view name, std::size_t components, std::span<const float> values);
    void array(std::string_view name, std::size_t components, std::span<const double> values);
    void array(std::string_view name, std::size_t components, std::span<const std::uint32_t> values);
    void array(std::string_view name, std::size_t components, std::span<const std::int64_t> values);
    void array(std::string_view name, std::size_t components, std::span<const std::uint8_t> values);

    /// Closes all elements and returns the complete file.
    std::string finish();

private:
    template<class T>
    void add(std::string_view name, std::string_view type, std::size_t components, std::span<const T> values);

    std::string text_;
    std::string open_; ///< names of open elements, outermost first, each followed by a blank
};

} // namespace tandem::exporting
