// SPDX-License-Identifier: MIT
#include "algorithms/answer/pair_list.h"

#include "algorithms/kernels/sources.h"

#include <algorithm>

namespace tandem {

namespace {

constexpr std::uint32_t answer_bits = 15; ///< all answer bits of pair_list.cl

} // namespace

PairList::PairList(const ChunkTrees& trees, std::span<const Pair> pairs)
    : trees_(trees), count_(static_cast<std::uint32_t>(pairs.size())) {
    auto& device = trees.bodies().device();
    std::vector<std::uint32_t> rows;
    rows.reserve(4 * pairs.size());
    for (const auto& pair : pairs)
        rows.insert(rows.end(),
                    {pair.body_a, pair.body_b, trees.bodies().position_of(pair.body_a, pair.tet_a),
                     trees.bodies().position_of(pair.body_b, pair.tet_b)});
    const StageScope scope(device, Stage::write);
    pairs_ = device.allocate(rows.size() * 4, "listed pairs");
    device.upload(pairs_, bytes_of(rows));
    answers_ = device.allocate(pairs.size() * 4, "answers to listed pairs");
    compile_kernel(device, kernel_, trees.defines(trees.group_size()));
}

std::vector<std::uint8_t> PairList::run() {
    auto& device = trees_.bodies().device();
    std::vector<std::uint32_t> answers(count_);
    {
        const StageScope scope(device, Stage::traverse);
        const kernels::pair_list::TestPairList arguments{.nodes = trees_.nodes(),
                                                         .volumes = trees_.volumes(),
                                                         .trees = trees_.tree_table(),
                                                         .levels = trees_.level_table(),
                                                         .pairs = pairs_,
                                                         .pair_count = count_,
                                                         .answers = answers_};
        const std::uint64_t groups = (std::uint64_t{count_} + trees_.group_size() - 1) / trees_.group_size();
        device.launch(kernel_, {std::clamp<std::uint64_t>(groups, 1, 1 << 16), trees_.group_size()},
                      arguments);
    }
    const StageScope scope(device, Stage::read);
    device.download(answers_, std::as_writable_bytes(std::span(answers)));
    std::vector<std::uint8_t> result(count_);
    std::transform(answers.begin(), answers.end(), result.begin(),
                   [](std::uint32_t bits) { return static_cast<std::uint8_t>(bits == answer_bits ? 1 : 0); });
    return result;
}

} // namespace tandem
