// SPDX-License-Identifier: MIT
// The kernels of the contact stage, on pairs of tetrahedra without bodies or a session.
#pragma once

#include "algorithms/answer/digest_contacts.cl.h"
#include "algorithms/narrow_phase/certify.cl.h"
#include "algorithms/narrow_phase/contacts.cl.h"
#include "algorithms/narrow_phase/filter.cl.h"
#include "algorithms/narrow_phase/recheck.cl.h"
#include "algorithms/narrow_phase/separate.cl.h"
#include "tests/support/test.h"
#include "tests/unit/contacts/pairs.h"

#include "algorithms/kernels/status.clh"
#include "algorithms/narrow_phase/contact_stage.h"
#include "algorithms/kernels/sources.h"

namespace tandem::unit_test {

/// Pair and feature of a contact.
struct PairFeature {
    std::uint32_t pair, feature;
};

/// Results of a device for the pairs.
template<class Real>
struct ContactOutcome {
    std::vector<std::uint32_t> status;
    std::vector<PairFeature> rows;
    std::vector<Real> values;

    std::vector<std::uint32_t> sums = std::vector<std::uint32_t>(4); ///< digest of the contacts

    std::uint64_t counter(std::uint32_t word) const {
        return status[word] | std::uint64_t{status[word + 1]} << 32;
    }
    std::uint64_t digest_a() const { return sums[0] | std::uint64_t{sums[1]} << 32; }
    std::uint64_t digest_b() const { return sums[2] | std::uint64_t{sums[3]} << 32; }
};

/// The contacts of an outcome by pair, in ascending order of feature.
template<class Real>
std::vector<std::vector<Contact<Real>>> by_pair(const ContactOutcome<Real>& outcome, std::size_t rows,
                                                std::size_t pairs) {
    std::vector<std::vector<Contact<Real>>> result(pairs);
    for (std::size_t i = 0; i < rows; ++i) {
        const Real* v = &outcome.values[8 * i];
        result.at(outcome.rows[i].pair)
            .push_back({outcome.rows[i].feature, {v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6], v[7]});
    }
    for (auto& contacts : result)
        std::sort(contacts.begin(), contacts.end(),
                  [](const auto& a, const auto& b) { return a.feature < b.feature; });
    return result;
}

/// Pairs in the layout of the kernels: body 0 has all tetrahedra a, body 1 all b, both in world coordinates.
template<class Real>
class ContactKernels {
public:
    ContactKernels(Device& device, const std::vector<TetrahedronPair<Real>>& pairs, std::uint32_t group_size)
        : device_(device), group_size_(group_size) {
        const auto count = static_cast<std::uint32_t>(pairs.size());
        std::vector<std::uint32_t> tetrahedra, ids, found;
        std::vector<unsigned char> boundary;
        std::vector<Real> vertices;
        for (const bool second : {false, true})
            for (const auto& pair : pairs) {
                const auto given = second ? pair.given_b() : pair.given_a();
                for (unsigned i = 0; i < 4; ++i) {
                    const auto& corner = given.corners[i];
                    tetrahedra.push_back(static_cast<std::uint32_t>(vertices.size() / 4)
                                         - (second ? 4 * count : 0));
                    vertices.insert(vertices.end(), {corner[0], corner[1], corner[2], given.pressures[i]});
                }
                boundary.push_back(static_cast<unsigned char>(second ? pair.boundary_b : pair.boundary_a));
            }
        ids = {2, 0, 1}; // permuted body numbers
        for (std::uint32_t i = 0; i < 2 * count; ++i) ids.push_back(input_id(i % count));
        for (std::uint32_t i = 0; i < count; ++i) found.insert(found.end(), {0, 1, i, i});
        const std::uint32_t in_world = 1;
        bodies_ =
            uploaded(std::vector<std::uint32_t>{0, 0, count, in_world, count, 4 * count, count, in_world});
        poses_ = uploaded(std::vector<Real>(24));
        tetrahedra_ = uploaded(tetrahedra);
        vertices_ = uploaded(vertices);
        boundary_ = uploaded(boundary);
        ids_ = uploaded(ids);
        found_ = uploaded(found);
        verdicts_ = uploaded(std::vector<unsigned char>(count, 9));
        undecided_by_filter_ = uploaded(std::vector<std::uint32_t>(count, ~0u));
        undecided_by_double_ = uploaded(std::vector<std::uint32_t>(count, ~0u));
        open_ = uploaded(std::vector<std::uint32_t>(count, ~0u));
        meeting_ = uploaded(std::vector<std::uint32_t>(count, ~0u));
        near_ = uploaded(std::vector<std::uint32_t>(count, ~0u));
    }

