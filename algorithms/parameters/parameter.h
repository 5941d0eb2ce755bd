// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace tandem {

/// One row of the table of parameters: the complete description of a setting. Parsing, listings, kernel
/// defines and records use it.
struct Parameter {
    /// A word that is a value of a setting, and its number in code and kernels.
    struct Word {
        std::string_view text;  ///< in --set and in records
        std::int64_t value = 0; ///< in code and in kernels
    };

    std::string_view name;                            ///< in --set and in records
    std::string_view define;                          ///< name in kernels; empty: kernels do not use it
    std::string_view help;                            ///< explanation for listings, not empty
    std::int64_t initial = 0;                         ///< default value
    std::int64_t least = 0,                           ///< lowest value of an integer
        most = 0;                                     ///< highest value of an integer
    double longest = 0;                               ///< highest value of a length, which is at least 0
    std::array<Word, 12> words{};                     ///< the first word_count are in use
    std::size_t word_count = 0;                       ///< 0: integers or lengths only
    std::array<std::int64_t, 4> alternative_values{}; ///< the first alternative_count are in use
    std::size_t alternative_count = 0;                ///< at most 4

    /// The words that are values; empty if only integers are.
    constexpr std::span<const Word> choices() const { return std::span(words).first(word_count); }
    /// Whether lengths from 0 to `longest` are values; a value in code is then the bits of a double.
    constexpr bool is_length() const { return longest > 0; }
    /// Whether integers from least to most are values.
    constexpr bool takes_integers() const { return !is_length() && (least != most || word_count == 0); }
    /// Values that `--algorithm auto` tries for speed when the setting is not given.
    /// Combinations that change the answer are left out. Empty: only the user sets it.
    constexpr std::span<const std::int64_t> alternatives() const {
        return std::span(alternative_values).first(alternative_count);
    }
    /// The value in the form that --set accepts.
    std::string text(std::int64_t value) const;
    /// Accepts a word, an integer such as 10000000 or 1e7, or a length such as 0.01. Throws InputError that
    /// lists the allowed values.
    std::int64_t parse(const std::string& text) const;

private:
    std::int64_t parse_length(const std::string& text) const;
};

/// A setting with a value, as listed in presets.
struct Assignment {
    const Parameter* parameter = nullptr; ///< must outlive the assignment
    std::int64_t value = 0;               ///< a word's number, or an integer
};

/// The least and the greatest value of an integer setting.
struct ValueRange {
    std::int64_t least = 0, ///< included
        most = 0;           ///< included
};

/// The number that stands for a value in a Parameter.
template<class T>
constexpr std::int64_t number_of(T value) {
    if constexpr (std::is_same_v<T, double>)
        return std::bit_cast<std::int64_t>(value);
    else
        return static_cast<std::int64_t>(value);
}

/// A parameter with values of type T: an enumeration, an integer, bool, or double for a length. Rows are
/// constants. A default that is not a choice, or a duplicate word or value, is a compile error.
template<class T>
struct Setting : Parameter {
    /// Words with their values, in the order of listings; at most 12.
    using Choices = std::initializer_list<std::pair<std::string_view, T>>;

    /// A setting whose values are words. Name and help must not be empty.
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

    /// An integer setting. Name and help must not be empty.
    consteval Setting(std::string_view name_, T initial_, ValueRange range, std::string_view define_,
                      std::string_view help_) {
        set(name_, initial_, define_, help_);
        least = range.least;
        most = range.most;
        if (initial < least || initial > most) throw "a setting's default is out of its range";
    }

    /// A length from 0, its default, to `longest`. Name and help must not be empty.
    consteval Setting(std::string_view name_, double longest_, std::string_view define_,
                      std::string_view help_) requires std::is_same_v<T, double> {
        set(name_, 0, define_, help_);
        longest = longest_;
    }

