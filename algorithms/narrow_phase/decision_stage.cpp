// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/decision_stage.h"

#include "geometry/meet_exactly.h"
#include "algorithms/kernels/sources.h"
#include "algorithms/kernels/status.clh"

namespace tandem {

namespace {

constexpr std::uint8_t verdict_apart = 1, verdict_meets = 2;
/// Two tetrahedra of four corners of three coordinates.
constexpr std::size_t corner_reals = 24;

using DecidedCorners = std::array<std::array<double, 3>, 4>;

/// Verdicts of pairs whose corners are in the layout of gather_corners.
template<class Real>
std::vector<std::uint8_t> verdicts_of(const std::vector<std::byte>& bytes) {
    std::vector<Real> reals(bytes.size() / sizeof(Real));
    std::memcpy(reals.data(), bytes.data(), bytes.size());
    std::vector<std::uint8_t> verdicts(reals.size() / corner_reals);
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
        std::array<DecidedCorners, 2> pair{};
        for (std::size_t k = 0; k < corner_reals; ++k)
            pair[k / 12][k % 12 / 3][k % 3] = static_cast<double>(reals[corner_reals * i + k]);
        verdicts[i] = meet_exactly(pair[0], pair[1]) ? verdict_meets : verdict_apart;
    }
    return verdicts;
}

} // namespace

DecisionStage::DecisionStage(const Bodies& bodies, const ContactSettings& settings, LaunchShape shape)
    : bodies_(bodies), decision_(settings.decision), shape_(shape) {
    auto defines = row_defines(bodies.geometry(), shape.group_size);
    define(defines, parameters::pair_layout, bodies.pair_layout());
    defines["BOUNDARY_NEEDED"] = std::to_string(boundaries_needed(settings.rule));
    auto& device = bodies.device();
    std::vector<Column> columns{{"verdicts", 1}, {"pairs undecided in double", 4}};
    if (uses_certificates()) columns.push_back({"pairs undecided by the filter", 4});
    decided_ = GrowableBuffer(device, std::move(columns), 0);
    if (uses_certificates()) {
        compile_kernel(device, filter_, defines);
        defines["OVER_OPEN"] = "1";
        compile_kernel(device, filter_open_, defines);
        defines.erase("OVER_OPEN");
    }
    defines["RECHECK_ALL"] = decision_ == DecisionPrecision::fp64 ? "1" : "0";
    compile_kernel(device, recheck_, defines);
    if (decision_ != DecisionPrecision::exact) return;
    compile_kernel(device, gather_, defines);
    compile_kernel(device, settle_, defines);
}

void DecisionStage::reserve(std::uint64_t pairs) { decided_.reserve(pairs); }

void DecisionStage::launch(const Buffer& found, std::uint64_t first, std::uint64_t end,
                           const Status& status) {
    const StageScope scope(bodies_.device(), Stage::contact);
    // The kernel reads no list, so any buffer is valid.
    if (uses_certificates()) filter(filter_, found, first, end, decided_.buffer(undecided_by_double), status);
    recheck(found, first, end, status);
}

void DecisionStage::launch_open(const Buffer& found, std::uint64_t first, std::uint64_t end,
                                const Buffer& open, const Status& status) {
    const StageScope scope(bodies_.device(), Stage::contact);
    filter(filter_open_, found, first, end, open, status);
    recheck(found, first, end, status);
}

void DecisionStage::filter(const KernelOf<kernels::filter::FilterPairs>& kernel, const Buffer& found,
                           std::uint64_t first, std::uint64_t end, const Buffer& open, const Status& status) {
    bodies_.device().launch(kernel, {shape_.groups, shape_.group_size},
                            {.found = found,
                             .first = static_cast<std::uint32_t>(first),
                             .pair_capacity = static_cast<std::uint32_t>(end),
                             .owners = bodies_.owners(),
                             .poses = bodies_.poses(),
                             .tetrahedra = bodies_.tetrahedra(),
                             .vertices = bodies_.vertices(),
                             .boundary = bodies_.boundary(),
                             .open = open,
                             .verdicts = decided_.buffer(verdict),
                             .undecided_by_filter = decided_.buffer(undecided_by_filter),
                             .status = status.buffer()});
}

void DecisionStage::recheck(const Buffer& found, std::uint64_t first, std::uint64_t end,
                            const Status& status) {
    bodies_.device().launch(recheck_, {shape_.groups, shape_.group_size},
                            {.found = found,
                             .first = static_cast<std::uint32_t>(first),
                             .pair_capacity = static_cast<std::uint32_t>(end),
                             .owners = bodies_.owners(),
                             .poses = bodies_.poses(),
                             .tetrahedra = bodies_.tetrahedra(),
                             .vertices = bodies_.vertices(),
                             .boundary = bodies_.boundary(),
                             .verdicts = decided_.buffer(verdict),
                             .undecided_by_filter = filtered(),
                             .undecided_by_double = decided_.buffer(undecided_by_double),
                             .status = status.buffer()});
    if (decision_ == DecisionPrecision::exact) settle(found, status);
}

/// Settles the pairs added since the status was last read or written; earlier ones are settled.
void DecisionStage::settle(const Buffer& found, const Status& status) {
    auto& device = bodies_.device();
    std::uint32_t end = 0; // at most one per pair, and pair numbers are 32 bits
    device.download(status.buffer(), std::as_writable_bytes(std::span(&end, 1)),
                    STATUS_UNDECIDED_BY_DOUBLE * 4);
    const auto first = static_cast<std::uint32_t>(status.counter(STATUS_UNDECIDED_BY_DOUBLE));
    if (end <= first) return;
    const std::uint32_t count = end - first;
    const auto real = real_bytes(bodies_.geometry());
    corners_ = {};
    corners_ = device.allocate(count * corner_reals * real, "corners of undecided pairs");
    const Grid grid{shape_.groups, shape_.group_size};
    const kernels::recheck::GatherCorners gather{.found = found,
                                                 .owners = bodies_.owners(),
                                                 .poses = bodies_.poses(),
                                                 .tetrahedra = bodies_.tetrahedra(),
                                                 .vertices = bodies_.vertices(),
                                                 .undecided_by_double = decided_.buffer(undecided_by_double),
                                                 .first = first,
                                                 .count = count,
                                                 .corners = corners_};
    device.launch(gather_, grid, gather);
    std::vector<std::byte> bytes(corners_.bytes());
    device.download(corners_, bytes);
    std::vector<std::uint8_t> verdicts;
    {
        const HostWork work(device, Stage::contact, "exact decision");
        verdicts = real == 8 ? verdicts_of<double>(bytes) : verdicts_of<float>(bytes);
    }
    answers_ = {};
    answers_ = device.allocate(count, "exact verdicts");
    device.upload(answers_, bytes_of(verdicts), 0, true);
    const kernels::recheck::SettlePairs settle{.undecided_by_double = decided_.buffer(undecided_by_double),
                                               .first = first,
                                               .count = count,
                                               .settled = answers_,
                                               .verdicts = decided_.buffer(verdict)};
    device.launch(settle_, grid, settle);
}

} // namespace tandem