    void set_launches(ContactStage::Launches launches) { launches_ = launches; }

    static std::uint32_t input_id(std::uint32_t item) { return item ^ 1u; }

    ContactOutcome<Real> run(std::uint32_t first, std::uint32_t pairs, std::uint32_t high,
                             std::uint32_t pair_capacity, std::uint32_t capacity,
                             ContactSettings settings = {}) {
        auto defines = this->defines();
        margin_ = margin_of(settings);
        defines["BOUNDARY_NEEDED"] = std::to_string(boundaries_needed(settings.rule));
        defines["PRESSURES_NEEDED"] = needs_pressures(settings.rule) ? "1" : "0";
        ContactOutcome<Real> outcome{std::vector<std::uint32_t>(STATUS_WORDS),
                                     std::vector<PairFeature>(capacity + 8, {~0u, ~0u}),
                                     std::vector<Real>(8 * (capacity + 8), Real(-7))};
        outcome.status[STATUS_PAIRS] = pairs;
        outcome.status[STATUS_PAIRS + 1] = high;
        const Buffer status = uploaded(outcome.status), rows = uploaded(outcome.rows),
                     values = uploaded(outcome.values);
        const bool at_once = launches_ == ContactStage::Launches::at_once;
        if (at_once || settings.decision == DecisionPrecision::fp64)
            decide(defines, settings.decision, first, pair_capacity, status, false);
        defines["CONTACT_RULE"] = std::to_string(static_cast<int>(settings.rule));
        if (!at_once) find_meeting(defines, settings.decision, first, pair_capacity, status);
        defines["DECIDED"] = decided_define(settings.decision, has_verdicts(settings.decision));
        defines["AT_ONCE"] = at_once ? "1" : "0";
        generate(defines, first, pair_capacity, {rows, values, capacity}, status);
        device_.download(status, std::as_writable_bytes(std::span(outcome.status)));
        const auto made =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(outcome.counter(STATUS_CONTACTS), capacity));
        const Buffer sums = uploaded(outcome.sums);
        digest(rows, values, made, sums);
        device_.download(sums, std::as_writable_bytes(std::span(outcome.sums)));
        device_.download(rows, std::as_writable_bytes(std::span(outcome.rows)));
        device_.download(values, std::as_writable_bytes(std::span(outcome.values)));
        return outcome;
    }

private:
    template<class Arguments>
    void launch(const Defines& defines, const Arguments& arguments) {
        KernelOf<Arguments> kernel;
        compile_kernel(device_, kernel, defines);
        device_.launch(kernel, {16, group_size_}, arguments);
    }

    void generate(const Defines& defines, std::uint32_t first, std::uint32_t pair_capacity,
                  const ContactRows& to, const Buffer& status) {
        const kernels::contacts::GenerateContacts arguments{.found = found_,
                                                            .first = first,
                                                            .pair_capacity = pair_capacity,
                                                            .owners = bodies_,
                                                            .poses = poses_,
                                                            .tetrahedra = tetrahedra_,
                                                            .vertices = vertices_,
                                                            .boundary = boundary_,
                                                            .verdicts = verdicts_,
                                                            .margin = margin_,
                                                            .meeting = meeting_,
                                                            .near = near_,
                                                            .contact_ids = to.ids,
                                                            .contact_values = to.values,
                                                            .contact_capacity = to.capacity,
                                                            .status = status};
        launch(defines, arguments);
    }

    /// Adds the terms of the first `made` contacts to `sums`.
    void digest(const Buffer& rows, const Buffer& values, std::uint32_t made, const Buffer& sums) {
        const kernels::digest_contacts::DigestContacts arguments{.found = found_,
                                                                 .owners = bodies_,
                                                                 .ids = ids_,
                                                                 .contact_ids = rows,
                                                                 .value_bits = values,
                                                                 .count = made,
                                                                 .sums = sums};
        launch(defines(), arguments);
    }

