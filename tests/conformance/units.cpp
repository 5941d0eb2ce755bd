// SPDX-License-Identifier: MIT
// Vectors of length 1: NVIDIA's GPUs share reciprocals between components, which must not show.
#include "algorithms/kernels/sources.h"
#include "tests/algorithms/units.cl.h"
#include "tests/support/on_device.h"
#include "tests/support/test.h"

#include <cmath>
#include <cstring>
#include <random>

namespace tandem {
namespace {

using namespace support;

constexpr std::uint32_t pairs = 1u << 18;

class Units : public OnDevice {};

/// Components of all magnitudes: most within a few octaves of their vector's, some far below, and zeros.
/// Vectors are around 1, and around the limits of sharing (2^-60, 2^30) and of the format.
template<class Real>
std::vector<Real> vectors() {
    std::mt19937 random(7);
    const auto below = [&](std::uint32_t end) { return static_cast<int>(random() % end); };
    const int scales[] = {0, 0, 0, -59, -60, -61, 29, 30, 31, -126, 120};
    std::vector<Real> rows(std::size_t{16} * pairs);
    for (std::size_t row = 0; row < rows.size(); row += 4) {
        const int scale = scales[static_cast<std::size_t>(below(std::size(scales)))];
        const int greatest = below(3);
        for (int i = 0; i < 3; ++i) {
            const auto mantissa = static_cast<Real>((1u << 23) + random() % (1u << 23)) / (1u << 23);
            const int kind = i == greatest ? 3 : below(8);
            const int exponent = scale + (kind == 0 ? -below(150) : -below(4));
            const Real magnitude = kind == 1 ? Real{0} : std::ldexp(mantissa, exponent);
            rows[row + static_cast<std::size_t>(i)] = random() % 2 == 0 ? magnitude : -magnitude;
        }
    }
    return rows;
}

/// The components of a vector of length 1, one rounding for each operation.
template<class Real>
std::array<Real, 3> unit_of(const Real* a) {
    const auto most = std::max({std::abs(a[0]), std::abs(a[1]), std::abs(a[2])});
    const std::array<Real, 3> n{a[0] / most, a[1] / most, a[2] / most};
    const Real xy = n[0] * n[0] + n[1] * n[1];
    const Real length = std::sqrt(xy + n[2] * n[2]);
    return {n[0] / length, n[1] / length, n[2] / length};
}

template<class Real>
void expect_units(Device& on) {
    const std::uint32_t group_size = on.info().id == "host" ? 1 : 64;
    KernelOf<kernels::units::UniteVectors> kernel;
    compile_kernel(
        on, kernel,
        {{"PRECISION", std::to_string(8 * sizeof(Real))}, {"GROUP_SIZE", std::to_string(group_size)}});
    const auto given = vectors<Real>();
    const auto bytes = std::as_bytes(std::span(given));
    auto buffer = on.allocate(bytes.size(), "vectors");
    {
        const StageScope scope(on, Stage::write);
        on.upload(buffer, bytes);
    }
    {
        const StageScope scope(on, Stage::contact);
        on.launch(kernel, {256, group_size}, {.vectors = buffer, .pairs = pairs});
    }
    std::vector<Real> made(given.size());
    {
        const StageScope scope(on, Stage::read);
        on.download(buffer, std::as_writable_bytes(std::span(made)));
    }
    on.finish();
    std::uint64_t wrong = 0;
    for (std::size_t row = 0; row < given.size(); row += 16) {
        for (std::size_t i = 0; i < 2; ++i) {
            const auto right = unit_of(&given[row + 4 * i]);
            for (std::size_t c = 0; c < 3; ++c)
                for (const auto& one : {made[row + 4 * i + c], made[row + 4 * (i + 2) + c]})
                    wrong += one == right[c] ? 0 : 1;
        }
    }
    EXPECT_EQ(wrong, 0u) << "of " << 12 * std::uint64_t{pairs} << " components";
}

TEST_P(Units, HaveTheBitsOfDivisions) {
    expect_units<float>(on);
    if (on.info().has_double) expect_units<double>(on);
}

TANDEM_ON_DEVICES(Units);

} // namespace
} // namespace tandem
