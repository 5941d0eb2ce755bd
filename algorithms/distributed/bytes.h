// SPDX-License-Identifier: MIT
// Messages between ranks of one build: values in their memory representation, one after the other.
#pragma once

#include "backends/ranks.h"

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace tandem {

template<class T>
void append(Ranks::Bytes& message, std::span<T> values) {
    const auto bytes = std::as_bytes(values);
    message.insert(message.end(), bytes.begin(), bytes.end());
}

template<class T>
Ranks::Bytes as_message(std::span<T> values) {
    Ranks::Bytes message;
    append(message, values);
    return message;
}

/// Reads values in the order in which append() wrote them. Throws RanksError when the message is too short.
class MessageReader {
public:
    explicit MessageReader(std::span<const std::byte> message) : rest_(message) {}

    template<class T>
    void read(std::span<T> values) {
        const auto bytes = values.size_bytes();
        if (bytes > rest_.size())
            throw RanksError("a message from another rank is too short; run the same build on all ranks");
        if (bytes > 0) std::memcpy(static_cast<void*>(values.data()), rest_.data(), bytes);
        rest_ = rest_.subspan(bytes);
    }
    template<class T>
    T read() {
        T value{};
        read(std::span(&value, 1));
        return value;
    }
    std::string read_text() {
        std::string text(read<std::uint64_t>(), ' ');
        read(std::span(text));
        return text;
    }
    bool is_at_end() const { return rest_.empty(); }

private:
    std::span<const std::byte> rest_;
};

inline void append_text(Ranks::Bytes& message, std::string_view text) {
    const std::uint64_t size = text.size();
    append(message, std::span(&size, 1));
    append(message, std::span(text));
}

template<class T>
std::vector<T> from_message(std::span<const std::byte> message) {
    std::vector<T> values(message.size() / sizeof(T));
    MessageReader(message).read(std::span(values));
    return values;
}

} // namespace tandem
