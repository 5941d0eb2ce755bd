// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tandem {

/// A setting an algorithm declares: name, default, and what it may be.
struct Parameter {
    std::string name;
    std::string initial;
    std::vector<std::string> choices; ///< the allowed words; empty for an integer in [least, most]
    std::int64_t least = 0;
    std::int64_t most = 0;
    std::string help;
};

/// Setting name -> value. Complete once resolve() has filled it in.
using Settings = std::map<std::string, std::string>;

/// A named set of values; settings given by the user come on top.
struct Preset {
    std::string name;
    std::string help;
    Settings values;
};

/// `given` over `preset` over the defaults. Throws InputError for an unknown name (naming the nearest) or an
/// impossible value (naming the allowed ones).
Settings resolve(std::span<const Parameter> parameters, const Settings& preset, const Settings& given,
                 std::string_view algorithm);

/// The value of an integer setting of a resolved map.
std::int64_t integer(const Settings& settings, const std::string& name);

} // namespace tandem
