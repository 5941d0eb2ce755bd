// SPDX-License-Identifier: MIT
#include "python/core/answer.h"

#include "algorithms/bodies/origin.h"
#include "algorithms/parameters/table.h"
#include "python/core/arrays.h"
#include "python/core/meeting.h"
#include "base/error.h"

#include <fmt/format.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace tandem::python {

namespace {

static_assert(sizeof(Pair) == 4 * sizeof(std::int32_t) && sizeof(ContactPoint) % sizeof(double) == 0);

} // namespace

Answer::~Answer() {
    if (collider_->is_lost()) {
        static_cast<void>(new auto(std::move(on_device_)));
        static_cast<void>(new auto(std::move(result_.parts)));
        return;
    }
    // The buffers return to the device's pool, which other threads use under this lock.
    const auto lock = collider_->lock_at_end();
    on_device_.reset();
    result_.parts.clear();
    frame_.reset();
}

void Answer::check_current() const {
    if (is_queued_) collider_->check_queued(number_);
}

Digest Answer::digest() const {
    const auto lock = collider_->lock();
    check_current();
    return result_.digest();
}

Digest Answer::contact_digest() const {
    const auto lock = collider_->lock();
    check_current();
    return result_.contact_digest();
}

void Answer::check_pairs_kept() const {
    check_current();
    const auto& settings = collider_->settings();
    if (!has_pairs(settings[parameters::output]))
        throw InputError(fmt::format("setting output={} keeps no pairs; make the collider with output=pairs",
                                     settings.text("output")));
}

std::vector<Pair> Answer::pairs() const {
    const auto lock = collider_->lock();
    check_pairs_kept();
    return result_.download();
}

std::vector<ContactPoint> Answer::contacts() const {
    const auto lock = collider_->lock();
    check_pairs_kept();
    const auto rule = collider_->settings()[parameters::contact_rule];
    if (rule == ContactRule::none)
        throw InputError("setting contact_rule=none makes no contacts; make the collider without it");
    if (has_near_pairs(rule) || needs_pressures(rule))
        throw InputError(
            fmt::format("setting contact_rule={} makes {}", collider_->settings().text("contact_rule"),
                        has_near_pairs(rule) ? "distances, not contacts; call distances()"
                                             : "polygons, not contacts; call surfaces() or wrenches()"));
    return result_.download_contacts();
}

std::vector<ContactPoint> Answer::distances() const {
    const auto lock = collider_->lock();
    check_pairs_kept();
    if (!has_near_pairs(collider_->settings()[parameters::contact_rule]))
        throw InputError(fmt::format("setting contact_rule={} makes no distances; make the collider with "
                                     "contact_rule=\"distance\" and a margin",
                                     collider_->settings().text("contact_rule")));
    return result_.download_contacts();
}

std::vector<ContactPoint> Answer::polygons() const {
    const auto lock = collider_->lock();
    check_pairs_kept();
    const auto& settings = collider_->settings();
    if (!has_polygons(settings) || settings[parameters::output] == Output::wrenches)
        throw InputError(fmt::format("settings contact_rule={} and output={} make no polygons; make the "
                                     "collider with contact_rule=\"pressure\" and output=\"contacts\"",
                                     settings.text("contact_rule"), settings.text("output")));
    return result_.download_contacts();
}

ContactSurfaces Answer::surfaces() const {
    const auto rows = polygons();
    const auto lock = collider_->lock();
    return surfaces_of(collider_->scene(), world("surfaces(corners=True)"),
                       geometry_of(collider_->settings()).precision, result_.origin, rows);
}

std::vector<ContactPoint> Answer::wrenches() const {
    const auto lock = collider_->lock();
    check_pairs_kept();
    if (collider_->settings()[parameters::output] != Output::wrenches)
        throw InputError(fmt::format("setting output={} adds no wrenches up; make the collider with "
                                     "output=\"wrenches\"",
                                     collider_->settings().text("output")));
    return result_.download_contacts();
}

oracle::World Answer::world(const char* asks) const {
    const auto geometry = geometry_of(collider_->settings());
    if (geometry.placement == Placement::exact)
        throw InputError(fmt::format("setting placement=exact has no rounded vertices, which {} takes; make "
                                     "the collider without it",
                                     asks));
    const auto& [x, y, z] = result_.origin;
    return frame_ ? oracle::world_of(collider_->scene(), counted_from({x, y, z}, *frame_), geometry.precision,
                                     geometry.origin)
                  : collider_->world_of(number_, asks);
}

std::vector<Pair> Answer::meeting() const {
    std::vector<Pair> found;
    oracle::World world;
    {
        const auto lock = collider_->lock();
        check_pairs_kept();
        world = this->world("meeting()");
        found = result_.download();
        if (found.empty()) return found;
    }
    return meeting_of(world, found);
}

