// SPDX-License-Identifier: MIT
// Checks resolved settings against a device and a scene, and chooses those that depend on them.
#include "algorithms/bodies/origin.h"
#include "algorithms/bodies/shift.h"
#include "algorithms/bounds/geometry.h"
#include "algorithms/narrow_phase/contact_settings.h"
#include "algorithms/traversal.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

/// Throws InputError if the device lacks arithmetic for the geometry or the decision.
void check_arithmetic(const Settings& settings, const DeviceInfo& info) {
    const auto geometry = geometry_of(settings);
    if (geometry.rounding == Rounding::directed && !info.has_directed_rounding)
        throw InputError(
            fmt::format("setting rounding=directed is impossible on {}, which rounds to nearest only; "
                        "choose safe, or a cuda device",
                        info.id));
    if (geometry.precision == Precision::fp64 && !info.has_double)
        throw InputError(fmt::format("setting precision=double is impossible on {}; choose float", info.id));
    if (has_verdicts(contact_settings_of(settings).decision) && !info.has_double)
        throw InputError(
            fmt::format("setting decision={} is impossible on {}, which has no double; choose fp32",
                        settings.text("decision"), info.id));
}

/// Resolves decision=usual.
Settings with_decision(Settings settings, const DeviceInfo& info) {
    if (settings[parameters::decision] != DecisionPrecision::usual) return settings;
    const bool moves = settings[parameters::motion] == Motion::linear; // needs exact decisions
    settings.set(parameters::decision(!info.has_double ? DecisionPrecision::fp32
                                      : moves          ? DecisionPrecision::exact
                                                       : DecisionPrecision::recheck));
    return settings;
}

/// Throws InputError if the contact rule or the data path does not fit the output.
void check_output(const Settings& settings) {
    const auto rule = settings[parameters::contact_rule];
    if (settings[parameters::output] == Output::contacts && rule == ContactRule::none)
        throw InputError("setting output=contacts needs a contact rule; leave contact_rule out, or choose "
                         "output=pairs");
    if (settings[parameters::output] == Output::wrenches && !needs_pressures(rule))
        throw InputError("setting output=wrenches needs contact_rule=pressure; set it, or choose "
                         "output=contacts");
    if (settings[parameters::output] != Output::distances) return;
    if (!has_near_pairs(rule))
        throw InputError("setting output=distances needs contact_rule=distance; set it, or choose "
                         "output=contacts");
    if (is_published(settings))
        throw InputError("setting output=distances does not go with residency=published, whose code keeps "
                         "all contacts; leave residency and preset out");
}

/// Throws InputError if other settings do not fit polygons of equal pressure, or no mesh has a pressure
/// field.
void check_polygons(const Settings& settings, const Scene* scene) {
    if (!has_polygons(settings) && !bounds_pressures(settings)) return;
    const auto rule = settings.text("contact_rule");
    if (settings[parameters::self] != SelfPairs::off)
        throw InputError(
            fmt::format("setting self={} does not go with contact_rule={}: within a body there is "
                        "one field, which is equal to itself; leave self out",
                        settings.text("self"), rule));
    if (settings[parameters::motion] == Motion::linear)
        throw InputError(fmt::format("setting motion=linear does not go with contact_rule={}, whose polygons "
                                     "are those of one frame; choose another rule or contact_rule=none",
                                     rule));
    if (is_published(settings))
        throw InputError(fmt::format("setting contact_rule={} does not go with residency=published, whose "
                                     "vertices have no pressures; leave residency and preset out",
                                     rule));
    const auto has_field = [](const Mesh& mesh) { return !mesh.pressures.empty(); };
    if (scene != nullptr && std::ranges::none_of(scene->meshes, has_field))
        throw InputError(
            fmt::format("setting contact_rule={} needs a pressure field, and no mesh of scene {} "
                        "has one; give --pressure MODULUS (pressure= in Python), or a mesh with "
                        "point data pressure",
                        rule, scene->name));
}

/// Throws InputError if other settings do not fit pressure_slab=on.
void check_pressure_slab(const Settings& settings, const DeviceInfo& info) {
    if (!bounds_pressures(settings)) return;
    if (!needs_pressures(settings[parameters::contact_rule]))
        throw InputError(fmt::format("setting pressure_slab=on does not go with contact_rule={}, which needs "
                                     "pairs of all pressures; choose contact_rule=pressure",
                                     settings.text("contact_rule")));
    if (info.max_group_size == 1 && settings[parameters::k] != 18)
        throw InputError(
            fmt::format("setting pressure_slab=on goes with k=18 on {}, not with k={}; leave k or "
                        "pressure_slab out",
                        info.id, settings.text("k")));
}

