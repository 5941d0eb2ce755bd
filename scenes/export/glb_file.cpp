// SPDX-License-Identifier: MIT
#include "scenes/export/glb_file.h"

#include "scenes/recording/bytes.h"

#include <algorithm>
#include <array>

namespace tandem::exporting {

namespace {

using Json = nlohmann::json;

constexpr int type_float = 5126, type_unsigned_int = 5125;
constexpr int target_vertices = 34962, target_indices = 34963, no_target = 0;
constexpr std::array<const char*, 5> type_names{"", "SCALAR", "VEC2", "VEC3", "VEC4"};

/// Minimum or maximum of each component, as JSON numbers that equal the floats exactly.
template<class Choose>
Json bound(std::span<const float> values, std::size_t components, Choose choose) {
    std::vector<double> bounds;
    for (std::size_t c = 0; c < components; ++c) {
        float best = values[c];
        for (std::size_t i = c; i < values.size(); i += components) best = choose(best, values[i]);
        bounds.push_back(static_cast<double>(best));
    }
    return bounds;
}

/// Appends a chunk. Sizes are multiples of 4 bytes: text is padded with blanks, data with zeros (glTF 2.0,
/// section 4.4.3).
void put_chunk(std::string& out, std::string_view type, std::string bytes, char padding) {
    while (bytes.size() % 4 != 0) bytes.push_back(padding);
    recording::put(out, static_cast<std::uint32_t>(bytes.size()));
    out += type;
    out += bytes;
}

} // namespace

GlbFile::GlbFile() { json_["asset"] = {{"version", "2.0"}, {"generator", "tandem"}}; }

std::size_t GlbFile::add(const char* array, Json object) {
    json_[array].push_back(std::move(object));
    return json_[array].size() - 1;
}

/// Adds a view from `offset` to the present end of the data.
std::size_t GlbFile::view(std::size_t offset, int target) {
    Json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", binary_.size() - offset}};
    if (target != no_target) view["target"] = target;
    return add("bufferViews", std::move(view));
}

/// Bounds are required for positions and for times of an animation, and allowed for other accessors.
std::size_t GlbFile::floats(std::span<const float> values, std::size_t components, bool vertices) {
    const auto offset = binary_.size();
    for (const float value : values) recording::put_float(binary_, value);
    return add("accessors",
               {{"bufferView", view(offset, vertices ? target_vertices : no_target)},
                {"componentType", type_float},
                {"count", values.size() / components},
                {"type", type_names[components]},
                {"min", bound(values, components, [](float a, float b) { return std::min(a, b); })},
                {"max", bound(values, components, [](float a, float b) { return std::max(a, b); })}});
}

std::size_t GlbFile::indices(std::span<const std::uint32_t> values) {
    const auto offset = binary_.size();
    for (const auto value : values) recording::put(binary_, value);
    return add("accessors", {{"bufferView", view(offset, target_indices)},
                             {"componentType", type_unsigned_int},
                             {"count", values.size()},
                             {"type", "SCALAR"}});
}

std::string GlbFile::finish() {
    json_["buffers"] = {{{"byteLength", binary_.size()}}};
    std::string chunks;
    put_chunk(chunks, "JSON", json_.dump(), ' ');
    put_chunk(chunks, std::string_view("BIN\0", 4), std::move(binary_), '\0');
    std::string out = "glTF";
    recording::put(out, std::uint32_t{2});
    recording::put(out, static_cast<std::uint32_t>(out.size() + 4 + chunks.size()));
    return out + chunks;
}

} // namespace tandem::exporting