const Answer::OnDevice& Answer::on_device() const {
    const auto lock = collider_->lock();
    check_pairs_kept();
    if (on_device_) return *on_device_;
    auto& device = *collider_->devices().front();
    const auto kind = dlpack_device(device);
    if (!kind)
        throw InputError(fmt::format("on_device: no array library takes OpenCL's memory by DLPack, and the "
                                     "pairs are on {}; leave on_device out",
                                     device.info().id));
    if (result_.parts.size() != 1 || (result_.count > 0 && !result_.parts.front()->pairs().rows))
        throw DeviceError(fmt::format("{}: the pairs are in {} parts, not all of them on one device; leave "
                                      "on_device out",
                                      device.info().id, result_.parts.size()));
    OnDevice all{device.allocate(std::max<std::size_t>(1, result_.count) * sizeof(Pair), "pairs for DLPack"),
                 kind->first, kind->second};
    const bool is_sorted = collider_->settings()[parameters::order] == AnswerOrder::canonical;
    if (result_.count > 0 && is_sorted)
        result_.parts.front()->expand(0, result_.count, all.rows);
    else if (result_.count > 0)
        result_.parts.front()->expand_sorted(all.rows);
    device.finish();
    on_device_ = std::move(all);
    return *on_device_;
}

namespace {

using Rows = nb::ndarray<nb::numpy, std::int32_t, nb::shape<-1, 4>>;

template<auto which>
Rows pairs(const Answer& answer) {
    auto found = [&] {
        const nb::gil_scoped_release released;
        return (answer.*which)();
    }();
    return owned_array<std::int32_t, 4>(std::move(found));
}

/// Views of the columns of one array of records: pairs, features, points, normals, depths, pressures.
template<auto which>
nb::tuple contacts(const Answer& answer) {
    auto found = [&] {
        const nb::gil_scoped_release released;
        return (answer.*which)();
    }();
    const auto count = found.size();
    const auto [data, owner] = owned(std::move(found));
    constexpr auto words = std::int64_t{sizeof(ContactPoint) / sizeof(std::int32_t)};
    constexpr auto reals = std::int64_t{sizeof(ContactPoint) / sizeof(double)};
    ContactPoint none;
    auto& first = count > 0 ? *data : none;
    using Vectors = nb::ndarray<nb::numpy, double, nb::shape<-1, 3>>;
    return nb::make_tuple(
        Rows(&first.pair, {count, 4}, owner, {words, 1}),
        nb::ndarray<nb::numpy, std::uint32_t, nb::shape<-1>>(&first.feature, {count}, owner, {words}),
        Vectors(first.point.data(), {count, 3}, owner, {reals, 1}),
        Vectors(first.normal.data(), {count, 3}, owner, {reals, 1}),
        nb::ndarray<nb::numpy, double, nb::shape<-1>>(&first.depth, {count}, owner, {reals}),
        nb::ndarray<nb::numpy, double, nb::shape<-1>>(&first.pressure, {count}, owner, {reals}));
}

/// Corners, pressures there, and the ends of polygons.
nb::tuple surfaces(const Answer& answer) {
    auto found = [&] {
        const nb::gil_scoped_release released;
        return answer.surfaces();
    }();
    return nb::make_tuple(owned_array<double, 3>(std::move(found.corners)),
                          owned_array<double, 1>(std::move(found.pressures)),
                          owned_array<std::uint64_t, 1>(std::move(found.ends)));
}

nb::ndarray<nb::array_api, std::int32_t, nb::shape<-1, 4>> pairs_on_device(nb::handle self) {
    const auto& answer = nb::cast<const Answer&>(self);
    const auto& found = [&]() -> const Answer::OnDevice& {
        const nb::gil_scoped_release released;
        return answer.on_device();
    }();
    return {found.rows.native(), {answer.result().count, 4}, self, {}, nb::dtype<std::int32_t>(), found.type,
            found.number};
}

template<auto member>
auto number() {
    return [](const Answer& self) { return self.result().*member; };
}

template<auto which>
nb::tuple digest(const Answer& answer) {
    const auto [count, a, b] = [&] {
        const nb::gil_scoped_release released;
        return (answer.*which)();
    }();
    return nb::make_tuple(count, a, b);
}

} // namespace

void bind_answer(nb::module_& module) {
    nb::class_<Answer>(module, "Answer", "Result of a run of Collider; tandem.Answer wraps it.")
        .def_prop_ro("count", number<&FrameResult::count>())
        .def_prop_ro("contact_count", number<&FrameResult::contacts>())
        .def_prop_ro("body_pairs", number<&FrameResult::body_pairs>())
        .def_prop_ro("degenerate", number<&FrameResult::degenerate>())
        .def_prop_ro("seconds", &Answer::seconds)
        .def_prop_ro("retries", number<&FrameResult::retries>())
        .def_prop_ro("batches", number<&FrameResult::batches>())
        .def_prop_ro("origin", number<&FrameResult::origin>())
        .def("digest", &digest<&Answer::digest>)
        .def("contact_digest", &digest<&Answer::contact_digest>)
        .def("pairs", &pairs<&Answer::pairs>)
        .def("meeting", &pairs<&Answer::meeting>)
        .def("contacts", &contacts<&Answer::contacts>)
        .def("distances", &contacts<&Answer::distances>)
        .def("polygons", &contacts<&Answer::polygons>)
        .def("surfaces", &surfaces)
        .def("wrenches", &contacts<&Answer::wrenches>)
        .def("pairs_on_device", &pairs_on_device);
}

} // namespace tandem::python
