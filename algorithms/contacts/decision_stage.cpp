// SPDX-License-Identifier: MIT
#include "algorithms/contacts/decision_stage.h"

#include "algorithms/contacts/exact.h"
#include "algorithms/sources.h"
#include "algorithms/status.clh"

namespace tandem {

namespace {

constexpr std::uint8_t verdict_apart = 1, verdict_meets = 2;
constexpr std::size_t corner_reals = 24;

using Corners = std::array<std::array<double, 3>, 4>;

/// Verdicts of pairs whose corners are given as gather_corners has them.
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

DecisionStage::DecisionStage(const DeviceScene& scene, DecisionPrecision decision, std::uint32_t groups)
    : scene_(scene), decision_(decision), groups_(groups) {
    auto defines = row_defines(scene.geometry(), scene.group_size());
    auto& device = scene.device();
    if (decision != DecisionPrecision::fp64)
        filter_ = device.compile(kernel_source("algorithms/contacts/filter.cl"), "filter_pairs", defines);
    defines["RECHECK_ALL"] = decision == DecisionPrecision::fp64 ? "1" : "0";
    const auto& source = kernel_source("algorithms/contacts/recheck.cl");
    recheck_ = device.compile(source, "recheck_pairs", defines);
    if (decision != DecisionPrecision::exact) return;
    gather_ = device.compile(source, "gather_corners", defines);
    settle_ = device.compile(source, "settle_pairs", defines);
}

void DecisionStage::reserve(std::uint64_t pairs) {
    if (pairs <= room_) return;
    room_ = pairs;
    verdicts_ = unsure_ = uncertain_ = {};
    auto& device = scene_.device();
    verdicts_ = device.allocate(pairs, "verdicts");
    unsure_ = device.allocate(decision_ == DecisionPrecision::fp64 ? 4 : pairs * 4, "unsure pairs");
    uncertain_ = device.allocate(pairs * 4, "uncertain pairs");
}

void DecisionStage::launch(const Buffer& found, std::uint64_t first, std::uint64_t pair_capacity,
                           const Buffer& status) {
    const StageScope scope(scene_.device(), Stage::contact);
    reserve(pair_capacity);
    if (first == 0) settled_ = 0;
    const Grid grid{groups_, scene_.group_size()};
    const auto from = static_cast<std::uint32_t>(first);
    const auto room = static_cast<std::uint32_t>(pair_capacity);
    if (decision_ != DecisionPrecision::fp64) {
        const std::array<Argument, 10> filter{found,
                                              from,
                                              room,
                                              scene_.bodies(),
                                              scene_.poses(),
                                              scene_.tetrahedra(),
                                              scene_.vertices(),
                                              verdicts_,
                                              unsure_,
                                              status};
        scene_.device().launch(filter_, grid, filter);
    }
    const std::array<Argument, 11> recheck{found,
                                           from,
                                           room,
                                           scene_.bodies(),
                                           scene_.poses(),
                                           scene_.tetrahedra(),
                                           scene_.vertices(),
                                           verdicts_,
                                           unsure_,
                                           uncertain_,
                                           status};
    scene_.device().launch(recheck_, grid, recheck);
    if (decision_ == DecisionPrecision::exact) settle(found, status);
}

void DecisionStage::settle(const Buffer& found, const Buffer& status) {
    auto& device = scene_.device();
    std::uint32_t uncertain = 0; // at most one for each of the pairs, whose numbers are words
    device.download(status, std::as_writable_bytes(std::span(&uncertain, 1)), STATUS_UNCERTAIN * 4);
    if (uncertain <= settled_) return;
    const auto first = static_cast<std::uint32_t>(settled_);
    const std::uint32_t count = uncertain - first;
    settled_ = uncertain;
    const auto real = real_bytes(scene_.geometry());
    corners_ = {};
    corners_ = device.allocate(count * corner_reals * real, "corners of uncertain pairs");
    const Grid grid{groups_, scene_.group_size()};
    const std::array<Argument, 9> gather{
        found, scene_.bodies(), scene_.poses(), scene_.tetrahedra(), scene_.vertices(), uncertain_,
        first, count,           corners_};
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
    const std::array<Argument, 5> settle{uncertain_, first, count, answers_, verdicts_};
    device.launch(settle_, grid, settle);
}

} // namespace tandem
