// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/decision_stage.h"

#include "geometry/meet_exactly.h"
#include "algorithms/sources.h"
#include "algorithms/answer/status.clh"

namespace tandem {

namespace {

constexpr std::uint8_t verdict_apart = 1, verdict_meets = 2;
/// Two tetrahedra of four corners of three coordinates.
constexpr std::size_t corner_reals = 24;

using Corners = std::array<std::array<double, 3>, 4>;

/// Verdicts of pairs whose corners are in the layout of gather_corners.
template<class Real>
std::vector<std::uint8_t> verdicts_of(const std::vector<std::byte>& bytes) {
    std::vector<Real> reals(bytes.size() / sizeof(Real));
    std::memcpy(reals.data(), bytes.data(), bytes.size());
    std::vector<std::uint8_t> verdicts(reals.size() / corner_reals);
    for (std::size_t i = 0; i < verdicts.size(); ++i) {
        std::array<Corners, 2> pair{};
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
        const auto& filter = kernel_source("algorithms/narrow_phase/filter.cl");
        filter_ = device.compile(filter, "filter_pairs", defines);
        defines["OVER_OPEN"] = "1";
        filter_open_ = device.compile(filter, "filter_pairs", defines);
        defines.erase("OVER_OPEN");
    }
    defines["RECHECK_ALL"] = decision_ == DecisionPrecision::fp64 ? "1" : "0";
    const auto& source = kernel_source("algorithms/narrow_phase/recheck.cl");
    recheck_ = device.compile(source, "recheck_pairs", defines);
    if (decision_ != DecisionPrecision::exact) return;
    gather_ = device.compile(source, "gather_corners", defines);
    settle_ = device.compile(source, "settle_pairs", defines);
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

void DecisionStage::filter(const Kernel& kernel, const Buffer& found, std::uint64_t first, std::uint64_t end,
                           const Buffer& open, const Status& status) {
    decide(kernel, found, first, end, {open, decided_.buffer(verdict), decided_.buffer(undecided_by_filter)},
           status);
}

void DecisionStage::recheck(const Buffer& found, std::uint64_t first, std::uint64_t end,
                            const Status& status) {
    decide(recheck_, found, first, end,
           {decided_.buffer(verdict), filtered(), decided_.buffer(undecided_by_double)}, status);
    if (decision_ == DecisionPrecision::exact) settle(found, status);
}

/// Launches either kernel; `own` has the arguments in which they differ.
void DecisionStage::decide(const Kernel& kernel, const Buffer& found, std::uint64_t first, std::uint64_t end,
                           const std::array<Argument, 3>& own, const Status& status) {
    const std::array<Argument, 12> arguments{found,
                                             static_cast<std::uint32_t>(first),
                                             static_cast<std::uint32_t>(end),
                                             bodies_.owners(),
                                             bodies_.poses(),
                                             bodies_.tetrahedra(),
                                             bodies_.vertices(),
                                             bodies_.boundary(),
                                             own[0],
                                             own[1],
                                             own[2],
                                             status.buffer()};
    bodies_.device().launch(kernel, {shape_.groups, shape_.group_size}, arguments);
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
    const std::array<Argument, 9> gather{found,
                                         bodies_.owners(),
                                         bodies_.poses(),
                                         bodies_.tetrahedra(),
                                         bodies_.vertices(),
                                         decided_.buffer(undecided_by_double),
                                         first,
                                         count,
                                         corners_};
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
    const std::array<Argument, 5> settle{decided_.buffer(undecided_by_double), first, count, answers_,
                                         decided_.buffer(verdict)};
    device.launch(settle_, grid, settle);
}

} // namespace tandem