    /// The same row of an integer setting with a word for a value out of its range.
    consteval Setting with_word(std::string_view word, T value) const {
        auto row = *this;
        const auto number = static_cast<std::int64_t>(value);
        if (!takes_integers() || (number >= least && number <= most)) throw "a word stands for an integer";
        row.words[row.word_count++] = {word, number};
        return row;
    }

    /// The same row with alternatives(), which must be allowed values.
    consteval Setting with_alternatives(std::initializer_list<T> values) const {
        auto row = *this;
        for (const auto value : values) {
            const auto number = static_cast<std::int64_t>(value);
            bool allowed = takes_integers() && number >= least && number <= most;
            for (const auto& word : choices()) allowed = allowed || word.value == number;
            if (!allowed) throw "an alternative of a setting is no value of it";
            row.alternative_values[row.alternative_count++] = number;
        }
        return row;
    }

    /// The setting with this value, which is not checked. The setting must outlive the result.
    Assignment operator()(T value) const { return {this, number_of(value)}; }

private:
    consteval void set(std::string_view name_, T initial_, std::string_view define_, std::string_view help_) {
        if (name_.empty() || help_.empty()) throw "a setting needs a name and a help text";
        name = name_;
        define = define_;
        help = help_;
        initial = number_of(initial_);
    }
};

/// Value as text by setting name, as users give them and records store them.
using SettingTexts = std::map<std::string, std::string>;

/// A value for every setting of an algorithm; resolve() makes it.
class Settings {
public:
    Settings() = default;
    /// The defaults of these parameters, which must outlive the settings.
    explicit Settings(std::span<const Parameter* const> parameters);

    /// The value of a setting. Throws std::out_of_range if the algorithm does not have the setting.
    template<class T>
    T operator[](const Setting<T>& setting) const {
        const auto number = values_.at(setting.name).value;
        if constexpr (std::is_same_v<T, double>)
            return std::bit_cast<double>(number);
        else
            return static_cast<T>(number);
    }
    /// Whether the algorithm has the setting.
    bool has(const Parameter& parameter) const { return values_.contains(parameter.name); }
    /// Changes a value, which is not checked. Throws std::out_of_range if the algorithm does not have the
    /// setting.
    void set(const Assignment& assignment) { values_.at(assignment.parameter->name) = assignment; }

    /// The value of a setting in the form that --set accepts. Throws std::out_of_range for an unknown name.
    std::string text(std::string_view name) const;
    /// All settings, with their values in the form that --set accepts.
    SettingTexts texts() const;
    bool empty() const { return values_.empty(); } ///< true without settings, as by default
    /// Whether both have the same settings with the same values.
    bool operator==(const Settings& other) const { return texts() == other.texts(); }

private:
    std::map<std::string_view, Assignment> values_;
};

/// A named set of values. Settings given by the user override it.
struct Preset {
    std::string_view name;             ///< in options and records; unique within an algorithm
    std::string_view help;             ///< explanation for listings
    std::vector<Assignment> values;    ///< of the settings that it changes
    std::string_view title = {};       ///< name of the method for people (title_of); unique among all methods
    std::string_view former_name = {}; ///< before record schema 4; empty: the same
    bool reproduces = false;           ///< a program of others, with its contact rule (Traversal::settings)

    /// `values` in the form that --set accepts.
    SettingTexts texts() const;
};

/// Combines settings: `given` overrides `preset`, which overrides the defaults. Throws InputError for an
/// unknown name (with the nearest one) or an impossible value (with the allowed ones).
Settings resolve(std::span<const Parameter* const> parameters, std::span<const Assignment> preset,
                 const SettingTexts& given, std::string_view algorithm);

/// Adds the number of a value to the defines, under the define of its setting.
template<class T>
void define(std::map<std::string, std::string>& defines, const Setting<T>& setting,
            std::type_identity_t<T> value) {
    defines[std::string(setting.define)] = std::to_string(static_cast<std::int64_t>(value));
}

} // namespace tandem
