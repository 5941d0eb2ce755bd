// SPDX-License-Identifier: MIT
// The adaptor's own declarations of NVIDIA's libraries against the toolkit's headers; built where there is a
// toolkit.
#include "backends/cuda/driver.h"
#include "backends/cuda/nvrtc.h"

#include <cuda.h>
#include <nvrtc.h>

#include <gtest/gtest.h>
#include <type_traits>

namespace {

/// Whether one type can stand for the other in a call: our int for their enumerations, our pointer to bytes
/// for theirs to a structure; everything else has to be the same.
template<class Ours, class Theirs>
constexpr bool stands_for() {
    if constexpr (std::is_enum_v<Theirs>)
        return std::is_same_v<Ours, int> && sizeof(Theirs) == sizeof(int);
    else if constexpr (std::is_pointer_v<Theirs> && std::is_pointer_v<Ours>)
        return std::is_same_v<
                   std::remove_cv_t<std::remove_pointer_t<Ours>>,
                   unsigned char> || stands_for<std::remove_pointer_t<Ours>, std::remove_pointer_t<Theirs>>();
    else
        return std::is_same_v<std::remove_cv_t<Ours>, std::remove_cv_t<Theirs>>;
}

template<class... Ours, class Return, class... Theirs>
constexpr bool callable_as(int (*)(Ours...), Return (*)(Theirs...)) {
    if constexpr (sizeof...(Ours) != sizeof...(Theirs))
        return false;
    else
        return stands_for<int, Return>() && (stands_for<Ours, Theirs>() && ...);
}

TEST(Declarations, EntriesOfTheDriver) {
    using namespace tandem::cuda;
#define TANDEM_COMPARE(name, arguments)                                                                      \
    EXPECT_TRUE(                                                                                             \
        callable_as(static_cast<int(*) arguments>(nullptr), static_cast<decltype(&::name)>(nullptr)))        \
        << #name;
    TANDEM_CUDA_ENTRIES(TANDEM_COMPARE)
}

TEST(Declarations, EntriesOfNvrtc) {
    using namespace tandem::cuda;
    TANDEM_NVRTC_ENTRIES(TANDEM_COMPARE)
#undef TANDEM_COMPARE
}

TEST(Declarations, Attributes) {
    using namespace tandem;
    EXPECT_EQ(int{cuda::max_threads_per_block}, int{CU_DEVICE_ATTRIBUTE_MAX_THREADS_PER_BLOCK});
    EXPECT_EQ(int{cuda::max_shared_per_block}, int{CU_DEVICE_ATTRIBUTE_MAX_SHARED_MEMORY_PER_BLOCK});
    EXPECT_EQ(int{cuda::multiprocessor_count}, int{CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT});
    EXPECT_EQ(int{cuda::capability_major}, int{CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR});
    EXPECT_EQ(int{cuda::capability_minor}, int{CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MINOR});
    EXPECT_EQ(int{cuda::function_max_threads}, int{CU_FUNC_ATTRIBUTE_MAX_THREADS_PER_BLOCK});
    EXPECT_EQ(int{cuda::function_shared_bytes}, int{CU_FUNC_ATTRIBUTE_SHARED_SIZE_BYTES});
    EXPECT_EQ(int{cuda::function_registers}, int{CU_FUNC_ATTRIBUTE_NUM_REGS});
    EXPECT_EQ(0, int{CUDA_SUCCESS});
    EXPECT_EQ(cuda::out_of_memory, int{CUDA_ERROR_OUT_OF_MEMORY});
    EXPECT_EQ(0, int{NVRTC_SUCCESS});
}

} // namespace
