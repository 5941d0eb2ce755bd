// SPDX-License-Identifier: MIT
// The kernels that measure what a device can do do all their work, with groups of one and of many work-items.
#include "algorithms/bounds/geometry.h"
#include "algorithms/hierarchy/ceilings.cl.h"
#include "algorithms/kernels/sources.h"
#include "tests/support/on_device.h"

namespace tandem {
namespace {

using namespace support;

class CeilingKernels : public OnDevice {
protected:
    template<class Arguments>
    void launch(std::uint32_t group, const Arguments& arguments) {
        KernelOf<Arguments> kernel;
        compile_kernel(on, kernel, geometry_defines({.k = k_}, group));
        const StageScope scope(on, Stage::traverse);
        on.launch(kernel, {groups_, group}, arguments);
    }
    std::vector<std::uint32_t> groups() const {
        return on.info().max_group_size > 1 ? std::vector<std::uint32_t>{1, 64}
                                            : std::vector<std::uint32_t>{1};
    }

    static constexpr int k_ = 8;
    static constexpr std::uint32_t groups_ = 4;
};

TEST_P(CeilingKernels, EveryWordIsCopied) {
    constexpr std::size_t words = groups_ * 512 * 3;
    std::vector<std::uint64_t> values(words), copies(words);
    for (std::size_t i = 0; i < words; ++i) values[i] = i + 1;
    for (const auto group : groups()) {
        SCOPED_TRACE(group);
        const StageScope scope(on, Stage::traverse);
        const auto from = on.allocate(words * 8, "from"), to = on.allocate(words * 8, "to");
        on.upload(from, std::as_bytes(std::span(values)));
        on.clear(to, words * 8);
        launch(group, kernels::ceilings::CopyWords{.from = from, .to = to, .words = std::uint64_t{words}});
        on.download(to, std::as_writable_bytes(std::span(copies)));
        EXPECT_EQ(copies, values);
    }
}

/// Boxes of work-items whose number is a multiple of 8 overlap in the first round, and no others do.
TEST_P(CeilingKernels, OverlapsAreCounted) {
    const std::vector<float> slabs(2 * k_, 0.0f);
    for (const auto group : groups()) {
        SCOPED_TRACE(group);
        const StageScope scope(on, Stage::traverse);
        const auto nodes = on.allocate(slabs.size() * 4, "nodes"), elements = on.allocate(4, "elements");
        std::vector<std::uint32_t> found(groups_ * group);
        const auto counts = on.allocate(found.size() * 4, "counts");
        on.upload(nodes, std::as_bytes(std::span(slabs)));
        launch(group, kernels::ceilings::TestOverlaps{
                          .nodes = nodes, .counts = counts, .elements = elements, .rounds = 5u, .turns = 1u});
        std::uint32_t pack = 0;
        on.download(counts, std::as_writable_bytes(std::span(found)));
        on.download(elements, std::as_writable_bytes(std::span(&pack, 1)));
        EXPECT_GE(pack, GetParam() == "host" ? 4u : 1u);
        for (std::size_t i = 0; i < found.size(); ++i)
            EXPECT_EQ(found[i], i % 8 == 0 ? pack * k_ / 2 : 0u) << i;
    }
}

TANDEM_ON_DEVICES(CeilingKernels);

} // namespace
} // namespace tandem