/// Throws InputError if other settings do not fit margin or motion=linear.
void check_bounds_settings(const Settings& settings) {
    if (settings[parameters::margin] > 0 && is_published(settings))
        throw InputError(
            "setting margin does not go with residency=published, whose code has no such bounds; "
            "leave residency and preset out");
    const bool measures = makes_contacts(settings) && has_near_pairs(settings[parameters::contact_rule]);
    if (measures && settings[parameters::decision] == DecisionPrecision::none)
        throw InputError(fmt::format("setting decision=none does not go with contact_rule={}, which measures "
                                     "pairs that do not meet; leave decision out",
                                     settings.text("contact_rule")));
    if (settings[parameters::motion] != Motion::linear) return;
    if (measures)
        throw InputError(
            fmt::format("setting motion=linear does not go with contact_rule={}, whose distances "
                        "are those of one frame; choose another rule or contact_rule=none",
                        settings.text("contact_rule")));
    if (is_published(settings))
        throw InputError("setting motion=linear does not go with residency=published, whose code bounds one "
                         "frame; leave residency and preset out");
    if (makes_contacts(settings) && settings[parameters::decision] != DecisionPrecision::exact)
        throw InputError(fmt::format("setting motion=linear finds pairs that do not meet in the frame, which "
                                     "decision={} does not leave out of contacts exactly; choose "
                                     "decision=exact or contact_rule=none",
                                     settings.text("decision")));
}

/// Whether a session of the scene is known to count from the world's origin, and to centre no mesh.
bool is_at_world_origin(const Scene* scene, Origin origin) {
    return scene != nullptr && scene->frame && origin_of(*scene, origin) == Eigen::Vector3d::Zero()
           && !has_far_mesh(*scene);
}

} // namespace

Settings Traversal::fitted(const Settings& asked, const DeviceInfo& info, const Scene* scene) const {
    const auto settings = with_decision(asked, info);
    check_arithmetic(settings, info);
    auto fitting = settings;
    const auto wanted = settings[tandem::parameters::group_size];
    if (info.max_group_size == 1)
        fitting.set(tandem::parameters::group_size(1));
    else if (wanted > info.max_group_size)
        throw InputError(fmt::format("setting group_size={} is impossible on {}; choose at most {}", wanted,
                                     info.id, info.max_group_size));
    if (settings[tandem::parameters::broad] == Broad::device && is_published(settings))
        throw InputError("setting broad=device does not go with residency=published, whose bounds are on the "
                         "host; choose broad=sphere");
    // Only the host device and the conversion of the published data path have threads.
    if (info.max_group_size > 1 && !is_published(settings)) fitting.set(tandem::parameters::threads(0));
    check_output(settings);
    if (settings[tandem::parameters::order] == AnswerOrder::canonical) {
        if (!has_pairs(settings[tandem::parameters::output]))
            throw InputError("setting order=canonical needs pairs; choose output=pairs, or leave order out");
        if (is_published(settings))
            throw InputError(
                "setting order=canonical does not go with residency=published, which sorts on the "
                "host; leave it out");
    }
    check_bounds_settings(settings);
    check_polygons(settings, scene);
    check_pressure_slab(settings, info);
    if (const auto origin = geometry_of(settings).origin;
        origin == Origin::world || is_at_world_origin(scene, origin))
        fitting.set(tandem::parameters::origin(Origin::world));
    if (walks_part(settings) && settings[tandem::parameters::broad] != Broad::sphere_boxes)
        throw InputError("settings first_body_pair and most_body_pairs need broad=sphere_boxes, whose pairs "
                         "the reference numbers too; choose it, or leave them out");
    // Bodies without shared meshes have no slots (bodies/bodies.h).
    if (is_published(settings)) fitting.set(tandem::parameters::pair_layout(PairLayout::items));
    do_fit(fitting, info, scene);
    if (fitting[tandem::parameters::group_size] == 0)
        fitting.set(tandem::parameters::group_size(std::min<std::int64_t>(128, info.max_group_size)));
    do_check(fitting, info);
    return fitting;
}

} // namespace tandem
