// SPDX-License-Identifier: MIT
#pragma once

#include "scenes/read/cursor.h"
#include "scenes/read/scanner.h"
#include "scenes/read/vtk_cells.h"
#include "scenes/read/xml.h"

#include <fmt/format.h>

namespace tandem::read {

struct Compressor;

/// The data arrays of a .vtu file: text, base64 or raw binary; inline or appended; compressed or not.
class VtuData {
public:
    /// `file` is the tag VTKFile.
    VtuData(const Xml& xml, const Tag& file);

    /// Sets the tag AppendedData, to which arrays refer by offset.
    void set_appended(const Tag& tag);
    /// Runs body(In&, Number) on the numbers of a DataArray. Fails when numbers remain unread.
    template<class Body>
    void with_array(const Tag& array, Body body) const;

private:
    /// A block as stored in the file: base64 or raw.
    struct Block {
        std::string_view stored;
        bool base64;
        std::size_t tag; ///< position of the array's tag, for errors
    };

    Number type_of(const Tag& array) const;
    std::size_t end_of(const Tag& array) const;
    Block block_of(const Tag& array) const;
    std::string head(const Block& block, std::uint64_t bytes) const;
    std::uint64_t header_value(std::string_view data, std::size_t i) const;
    std::string decode(const Block& block) const;
    std::string inflate(const Block& block) const;

    const Xml& xml_;
    std::endian order_ = std::endian::little;
    std::size_t header_size_ = 4;
    const Compressor* compressor_ = nullptr; ///< null: not compressed
    std::size_t appended_ = 0;               ///< position of the first byte after '_'; 0: no AppendedData
    bool appended_base64_ = false;
};

template<class Body>
void VtuData::with_array(const Tag& array, Body body) const {
    const auto type = type_of(array);
    if (array.get("format") == "ascii") {
        Scanner in(xml_.text().substr(0, end_of(array)), xml_.source(), '\0', array.content);
        body(in, type);
        if (!in.done()) in.fail("more numbers than announced", "correct the counts of Piece");
        return;
    }
    const auto data = decode(block_of(array));
    Cursor in(data,
              fmt::format("{}:{}: DataArray {}", xml_.source(), line_of(xml_.text(), array.at),
                          in_quotes(array.get("Name"))),
              0, order_);
    body(in, type);
    if (!in.done()) in.fail("more numbers than announced", "correct the counts of Piece");
}

} // namespace tandem::read
