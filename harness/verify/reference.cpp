// SPDX-License-Identifier: MIT
#include "harness/verify/reference.h"

#include "algorithms/answer/wrench_sums.h"
#include "algorithms/bodies/pack.h"
#include "algorithms/narrow_phase/reference.h"
#include "algorithms/bodies/self_pairs.h"
#include "algorithms/bodies/shift.h"
#include "algorithms/broad_phase/broad.h"
#include "harness/verify/reference_bounds.h"
#include "base/parallel.h"

#include <algorithm>
#include <mutex>

namespace tandem {

namespace {

using reference_bounds::apart;
using reference_bounds::Bounds;
using reference_bounds::overlapping;

/// Tetrahedra of one body that overlap the bounds of another body, sorted by lower bound on the first axis.
template<class Real>
std::vector<std::uint32_t> near(const Bounds<Real>& body, const Bounds<Real>& other) {
    std::vector<std::uint32_t> result;
    for (std::uint32_t t = 0; t < body.slabs.size() / (2 * body.axes); ++t)
        if (overlapping(body.tetrahedron(t), other.whole.data(), body.axes, body.published))
            result.push_back(t);
    std::sort(result.begin(), result.end(),
              [&](auto x, auto y) { return body.tetrahedron(x)[0] < body.tetrahedron(y)[0]; });
    return result;
}

/// Calls hit(ta, tb) once for each overlapping pair. The tetrahedron that starts first on the first axis
/// finds the other one.
template<class Real, class Hit>
void sweep(const Bounds<Real>& a, const Bounds<Real>& b, Hit hit) {
    const auto list_a = near(a, b);
    const auto list_b = near(b, a);
    const auto scan = [&](const Bounds<Real>& x, const Bounds<Real>& y, auto from, auto end, auto tx,
                          auto each) {
        for (auto it = from;
             it != end && !apart(y.tetrahedron(*it)[0], x.tetrahedron(tx)[x.axes], x.published); ++it)
            if (overlapping(x.tetrahedron(tx), y.tetrahedron(*it), x.axes, x.published)) each(*it);
    };
    auto at_a = list_a.begin();
    auto at_b = list_b.begin();
    while (at_a != list_a.end() && at_b != list_b.end()) {
        if (a.tetrahedron(*at_a)[0] <= b.tetrahedron(*at_b)[0]) {
            scan(a, b, at_b, list_b.end(), *at_a, [&](auto tb) { hit(*at_a, tb); });
            ++at_a;
        } else {
            scan(b, a, at_a, list_a.end(), *at_b, [&](auto ta) { hit(ta, *at_b); });
            ++at_b;
        }
    }
}

/// The same for the tetrahedra of one body.
template<class Real, class Hit>
void sweep_self(const Bounds<Real>& body, Hit hit) {
    const auto list = near(body, body);
    for (auto at = list.begin(); at != list.end(); ++at) {
        const auto* own = body.tetrahedron(*at);
        for (auto next = at + 1;
             next != list.end() && !apart(body.tetrahedron(*next)[0], own[body.axes], body.published); ++next)
            if (overlapping(own, body.tetrahedron(*next), body.axes, body.published))
                hit(std::min(*at, *next), std::max(*at, *next));
    }
}

template<class Real, class Hit>
void test_all_of_one(const Bounds<Real>& body, Hit hit) {
    const auto count = static_cast<std::uint32_t>(body.slabs.size() / (2 * body.axes));
    for (std::uint32_t t = 0; t < count; ++t)
        for (std::uint32_t u = t + 1; u < count; ++u)
            if (overlapping(body.tetrahedron(t), body.tetrahedron(u), body.axes, body.published)) hit(t, u);
}

/// Whether two tetrahedra of a mesh have a common vertex of its topology.
bool share_vertex(const Mesh& mesh, std::uint32_t t, std::uint32_t u) {
    const auto p = joined(mesh, mesh.tetrahedra[t]), q = joined(mesh, mesh.tetrahedra[u]);
    return std::ranges::any_of(p, [&](auto vertex) { return std::ranges::find(q, vertex) != q.end(); });
}

/// Brute force: tests every pair of tetrahedra.
template<class Real, class Hit>
void test_all(const Bounds<Real>& a, const Bounds<Real>& b, Hit hit) {
    for (std::uint32_t ta = 0; ta < a.slabs.size() / (2 * a.axes); ++ta)
        for (std::uint32_t tb = 0; tb < b.slabs.size() / (2 * b.axes); ++tb)
            if (overlapping(a.tetrahedron(ta), b.tetrahedron(tb), a.axes, a.published)) hit(ta, tb);
}

/// A contact and its pair.
template<class Real>
using PairContact = std::pair<Pair, Contact<Real>>;

template<class Real>
std::pair<std::uint32_t, std::uint32_t> bodies_of(const PairContact<Real>& contact) {
    return {contact.first.body_a, contact.first.body_b};
}

/// Leaves of each body pair the contact with the least distance; of equal ones that of the first pair.
template<class Real>
void keep_closest(std::vector<PairContact<Real>>& contacts) {
    std::ranges::sort(contacts, {},
                      [](const auto& c) { return std::tuple(bodies_of(c), c.second.depth, c.first); });
    const auto rest = std::ranges::unique(contacts, {}, bodies_of<Real>);
    contacts.erase(rest.begin(), rest.end());
}

/// The polygons of each body pair added up, in the order of their pairs. `input`: the frame of the contacts.
template<class Real>
std::vector<PairContact<Real>> wrenches_of(std::vector<PairContact<Real>> contacts, const Scene& scene,
                                           const Geometry& geometry, const FrameInput& input) {
    const auto moved = centred(scene, geometry.origin);
    const auto arms = body_arms(moved ? *moved : scene);
    const auto frame = moved ? shifted(*moved, input.frame) : input.frame;
    std::ranges::sort(contacts, {}, [](const auto& c) { return std::pair(bodies_of(c), c.first); });
    std::vector<PairContact<Real>> result;
    for (auto first = contacts.begin(); first != contacts.end();) {
        const auto& pair = first->first;
        std::array<Real, 12> pose;
        std::ranges::transform(
            pose_rows(scene.bodies[pair.body_a].deformable ? Pose{} : frame.poses[pair.body_a]), pose.begin(),
            [](double number) { return static_cast<Real>(number); });
        WrenchSums<Real> sums(arms[pair.body_a], arms[pair.body_b], pose);
        auto one = first;
        for (; one != contacts.end() && bodies_of(*one) == bodies_of(*first); ++one)
            sums.add(one->second.point, one->second.normal, one->second.depth, one->second.pressure);
        const auto v = sums.values();
        result.push_back({pair, {sums.polygons(), {v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6], 0}});
        first = one;
    }
    return result;
}

/// Order-free.
template<class Real>
Digest digest_of_contacts(std::span<const PairContact<Real>> contacts) {
    Digest digest;
    for (const auto& [p, contact] : contacts) {
        const auto [a, b] = contact_terms<Real>(p.body_a, p.tet_a, p.body_b, p.tet_b, contact);
        digest += {1, a, b};
    }
    return digest;
}

/// Makes the contacts of an answer's pairs. Parallel parts may finish in any order.
template<class Real>
class ContactMaker {
public:
    ContactMaker(const Scene& scene, const std::vector<Bounds<Real>>& bounds, const ContactSettings& settings,
                 ReferenceAnswer& answer)
        : scene_(scene),
          bounds_(bounds),
          settings_(settings),
          answer_(answer),
          reduces_(settings.closest || settings.wrenches) {}

