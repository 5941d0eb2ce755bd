// SPDX-License-Identifier: MIT
// Which arguments compile: backends/handles.h. tests/kernel_files.py has what the build generates.
#include "algorithms/answer/digest.cl.h"
#include "backends/host/host_device.h"
#include "tests/support/test.h"
#include "tests/unit/backends/device_support.h"

namespace tandem {
namespace {

using Count = Exact<std::uint32_t>;
static_assert(std::is_convertible_v<std::uint32_t, Count>);
static_assert(!std::is_convertible_v<std::uint64_t, Count>);
static_assert(!std::is_convertible_v<int, Count>);
static_assert(!std::is_convertible_v<float, Count>);
static_assert(!std::is_convertible_v<Buffer, Count>);
static_assert(!std::is_default_constructible_v<Count>); // none can be left out
static_assert(!std::is_default_constructible_v<kernels::digest::DigestPairs>);

TEST(KernelArguments, AreInTheOrderOfTheKernel) {
    const auto device = host::make_device();
    const auto words = device->allocate(64, "words"), others = device->allocate(64, "others");
    const kernels::digest::DigestPairs arguments{
        .found = words, .count = 7u, .owners = others, .ids = words, .sums = others};
    const auto list = arguments.in_order();
    ASSERT_EQ(list.size(), 5u);
    EXPECT_EQ(std::get<0>(list[0].value()), &words.impl());
    const auto& count = std::get<1>(list[1].value());
    EXPECT_EQ(count.size, 4u);
    EXPECT_EQ(count.bytes[0], std::byte{7});
    EXPECT_EQ(std::get<0>(list[2].value()), &others.impl());
    EXPECT_EQ(std::get<0>(list[4].value()), &others.impl());
    EXPECT_EQ(arguments.source, "algorithms/answer/digest.cl");
    EXPECT_EQ(arguments.entry, "digest_pairs");
}

} // namespace
} // namespace tandem