    Defines defines() const {
        return {{"PRECISION", sizeof(Real) == 8 ? "64" : "32"}, {"GROUP_SIZE", std::to_string(group_size_)}};
    }

    void find_meeting(Defines defines, DecisionPrecision decision, std::uint32_t first,
                      std::uint32_t pair_capacity, const Buffer& status) {
        const kernels::certify::CertifyPairs certify{.found = found_,
                                                     .first = first,
                                                     .pair_capacity = pair_capacity,
                                                     .owners = bodies_,
                                                     .poses = poses_,
                                                     .tetrahedra = tetrahedra_,
                                                     .vertices = vertices_,
                                                     .boundary = boundary_,
                                                     .verdicts = verdicts_,
                                                     .margin = margin_,
                                                     .open = open_,
                                                     .meeting = meeting_,
                                                     .near = near_,
                                                     .status = status};
        const bool decides_open =
            decision == DecisionPrecision::recheck || decision == DecisionPrecision::exact;
        defines["DECIDED"] = decided_define(decision, decision == DecisionPrecision::fp64);
        launch(defines, certify);
        if (decides_open) decide(defines, decision, first, pair_capacity, status, true);
        const kernels::separate::SeparatePairs separate{.found = found_,
                                                        .first = first,
                                                        .owners = bodies_,
                                                        .poses = poses_,
                                                        .tetrahedra = tetrahedra_,
                                                        .vertices = vertices_,
                                                        .verdicts = verdicts_,
                                                        .open = open_,
                                                        .meeting = meeting_,
                                                        .near = near_,
                                                        .status = status};
        defines["DECIDED"] = decided_define(decision, has_verdicts(decision));
        launch(defines, separate);
    }

    /// `open`: only pairs that certify_pairs has left undecided.
    void decide(Defines defines, DecisionPrecision decision, std::uint32_t first, std::uint32_t pair_capacity,
                const Buffer& status, bool open) {
        if (!has_verdicts(decision)) return;
        const kernels::filter::FilterPairs filter{.found = found_,
                                                  .first = first,
                                                  .pair_capacity = pair_capacity,
                                                  .owners = bodies_,
                                                  .poses = poses_,
                                                  .tetrahedra = tetrahedra_,
                                                  .vertices = vertices_,
                                                  .boundary = boundary_,
                                                  .open = open_,
                                                  .verdicts = verdicts_,
                                                  .undecided_by_filter = undecided_by_filter_,
                                                  .status = status};
        defines.erase("CONTACT_RULE");
        defines.erase("DECIDED");
        auto filtering = defines;
        filtering["OVER_OPEN"] = open ? "1" : "0";
        if (decision != DecisionPrecision::fp64) launch(filtering, filter);
        defines["RECHECK_ALL"] = decision == DecisionPrecision::fp64 ? "1" : "0";
        const kernels::recheck::RecheckPairs recheck{.found = found_,
                                                     .first = first,
                                                     .pair_capacity = pair_capacity,
                                                     .owners = bodies_,
                                                     .poses = poses_,
                                                     .tetrahedra = tetrahedra_,
                                                     .vertices = vertices_,
                                                     .boundary = boundary_,
                                                     .verdicts = verdicts_,
                                                     .undecided_by_filter = undecided_by_filter_,
                                                     .undecided_by_double = undecided_by_double_,
                                                     .status = status};
        launch(defines, recheck);
    }

    template<class T>
    Buffer uploaded(const std::vector<T>& values) {
        Buffer buffer = device_.allocate(values.size() * sizeof(T), "test");
        device_.upload(buffer, bytes_of(values), 0, true);
        return buffer;
    }

    Device& device_;
    StageScope scope_{device_, Stage::contact};
    std::uint32_t group_size_;
    ContactStage::Launches launches_ = ContactStage::Launches::apart;
    float margin_ = 0;
    Buffer bodies_, poses_, tetrahedra_, vertices_, boundary_, ids_, found_, verdicts_, undecided_by_filter_,
        undecided_by_double_, open_, meeting_, near_;
};

} // namespace tandem::unit_test
