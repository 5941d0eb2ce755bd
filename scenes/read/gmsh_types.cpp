// SPDX-License-Identifier: MIT
#include "scenes/read/gmsh.h"

#include <algorithm>
#include <array>

namespace tandem::read {

namespace {

/// Gmsh reference manual, "MSH file format": id, dimension, nodes, name.
constexpr std::array types = {
    ElementType{1, 1, 2, "2-node line"},
    ElementType{2, 2, 3, "3-node triangle"},
    ElementType{3, 2, 4, "4-node quadrangle"},
    ElementType{4, 3, 4, "4-node tetrahedron"},
    ElementType{5, 3, 8, "8-node hexahedron"},
    ElementType{6, 3, 6, "6-node prism"},
    ElementType{7, 3, 5, "5-node pyramid"},
    ElementType{8, 1, 3, "3-node line"},
    ElementType{9, 2, 6, "6-node triangle"},
    ElementType{10, 2, 9, "9-node quadrangle"},
    ElementType{11, 3, 10, "10-node second-order tetrahedron"},
    ElementType{12, 3, 27, "27-node hexahedron"},
    ElementType{13, 3, 18, "18-node prism"},
    ElementType{14, 3, 14, "14-node pyramid"},
    ElementType{15, 0, 1, "point"},
    ElementType{16, 2, 8, "8-node quadrangle"},
    ElementType{17, 3, 20, "20-node hexahedron"},
    ElementType{18, 3, 15, "15-node prism"},
    ElementType{19, 3, 13, "13-node pyramid"},
    ElementType{20, 2, 9, "9-node triangle"},
    ElementType{21, 2, 10, "10-node triangle"},
    ElementType{22, 2, 12, "12-node triangle"},
    ElementType{23, 2, 15, "15-node triangle"},
    ElementType{24, 2, 15, "15-node incomplete triangle"},
    ElementType{25, 2, 21, "21-node triangle"},
    ElementType{26, 1, 4, "4-node line"},
    ElementType{27, 1, 5, "5-node line"},
    ElementType{28, 1, 6, "6-node line"},
    ElementType{29, 3, 20, "20-node third-order tetrahedron"},
    ElementType{30, 3, 35, "35-node fourth-order tetrahedron"},
    ElementType{31, 3, 56, "56-node fifth-order tetrahedron"},
    ElementType{92, 3, 64, "64-node hexahedron"},
    ElementType{93, 3, 125, "125-node hexahedron"},
};

} // namespace

std::optional<ElementType> element_type(int id) {
    const auto found =
        std::find_if(types.begin(), types.end(), [&](const ElementType& t) { return t.id == id; });
    return found == types.end() ? std::nullopt : std::optional(*found);
}

void NodeTags::add(std::uint64_t tag) {
    consecutive_ = consecutive_ && (tags_.empty() || tag == tags_.back() + 1);
    tags_.push_back(tag);
}

/// Builds the sorted table of tags and returns the first duplicate. Consecutive tags, as in most files, need
/// no table.
std::optional<std::uint64_t> NodeTags::index() {
    if (consecutive_) return std::nullopt;
    sorted_.reserve(tags_.size());
    for (std::uint32_t i = 0; i < tags_.size(); ++i) sorted_.emplace_back(tags_[i], i);
    std::sort(sorted_.begin(), sorted_.end());
    const auto duplicate = std::adjacent_find(
        sorted_.begin(), sorted_.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
    return duplicate == sorted_.end() ? std::nullopt : std::optional(duplicate->first);
}

std::optional<std::uint32_t> NodeTags::find(std::uint64_t tag) const {
    if (tags_.empty()) return std::nullopt;
    if (consecutive_) {
        const auto offset = tag - tags_.front(); // wraps to a large number below the first tag
        return offset < tags_.size() ? std::optional(static_cast<std::uint32_t>(offset)) : std::nullopt;
    }
    const auto at = std::lower_bound(sorted_.begin(), sorted_.end(), tag,
                                     [](const auto& entry, std::uint64_t t) { return entry.first < t; });
    return at != sorted_.end() && at->first == tag ? std::optional(at->second) : std::nullopt;
}

} // namespace tandem::read
