// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tandem::read {

/// A start tag, or an end tag, whose name begins with '/'. Views into the file.
struct Tag {
    std::string_view name;
    std::size_t at = 0;      ///< position of '<'
    std::size_t content = 0; ///< position after '>'
    bool closed = false;     ///< <name/>: no content, no end tag
    std::vector<std::pair<std::string_view, std::string_view>> attributes = {};

    /// The value of an attribute; `fallback` when there is none.
    std::string_view get(std::string_view attribute, std::string_view fallback = "") const;
};

/// Reads the tags of an XML file written by VTK, without entities and CDATA.
class Xml {
public:
    Xml(std::string_view text, const std::string& source) : text_(text), source_(source) {}

    /// The next tag; skips text, comments and declarations.
    std::optional<Tag> next();
    /// Throws InputError with the line of byte `at`.
    [[noreturn]] void fail(std::size_t at, std::string_view what, std::string_view remedy) const;

    std::string_view text() const { return text_; }
    const std::string& source() const { return source_; }

private:
    std::size_t end_of_tag(std::size_t open) const;
    std::size_t find(std::string_view end, std::size_t from, std::size_t tag) const;
    void read_attributes(Tag& tag, std::string_view inside) const;

    std::string_view text_;
    std::string source_;
    std::size_t at_ = 0;
};

} // namespace tandem::read