    /// Of some of the pairs.
    void add(std::span<const Pair> pairs) {
        ContactCounts counts;
        std::vector<PairContact<Real>> found;
        for (const auto& p : pairs) {
            for (const auto& contact :
                 reference_contacts(given(p.body_a, p.tet_a), given(p.body_b, p.tet_b), counts, settings_))
                found.emplace_back(p, contact);
        }
        if (settings_.closest) keep_closest(found);
        const auto digest = reduces_ ? Digest{} : digest_of_contacts<Real>(found);
        const std::scoped_lock lock(mutex_);
        if (reduces_) reduced_.insert(reduced_.end(), found.begin(), found.end());
        answer_.contact_digest += digest;
        answer_.degenerate += counts.degenerate;
        answer_.without_boundary += counts.without_boundary;
        answer_.rejected += counts.rejected;
        answer_.undecided_by_filter += counts.undecided_by_filter;
        answer_.undecided_by_double += counts.undecided_by_double;
    }

    /// Call it after all pairs.
    void finish(const Geometry& geometry, const FrameInput& input) {
        if (settings_.closest) keep_closest(reduced_);
        if (settings_.wrenches) reduced_ = wrenches_of(std::move(reduced_), scene_, geometry, input);
        answer_.contact_digest += digest_of_contacts<Real>(reduced_);
        answer_.contacts = answer_.contact_digest.count;
    }

private:
    GivenTetrahedron<Real> given(std::uint32_t body, std::uint32_t tetrahedron) const {
        const auto& mesh = scene_.meshes[scene_.bodies[body].mesh];
        GivenTetrahedron<Real> result{.corners = {}, .boundary = mesh.boundary[tetrahedron]};
        for (unsigned i = 0; i < 4; ++i) {
            const auto vertex = mesh.tetrahedra[tetrahedron][i];
            result.corners[i] = bounds_[body].vertices[vertex];
            // -1, which is no pressure of a field, for a mesh without one.
            result.pressures[i] =
                mesh.pressures.empty() ? Real(-1) : static_cast<Real>(mesh.pressures[vertex]);
        }
        return result;
    }

