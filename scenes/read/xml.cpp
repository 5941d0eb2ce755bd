// SPDX-License-Identifier: MIT
#include "scenes/read/xml.h"

#include "base/error.h"
#include "scenes/read/scanner.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem::read {

namespace {

constexpr std::string_view blanks = " \t\r\n";

} // namespace

std::string_view Tag::get(std::string_view attribute, std::string_view fallback) const {
    const auto found = std::find_if(attributes.begin(), attributes.end(),
                                    [&](const auto& entry) { return entry.first == attribute; });
    return found == attributes.end() ? fallback : found->second;
}

void Xml::fail(std::size_t at, std::string_view what, std::string_view remedy) const {
    throw InputError(fmt::format("{}:{}: {}; {}", source_, line_of(text_, at), what, remedy));
}

std::size_t Xml::find(std::string_view end, std::size_t from, std::size_t tag) const {
    const auto at = text_.find(end, from);
    if (at == std::string_view::npos)
        fail(tag, fmt::format("a tag without '{}'", end), "the file is truncated: copy or export it again");
    return at;
}

/// The '>' of the tag at `open`. Values in quotes may contain others.
std::size_t Xml::end_of_tag(std::size_t open) const {
    for (auto at = open;;) {
        const auto stop = text_.find_first_of(">\"'", at);
        if (stop == std::string_view::npos || text_[stop] == '>') return find(">", at, open);
        at = find(text_.substr(stop, 1), stop + 1, open) + 1;
    }
}

/// Skips comments, declarations and processing instructions.
std::optional<Tag> Xml::next() {
    while (true) {
        const auto open = text_.find('<', at_);
        if (open == std::string_view::npos) return std::nullopt;
        const auto rest = text_.substr(open);
        if (rest.starts_with("<!--")) {
            at_ = find("-->", open, open) + 3;
        } else if (rest.starts_with("<?") || rest.starts_with("<!")) {
            at_ = find(">", open, open) + 1;
        } else {
            const auto close = end_of_tag(open);
            at_ = close + 1;
            Tag tag{"", open, at_, text_[close - 1] == '/'};
            read_attributes(tag, text_.substr(open + 1, close - open - 1 - (tag.closed ? 1 : 0)));
            return tag;
        }
    }
}

/// Accepts single and double quotes. Entities are not decoded, since names and numbers of the format have
/// none.
void Xml::read_attributes(Tag& tag, std::string_view inside) const {
    auto at = std::min(inside.find_first_of(blanks), inside.size());
    tag.name = inside.substr(0, at);
    while ((at = inside.find_first_not_of(blanks, at)) != std::string_view::npos) {
        const auto equals = inside.find('=', at);
        const auto open = equals == std::string_view::npos ? equals : inside.find_first_of("\"'", equals);
        const auto close = open == std::string_view::npos ? open : inside.find(inside[open], open + 1);
        if (close == std::string_view::npos)
            fail(tag.at, fmt::format("tag {} has a broken attribute", in_quotes(tag.name)),
                 "export the file again");
        const auto name = inside.substr(at, equals - at);
        tag.attributes.emplace_back(name.substr(0, name.find_last_not_of(blanks) + 1),
                                    inside.substr(open + 1, close - open - 1));
        at = close + 1;
    }
}

} // namespace tandem::read
