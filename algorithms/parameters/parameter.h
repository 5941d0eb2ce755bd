// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace tandem {

/// One row of the table of parameters: everything that is known of a setting, in one place. Parsing, listing,
/// kernel defines and records read it.
struct Parameter {
    /// A word that a setting takes, and the number that it stands for in code and kernels.
    struct Word {
        std::string_view text;
        std::int64_t value = 0;
    };

    std::string_view name;   ///< as --set and records have it
    std::string_view define; ///< what kernels call it; empty: it is the host's alone
    std::string_view help;
    std::int64_t initial = 0;
    std::int64_t least = 0, most = 0; ///< of an integer; both included
    std::array<Word, 12> words{};
    std::size_t word_count = 0; ///< 0: any integer from least to most
    std::array<std::int64_t, 4> alternative_values{};
    std::size_t alternative_count = 0;
    std::string_view alternative_setting; ///< the setting that says the same in another way; empty: none

    constexpr std::span<const Word> choices() const { return std::span(words).first(word_count); }
    /// Values worth trying for speed, where neither this nor alternative_setting is given; none of them
    /// changes an answer. Empty: it is the user's alone.
    constexpr std::span<const std::int64_t> alternatives() const {
        return std::span(alternative_values).first(alternative_count);
    }
    /// The value as --set takes it.
    std::string text(std::int64_t value) const;
    /// Throws InputError that names the allowed values. Integers may be written 10000000 or 1e7.
    std::int64_t parse(const std::string& text) const;
};

/// A value of a setting, as presets list them.
struct Assignment {
    const Parameter* parameter = nullptr;
    std::int64_t value = 0;
};

/// The least and the greatest value of an integer setting.
struct ValueRange {
    std::int64_t least = 0, most = 0;
};

/// A parameter whose values are a `T`: an enumeration, an integer or bool. Rows are constants; one whose
/// default is none of its choices, or which has two words for one value, does not compile.
template<class T>
struct Setting : Parameter {
    using Choices = std::initializer_list<std::pair<std::string_view, T>>;

    consteval Setting(std::string_view name_, T initial_, Choices choices_, std::string_view define_,
                      std::string_view help_) {
        set(name_, initial_, define_, help_);
        for (const auto& [word, value] : choices_) {
            for (const auto& other : choices())
                if (other.text == word || other.value == static_cast<std::int64_t>(value))
                    throw "a setting has a word or a value twice";
            words[word_count++] = {word, static_cast<std::int64_t>(value)};
        }
        for (const auto& word : choices())
            if (word.value == initial) return;
        throw "a setting's default is none of its choices";
    }

    consteval Setting(std::string_view name_, T initial_, ValueRange range, std::string_view define_,
                      std::string_view help_) {
        set(name_, initial_, define_, help_);
        least = range.least;
        most = range.most;
        if (initial < least || initial > most) throw "a setting's default is out of its range";
    }

    /// The same row with alternatives(), every one of them a value that it takes.
    consteval Setting with_alternatives(std::initializer_list<T> values,
                                        std::string_view other_way = {}) const {
        auto row = *this;
        row.alternative_setting = other_way;
        for (const auto value : values) {
            const auto number = static_cast<std::int64_t>(value);
            bool allowed = word_count == 0 && number >= least && number <= most;
            for (const auto& word : choices()) allowed = allowed || word.value == number;
            if (!allowed) throw "an alternative of a setting is no value of it";
            row.alternative_values[row.alternative_count++] = number;
        }
        return row;
    }

    Assignment operator()(T value) const { return {this, static_cast<std::int64_t>(value)}; }

private:
    consteval void set(std::string_view name_, T initial_, std::string_view define_, std::string_view help_) {
        if (name_.empty() || help_.empty()) throw "a setting needs a name and a help text";
        name = name_;
        define = define_;
        help = help_;
        initial = static_cast<std::int64_t>(initial_);
    }
};

/// Setting name -> value as text: what users give and records keep.
using SettingTexts = std::map<std::string, std::string>;

/// A value for every setting of an algorithm. Made by resolve().
class Settings {
public:
    Settings() = default;
    explicit Settings(std::span<const Parameter* const> parameters);

    /// The value of a setting; std::out_of_range when the algorithm has none of that name.
    template<class T>
    T operator[](const Setting<T>& setting) const {
        return static_cast<T>(values_.at(setting.name).value);
    }
    bool has(const Parameter& parameter) const { return values_.contains(parameter.name); }
    void set(const Assignment& assignment) { values_.at(assignment.parameter->name) = assignment; }

    /// The value of a setting as --set takes it; std::out_of_range for an unknown name.
    std::string text(std::string_view name) const;
    SettingTexts texts() const;
    bool empty() const { return values_.empty(); }
    bool operator==(const Settings& other) const { return texts() == other.texts(); }

private:
    std::map<std::string_view, Assignment> values_;
};

/// A named set of values; settings given by the user come on top.
struct Preset {
    std::string_view name;
    std::string_view help;
    std::vector<Assignment> values;

    SettingTexts texts() const;
};

/// `given` over `preset` over the defaults. Throws InputError for an unknown name (naming the nearest) or an
/// impossible value (naming the allowed ones).
Settings resolve(std::span<const Parameter* const> parameters, std::span<const Assignment> preset,
                 const SettingTexts& given, std::string_view algorithm);

/// Adds a value under the define of its setting, as the number that kernels know it by.
template<class T>
void define(std::map<std::string, std::string>& defines, const Setting<T>& setting,
            std::type_identity_t<T> value) {
    defines[std::string(setting.define)] = std::to_string(static_cast<std::int64_t>(value));
}

} // namespace tandem
