// SPDX-License-Identifier: MIT
// The adaptor's own declarations of CUPTI against its headers; built if the headers exist.
#include "backends/cuda/cupti.h"
#include "tests/cuda/callable_as.h"
#include "tests/support/test.h"

#include <cstddef>
#include <cupti.h>

namespace {

TEST(CuptiDeclarations, Entries) {
    using namespace tandem::cuda;
#define TANDEM_COMPARE(name, arguments)                                                                      \
    EXPECT_TRUE(                                                                                             \
        callable_as(static_cast<int(*) arguments>(nullptr), static_cast<decltype(&::name)>(nullptr)))        \
        << #name;
    TANDEM_CUPTI_ENTRIES(TANDEM_COMPARE)
#undef TANDEM_COMPARE
}

TEST(CuptiDeclarations, Values) {
    using namespace tandem;
    EXPECT_EQ(0, int{CUPTI_SUCCESS});
    EXPECT_EQ(int{cuda::cupti_memcpy}, int{CUPTI_ACTIVITY_KIND_MEMCPY});
    EXPECT_EQ(int{cuda::cupti_memset}, int{CUPTI_ACTIVITY_KIND_MEMSET});
    EXPECT_EQ(int{cuda::cupti_driver}, int{CUPTI_ACTIVITY_KIND_DRIVER});
    EXPECT_EQ(int{cuda::cupti_kernel}, int{CUPTI_ACTIVITY_KIND_CONCURRENT_KERNEL});
    EXPECT_EQ(int{cuda::cupti_external_correlation}, int{CUPTI_ACTIVITY_KIND_EXTERNAL_CORRELATION});
    EXPECT_EQ(int{cuda::cupti_custom}, int{CUPTI_EXTERNAL_CORRELATION_KIND_CUSTOM0});
    EXPECT_EQ(0, CUPTI_TIMESTAMP_UNKNOWN);
}

/// Checks offset and size of a field in our record and in CUPTI's.
#define TANDEM_SAME(ours, theirs, field, its)                                                                \
    EXPECT_EQ(offsetof(ours, field), offsetof(theirs, its)) << #theirs "::" #its;                            \
    EXPECT_EQ(sizeof(ours::field), sizeof(theirs::its)) << #theirs "::" #its

template<class Theirs>
void compare_kernel() {
    using tandem::cuda::CuptiKernel;
    TANDEM_SAME(CuptiKernel, Theirs, kind, kind);
    TANDEM_SAME(CuptiKernel, Theirs, start, start);
    TANDEM_SAME(CuptiKernel, Theirs, end, end);
    TANDEM_SAME(CuptiKernel, Theirs, correlation, correlationId);
}

template<class Theirs>
void compare_transfer() {
    using tandem::cuda::CuptiTransfer;
    TANDEM_SAME(CuptiTransfer, Theirs, kind, kind);
    TANDEM_SAME(CuptiTransfer, Theirs, bytes, bytes);
    TANDEM_SAME(CuptiTransfer, Theirs, start, start);
    TANDEM_SAME(CuptiTransfer, Theirs, end, end);
    TANDEM_SAME(CuptiTransfer, Theirs, correlation, correlationId);
}

/// Records of CUDA 11.2 to 13.0; the library's version decides which of them it writes.
TEST(CuptiDeclarations, Records) {
    using namespace tandem::cuda;
    compare_kernel<CUpti_ActivityKernel5>();
    compare_kernel<CUpti_ActivityKernel6>();
    compare_kernel<CUpti_ActivityKernel7>();
    compare_kernel<CUpti_ActivityKernel8>();
    compare_kernel<CUpti_ActivityKernel9>();
    compare_transfer<CUpti_ActivityMemcpy4>();
    compare_transfer<CUpti_ActivityMemcpy5>();
    compare_transfer<CUpti_ActivityMemset3>();
    compare_transfer<CUpti_ActivityMemset4>();
#if CUPTI_API_VERSION >= 130000
    compare_kernel<CUpti_ActivityKernel10>();
    compare_transfer<CUpti_ActivityMemcpy6>();
#endif
    using Theirs = CUpti_ActivityExternalCorrelation;
    TANDEM_SAME(CuptiCorrelation, Theirs, kind, kind);
    TANDEM_SAME(CuptiCorrelation, Theirs, whose, externalKind);
    TANDEM_SAME(CuptiCorrelation, Theirs, id, externalId);
    TANDEM_SAME(CuptiCorrelation, Theirs, correlation, correlationId);
}

} // namespace
