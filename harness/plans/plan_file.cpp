// SPDX-License-Identifier: MIT
#include "harness/plans/plan_file.h"

#include "harness/plans/ranges.h"
#include "scenes/description/describe.h"
#include "base/error.h"
#include "base/read_json.h"

#include <algorithm>
#include <filesystem>
#include <limits>

namespace tandem {

namespace {

using namespace description;
using Texts = std::vector<std::string>;

const Texts product_fields{"scenes", "frames", "algorithms", "presets", "settings", "devices"};

/// Options with a value of `tandem run` that a plan may give.
const Texts valued{"noise",      "seconds", "repeat",  "seed",       "truth", "truth-contacts",
                   "degenerate", "memory",  "timeout", "duplicates", "weld",  "pressure"};
const Texts flags{"no-check", "no-count", "check-afresh", "isolate", "corners", "only-tetrahedra"};

/// The string, or a number as a user would write it.
std::string scalar(const Json& json, const JsonLocation& location) {
    if (json.is_string()) {
        if (json.get<std::string>().empty()) location.fail("is empty");
        return json.get<std::string>();
    }
    if (json.is_number_integer()) return json.dump();
    if (!json.is_number()) location.fail("must be a string or a number");
    return fmt::format("{}", number(json, location));
}

/// One string or number, or a non-empty list of them.
Texts scalars(const Json& json, const JsonLocation& location) {
    if (!json.is_array()) return {scalar(json, location)};
    if (json.empty()) location.fail("is an empty list; add a value or leave the field out");
    Texts texts;
    for (std::size_t i = 0; i < json.size(); ++i) texts.push_back(scalar(json[i], location / i));
    return texts;
}

Texts expanded(const Texts& values, const JsonLocation& location) {
    Texts all;
    for (const auto& value : values)
        for (auto& each : expand_range(value, location.text())) all.push_back(std::move(each));
    return all;
}

/// Replaces settings by name; null removes a setting of the plan.
void read_sets(const Json& json, const JsonLocation& location, Request& request) {
    if (!json.is_object()) location.fail("must be an object: a value, or a list of them, for each setting");
    for (const auto& [name, value] : json.items()) {
        const auto removed =
            std::erase_if(request.sets, [&name = name](const auto& set) { return set.first == name; });
        if (value.is_null() && removed == 0)
            (location / name).fail("is null, but the plan has no such setting to remove");
        if (!value.is_null())
            request.sets.emplace_back(name, expanded(scalars(value, location / name), location / name));
    }
}

Texts scene_texts(const Texts& given, const std::filesystem::path& folder) {
    Texts scenes;
    for (const auto& text : given) {
        const bool is_file = text.ends_with(".json") || text.ends_with(".frames");
        scenes.push_back(is_file ? (folder / text).lexically_normal().string() : text);
    }
    return scenes;
}

/// A copy of `base` with the fields of the JSON object replaced.
Product read_product(const Json& json, const JsonLocation& location, const Product& base) {
    auto product = base;
    const auto read = [&](const char* name, Texts& texts) {
        if (json.contains(name)) texts = scalars(json[name], location / name);
    };
    if (json.contains("scenes"))
        product.scenes = scene_texts(scalars(json["scenes"], location / "scenes"),
                                     std::filesystem::path(location.file).parent_path());
    read("frames", product.frames);
    for (auto& frames : product.frames) // "5:5" is frame 5
        if (const auto colon = frames.find(':');
            colon != std::string::npos && frames.substr(0, colon) == frames.substr(colon + 1))
            frames.resize(colon);
    read("algorithms", product.request.algorithms);
    read("presets", product.request.presets);
    read("devices", product.request.devices);
    if (json.contains("settings")) read_sets(json["settings"], location / "settings", product.request);
    return product;
}

const Json& list(const Json& json, const char* name, const JsonLocation& location) {
    static const Json none = Json::array();
    if (!json.contains(name)) return none;
    if (!json[name].is_array() || json[name].empty())
        (location / name).fail("must be a list that is not empty");
    return json[name];
}

void read_products(const Json& json, const JsonLocation& root, PlanFile& plan) {
    const auto base = read_product(json, root, {});
    if (!base.scenes.empty()) plan.products.push_back(base);
    const auto& more = list(json, "include", root);
    for (std::size_t i = 0; i < more.size(); ++i) {
        const auto location = root / "include" / i;
        check_names(more[i], location, product_fields);
        plan.products.push_back(read_product(more[i], location, base));
        if (plan.products.back().scenes.empty())
            location.fail("has no scenes, and the plan has none; add \"scenes\"");
    }
    if (plan.products.empty()) root.fail("has no scenes; name some in \"scenes\", or in \"include\"");
}

void read_exclusions(const Json& json, const JsonLocation& root, PlanFile& plan) {
    const auto& all = list(json, "exclude", root);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto location = root / "exclude" / i;
        check_names(all[i], location, product_fields);
        if (all[i].empty()) location.fail("matches every cell; name at least one field");
        plan.exclusions.push_back({read_product(all[i], location, {}), location.text()});
    }
}

void read_measure(const Json& json, const JsonLocation& location, PlanFile& plan) {
    auto known = valued;
    known.insert(known.end(), flags.begin(), flags.end());
    check_names(json, location, known);
    for (const auto& [name, value] : json.items()) {
        const bool is_flag = std::ranges::find(flags, name) != flags.end();
        if (!is_flag)
            plan.measure.emplace_back(name, scalar(value, location / name));
        else if (flag(json, name.c_str(), location))
            plan.measure.emplace_back(name, "");
    }
}

} // namespace

/// Invalid JSON is no error here: the reader of scenes reports it.
bool is_plan(const std::string& path) {
    if (!path.ends_with(".json") || std::filesystem::is_directory(path)) return false;
    try {
        const auto json = read_json(path, "plan");
        return json.is_object() && json.contains("plan");
    } catch (const InputError&) {
        return false;
    }
}

PlanFile read_plan(const std::string& path) {
    const auto json = read_json(path, "plan");
    const JsonLocation root{path, {}};
    auto known = product_fields;
    for (const auto* name : {"plan", "include", "exclude", "impossible", "measure"}) known.emplace_back(name);
    check_names(json, root, known);
    PlanFile plan;
    plan.name = text(json.at("plan"), root / "plan");
    if (plan.name.empty()) (root / "plan").fail("is empty; describe in a few words what is measured");
    read_products(json, root, plan);
    read_exclusions(json, root, plan);
    if (json.contains("impossible"))
        plan.skips_impossible =
            choice(json["impossible"], root / "impossible", "word", {"refuse", "skip"}) == 1;
    if (json.contains("measure")) read_measure(json["measure"], root / "measure", plan);
    return plan;
}

} // namespace tandem
