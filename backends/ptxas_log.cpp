// SPDX-License-Identifier: MIT
#include "backends/ptxas_log.h"

#include <charconv>
#include <fmt/format.h>

namespace tandem {

namespace {

/// The number before the first `word` at or after `from` in `text`; -1 when there is none.
std::int64_t number_before(std::string_view text, std::string_view word, std::size_t from) {
    const auto at = text.find(word, from);
    if (at == std::string_view::npos) return -1;
    auto begin = at;
    while (begin > 0 && text[begin - 1] == ' ') --begin;
    const auto end = begin;
    while (begin > 0 && text[begin - 1] >= '0' && text[begin - 1] <= '9') --begin;
    std::int64_t value = -1;
    std::from_chars(text.data() + begin, text.data() + end, value);
    return value;
}

} // namespace

EntryUse use_of(std::string_view log, std::string_view entry) {
    const auto begin = log.find(fmt::format("Compiling entry function '{}'", entry));
    if (begin == std::string_view::npos) return {};
    const auto end = log.find("Compiling entry function", begin + 1);
    const auto part = log.substr(begin, end == std::string_view::npos ? end : end - begin);
    EntryUse use;
    use.registers = number_before(part, "registers", 0);
    use.stack_bytes = number_before(part, "bytes stack frame", 0);
    const auto stores = number_before(part, "bytes spill stores", 0);
    const auto loads = number_before(part, "bytes spill loads", 0);
    if (stores >= 0 && loads >= 0) use.spill_bytes = stores + loads;
    return use;
}

} // namespace tandem
