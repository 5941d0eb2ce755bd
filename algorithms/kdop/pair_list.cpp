// SPDX-License-Identifier: MIT
#include "algorithms/kdop/pair_list.h"

#include "algorithms/sources.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::uint32_t found = 15; ///< all bits of pair_list.cl

/// Tetrahedron in input order -> its position in Morton order.
std::vector<std::uint32_t> positions(const std::vector<std::uint32_t>& ids) {
    std::vector<std::uint32_t> result(ids.size());
    for (std::uint32_t position = 0; position < ids.size(); ++position) result[ids[position]] = position;
    return result;
}

} // namespace

PairList::PairList(const DeviceScene& scene, std::span<const Pair> pairs)
    : scene_(scene), count_(static_cast<std::uint32_t>(pairs.size())) {
    auto& device = scene.device();
    std::vector<std::vector<std::uint32_t>> order;
    for (std::uint32_t body = 0; body < scene.body_count(); ++body)
        order.push_back(positions(scene.ids(body)));
    std::vector<std::uint32_t> rows;
    rows.reserve(4 * pairs.size());
    for (const auto& pair : pairs)
        rows.insert(rows.end(), {pair.body_a, pair.body_b, order[pair.body_a][pair.tet_a],
                                 order[pair.body_b][pair.tet_b]});
    const StageScope scope(device, Stage::write);
    pairs_ = device.allocate(rows.size() * 4, "listed pairs");
    device.upload(pairs_, bytes_of(rows));
    answers_ = device.allocate(pairs.size() * 4, "answers to listed pairs");
    auto defines = geometry_defines(scene.geometry(), scene.group_size());
    defines["LEAF_BITS"] = std::to_string(ceil_log2(scene.leaves()));
    kernel_ = device.compile(kernel_source("algorithms/kdop/pair_list.cl"), "test_pair_list", defines);
}

std::vector<std::uint8_t> PairList::run() {
    auto& device = scene_.device();
    std::vector<std::uint32_t> answers(count_);
    {
        const StageScope scope(device, Stage::traverse);
        const std::array<Argument, 6> arguments{scene_.nodes(), scene_.bodies(), scene_.level_table(),
                                                pairs_,         count_,          answers_};
        const std::uint64_t groups = (std::uint64_t{count_} + scene_.group_size() - 1) / scene_.group_size();
        device.launch(kernel_, {std::clamp<std::uint64_t>(groups, 1, 1 << 16), scene_.group_size()},
                      arguments);
    }
    const StageScope scope(device, Stage::read);
    device.download(answers_, std::as_writable_bytes(std::span(answers)));
    std::vector<std::uint8_t> result(count_);
    std::transform(answers.begin(), answers.end(), result.begin(),
                   [](std::uint32_t bits) { return static_cast<std::uint8_t>(bits == found ? 1 : 0); });
    return result;
}

} // namespace tandem
