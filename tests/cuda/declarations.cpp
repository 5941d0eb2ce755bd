// SPDX-License-Identifier: MIT
// The adaptor's own declarations of NVIDIA's libraries against the toolkit's headers; built if the toolkit
// exists.
#include "backends/cuda/driver.h"
#include "backends/cuda/nvrtc.h"
#include "tests/cuda/callable_as.h"
#include "tests/support/test.h"

#include <cuda.h>
#include <cudaProfiler.h>
#include <nvrtc.h>

namespace {

TEST(Declarations, EntriesOfTheDriver) {
    using namespace tandem::cuda;
#define TANDEM_COMPARE(name, arguments)                                                                      \
    EXPECT_TRUE(                                                                                             \
        callable_as(static_cast<int(*) arguments>(nullptr), static_cast<decltype(&::name)>(nullptr)))        \
        << #name;
    TANDEM_CUDA_ENTRIES(TANDEM_COMPARE)
    TANDEM_CUDA_OPTIONAL_ENTRIES(TANDEM_COMPARE)
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
    EXPECT_EQ(int{cuda::clock_rate_khz}, int{CU_DEVICE_ATTRIBUTE_CLOCK_RATE});
    EXPECT_EQ(int{cuda::memory_clock_rate_khz}, int{CU_DEVICE_ATTRIBUTE_MEMORY_CLOCK_RATE});
    EXPECT_EQ(int{cuda::memory_bus_bits}, int{CU_DEVICE_ATTRIBUTE_GLOBAL_MEMORY_BUS_WIDTH});
    EXPECT_EQ(int{cuda::multiprocessor_count}, int{CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT});
    EXPECT_EQ(int{cuda::max_threads_per_multiprocessor},
              int{CU_DEVICE_ATTRIBUTE_MAX_THREADS_PER_MULTIPROCESSOR});
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
