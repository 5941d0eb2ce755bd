// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <unordered_map>

namespace tandem::report {

using Json = nlohmann::ordered_json;

/// Values that occur again and again, each once: what refers to one is its number.
class Interned {
public:
    std::size_t number(const Json& value) {
        const auto [place, is_new] = numbers_.try_emplace(value.dump(), values_.size());
        if (is_new) {
            values_.push_back(value);
            bytes_ += place->first.size() + 1;
        }
        return place->second;
    }
    /// All, in order of their numbers.
    const Json& values() const { return values_; }
    /// Of all as text.
    std::size_t bytes() const { return bytes_; }

private:
    std::unordered_map<std::string, std::size_t> numbers_;
    Json values_ = Json::array();
    std::size_t bytes_ = 2;
};

/// Six digits: more than any time has.
double rounded(double value);

} // namespace tandem::report