    const Scene& scene_;
    const std::vector<Bounds<Real>>& bounds_;
    const ContactSettings& settings_;
    ReferenceAnswer& answer_;
    std::mutex mutex_;
    bool reduces_;                           ///< to one row for each body pair
    std::vector<PairContact<Real>> reduced_; ///< of the parts so far
};

/// Whether each mesh has a boundary face.
std::vector<bool> have_boundary(const Scene& scene) {
    std::vector<bool> result;
    for (const auto& mesh : scene.meshes)
        result.push_back(std::ranges::any_of(mesh.boundary, [](auto faces) { return faces != 0; }));
    return result;
}

} // namespace

std::vector<Pair> of_boundary(const Scene& scene, std::vector<Pair> pairs) {
    const auto has_boundary = have_boundary(scene);
    const auto is_inner = [&](std::uint32_t body, std::uint32_t tetrahedron) {
        const auto mesh = scene.bodies[body].mesh;
        return has_boundary[mesh] && scene.meshes[mesh].boundary[tetrahedron] == 0;
    };
    std::erase_if(pairs, [&](const Pair& pair) {
        return is_inner(pair.body_a, pair.tet_a) || is_inner(pair.body_b, pair.tet_b);
    });
    return pairs;
}

namespace {

/// The pairs of which some pressure is in both tetrahedra.
std::vector<Pair> of_common_pressure(const Scene& scene, std::vector<Pair> pairs) {
    const auto interval = [&](std::uint32_t body, std::uint32_t tetrahedron) {
        const auto& mesh = scene.meshes[scene.bodies[body].mesh];
        if (mesh.pressures.empty()) return std::pair(-1.0, -1.0);
        const auto at = [&](std::uint32_t vertex) { return mesh.pressures[vertex]; };
        const auto [low, high] = std::ranges::minmax(mesh.tetrahedra[tetrahedron], {}, at);
        return std::pair(at(low), at(high));
    };
    std::erase_if(pairs, [&](const Pair& pair) {
        const auto a = interval(pair.body_a, pair.tet_a), b = interval(pair.body_b, pair.tet_b);
        return a.first > b.second || b.first > a.second;
    });
    return pairs;
}

} // namespace

std::vector<Pair> pairs_walked(const Scene& scene, std::vector<Pair> pairs, Walked walked) {
    if (walked == Walked::boundary) return of_boundary(scene, std::move(pairs));
    return walked == Walked::by_pressure ? of_common_pressure(scene, std::move(pairs)) : std::move(pairs);
}

namespace {

/// Drops the pairs of all other body pairs, and returns their number. `kept` must be sorted.
std::uint64_t keep_pairs_of(std::span<const BodyPair> kept, std::vector<Pair>& pairs) {
    return std::erase_if(pairs, [&](const Pair& pair) {
        return !std::ranges::binary_search(kept, BodyPair{pair.body_a, pair.body_b});
    });
}

/// Number of pairs of bodies that may meet, have overlapping bounds, and are not in `kept`, which is sorted.
template<class Real>
std::uint64_t count_overlapping(const Scene& scene, const std::vector<Bounds<Real>>& bounds,
                                const std::vector<BodyPair>& kept) {
    std::uint64_t count = 0;
    for (std::uint32_t a = 0; a < bounds.size(); ++a)
        for (std::uint32_t b = a + 1; b < bounds.size(); ++b)
            if (overlapping(bounds[a].whole.data(), bounds[b].whole.data(), bounds[a].axes,
                            bounds[a].published)
                && may_meet(scene, a, b) && !std::ranges::binary_search(kept, BodyPair{a, b}))
                ++count;
    return count;
}

/// The body pairs that setting broad=sphere_boxes finds, among bodies as devices have them.
std::vector<BodyPair> pairs_within_boxes(const Scene& scene, const FrameInput& input,
                                         const Geometry& geometry, SelfPairs self) {
    const auto moved = centred(scene, geometry.origin);
    if (!moved) return BroadSweep(scene, geometry, Broad::sphere_boxes, self).pairs(input);
    const auto frame = shifted(*moved, input.frame);
    const auto next = input.next != nullptr ? shifted(*moved, *input.next) : Frame();
    return BroadSweep(*moved, geometry, Broad::sphere_boxes, self)
        .pairs({frame, input.next != nullptr ? &next : nullptr});
}

/// Keeps the pairs of the body pairs that setting broad=sphere_boxes finds, and of these the part that the
/// settings name.
template<class Real>
void keep_within_boxes(const Scene& scene, const FrameInput& input, const Geometry& geometry,
                       const ContactSettings& settings, const std::vector<Bounds<Real>>& bounds,
                       ReferenceAnswer& answer) {
    const auto kept = pairs_within_boxes(scene, input, geometry, settings.self);
    answer.dropped_pairs = keep_pairs_of(kept, answer.pairs);
    answer.dropped_body_pairs = count_overlapping(scene, bounds, kept);
    const auto from = std::span(kept).subspan(std::min(settings.first_body_pair, kept.size()));
    const auto most = settings.most_body_pairs == 0 ? from.size() : settings.most_body_pairs;
    keep_pairs_of(from.first(std::min(most, from.size())), answer.pairs);
}

template<class Real>
ReferenceAnswer answer_in(const Scene& scene, const FrameInput& input, const Geometry& geometry,
                          bool contacts, Method method, const ContactSettings& settings) {
    std::vector<Bounds<Real>> bounds(scene.bodies.size());
    parallel_for(bounds.size(), [&](std::size_t body) {
        bounds[body] = reference_bounds::bounds_of<Real>(scene, input, geometry, body);
    });
    std::vector<std::vector<Pair>> found(bounds.size());
    parallel_for(bounds.size(), [&](std::size_t index) {
        const auto a = static_cast<std::uint32_t>(index);
        for (std::uint32_t b = a + 1; b < bounds.size(); ++b) {
            if (!may_meet(scene, a, b)) continue;
            const auto hit = [&](std::uint32_t ta, std::uint32_t tb) { found[a].push_back({a, ta, b, tb}); };
            if (method == Method::brute_force)
                test_all(bounds[a], bounds[b], hit);
            else if (overlapping(bounds[a].whole.data(), bounds[b].whole.data(), bounds[a].axes,
                                 bounds[a].published))
                sweep(bounds[a], bounds[b], hit);
        }
        if (meets_itself(scene, a, settings.self)) {
            const auto& mesh = scene.meshes[scene.bodies[a].mesh];
            const auto hit = [&](std::uint32_t t, std::uint32_t u) {
                if (!share_vertex(mesh, t, u)) found[a].push_back({a, t, a, u});
            };
            if (method == Method::brute_force)
                test_all_of_one(bounds[a], hit);
            else
                sweep_self(bounds[a], hit);
        }
        std::sort(found[a].begin(), found[a].end());
    });
    ReferenceAnswer answer;
    for (const auto& part : found) answer.pairs.insert(answer.pairs.end(), part.begin(), part.end());
    if (settings.walked == Walked::boundary) answer.pairs = of_boundary(scene, std::move(answer.pairs));
    if (settings.within_sphere_boxes) keep_within_boxes(scene, input, geometry, settings, bounds, answer);
    answer.digest = digest_of(answer.pairs);
    if (!contacts) return answer;
    ContactMaker<Real> maker(scene, bounds, settings, answer);
    constexpr std::size_t part = 4096;
    parallel_for((answer.pairs.size() + part - 1) / part, [&](std::size_t i) {
        const auto all = std::span<const Pair>(answer.pairs);
        maker.add(all.subspan(i * part, std::min(part, all.size() - i * part)));
    });
    maker.finish(geometry, input);
    return answer;
}

} // namespace

ReferenceAnswer reference(const Scene& scene, const FrameInput& input, const Geometry& geometry,
                          bool contacts, Method method, const ContactSettings& settings) {
    return geometry.precision == Precision::fp64
               ? answer_in<double>(scene, input, geometry, contacts, method, settings)
               : answer_in<float>(scene, input, geometry, contacts, method, settings);
}

Method reference_method(const Scene& scene) {
    constexpr double most_tests = 4e6;
    const auto tetrahedra = static_cast<double>(tetrahedron_count(scene));
    return tetrahedra * tetrahedra / 2 <= most_tests ? Method::brute_force : Method::sweep;
}

Difference difference(std::span<const Pair> expected, std::span<const Pair> found) {
    Difference result;
    auto e = expected.begin();
    auto f = found.begin();
    while (e != expected.end() && f != found.end()) {
        if (*e == *f) {
            ++e;
            ++f;
        } else if (*e < *f) {
            ++result.missing;
            ++e;
        } else {
            ++result.extra;
            ++f;
        }
    }
    result.missing += static_cast<std::uint64_t>(expected.end() - e);
    result.extra += static_cast<std::uint64_t>(found.end() - f);
    return result;
}

} // namespace tandem
