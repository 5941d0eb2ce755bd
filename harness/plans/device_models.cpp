// SPDX-License-Identifier: MIT
#include "harness/plans/device_models.h"

#include "harness/program/processor_name.h"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace tandem {

namespace {

bool same_letter(char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
}

/// The text after the first colon; empty without one.
std::string_view after_backend(std::string_view word) {
    const auto colon = word.find(':');
    return colon == std::string_view::npos ? std::string_view() : word.substr(colon + 1);
}

} // namespace

std::string model_name(const DeviceInfo& info) { return info.id == "host" ? processor_name() : info.name; }

std::string_view backend_of(std::string_view name) { return name.substr(0, name.find(':')); }

bool asks_for_model(std::string_view word) {
    const auto text = after_backend(word);
    const bool is_number = std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
    return !text.empty() && !is_number && text != each_model;
}

bool is_of_model(const DeviceInfo& info, std::string_view word) {
    if (!asks_for_model(word) || backend_of(info.id) != backend_of(word)) return false;
    const auto model = model_name(info);
    const auto text = after_backend(word);
    // No std::ranges::search: clang 14 does not compile the one of g++ 12.
    return std::search(model.begin(), model.end(), text.begin(), text.end(), same_letter) != model.end();
}

bool asks_for_each(std::string_view word) { return word == each_model || after_backend(word) == each_model; }

bool is_among(const DeviceInfo& info, std::string_view each) {
    return each == each_model || backend_of(each) == backend_of(info.id);
}

/// Replaces '|', which separates the parts of a key.
std::string model_of(const DeviceInfo& info) {
    const auto backend = info.id.substr(0, info.id.find(':'));
    const bool is_host = backend == "host"; // has no driver: the compiler stands for it
    auto model = fmt::format("{}:{}{}, {}", backend, model_name(info),
                             info.is_gpu ? "" : fmt::format(" x{}", info.compute_units),
                             is_host ? info.compiler : info.driver);
    std::replace(model.begin(), model.end(), '|', '/');
    return model;
}

} // namespace tandem
