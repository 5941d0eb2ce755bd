// SPDX-License-Identifier: MIT
#include "harness/record/answer.h"

#include "base/statistics.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>

namespace tandem {

namespace {

std::string truth_of(const AnswerErrors& e) {
    return fmt::format("truth: {} of {} meeting pairs missed, {} candidates do not meet{}", e.missed(),
                       e.meeting(), e.pairs.disjoint, e.rounding ? "; " + rounding_text(*e.rounding) : "");
}

} // namespace

std::string rounding_text(const RoundingErrors& errors) {
    return fmt::format("rounding of vertices lost {} of {} pairs that meet by the input, and added {}",
                       errors.lost, errors.meeting, errors.extra);
}

std::string answer_text(const Measurement& m) {
    const auto& a = m.agreement;
    if (a.frames == 0) return "not checked";
    if (a.ok())
        return "right: no pair missing or extra, contacts equal bit for bit"
               + (m.errors ? "; " + truth_of(*m.errors) : "");
    return fmt::format("WRONG: {} missing, {} extra, contacts differ in {} of {} frames", a.missing, a.extra,
                       a.contact_frames_wrong, a.frames);
}

std::vector<std::string> answer_warnings(const Measurement& m, const Scene& scene) {
    std::vector<std::string> lines;
    if (const auto& c = m.deep_contact)
        lines.push_back(fmt::format(
            "contact_rule={}: a contact of frame {}, of body {} tetrahedron {} and body {} tetrahedron {}, "
            "is {:.3g} {} deep, but the smaller body is {:.3g} {} long; contact_rule=sat gives the least "
            "depth",
            m.settings.text("contact_rule"), c->frame, c->body_a, c->tet_a, c->body_b, c->tet_b, -c->depth,
            scene.units, c->size, scene.units));
    if (const auto& f = m.flattened; f.tetrahedra > 0) {
        const auto& mesh = scene.meshes[scene.bodies[f.body].mesh];
        const bool is_world = m.settings[parameters::origin] == Origin::world;
        lines.push_back(fmt::format(
            "single precision cannot resolve mesh {} of body {}: {} of {} tetrahedra become flat; use "
            "precision=double{}",
            mesh.name, f.body, f.of_body, mesh.tetrahedra.size(), is_world ? " or origin=auto" : ""));
    }
    return lines;
}

bool misses_against_its_promise(const Measurement& m) {
    const auto rounding = m.settings[parameters::rounding];
    return m.errors && m.errors->missed() > 0
           && (rounding == Rounding::safe || rounding == Rounding::directed);
}

} // namespace tandem
