// SPDX-License-Identifier: MIT
#include "harness/simulate/frame_contacts.h"

#include "harness/verify/contact_surfaces.h"

namespace tandem {

FrameContacts::FrameContacts(std::span<const DeviceGroup> devices, const Scene& scene,
                             const std::string& rule)
    : scene_(scene) {
    Request request;
    request.algorithms = {std::string(algorithms().front()->name())};
    if (!rule.empty()) request.sets = {{std::string(parameters::contact_rule.name), {rule}}};
    cell_ = plan(request, devices).front();
    session_ = cell_.algorithm->prepare(cell_.devices, scene, cell_.settings);
}

FrameResult FrameContacts::run(const Frame& frame) {
    check_coordinates(cell_, scene_, frame);
    return session_->run(FrameView(frame).checked());
}

std::vector<ContactPoint> FrameContacts::find(const Frame& frame) { return run(frame).download_contacts(); }

SurfaceFrames FrameContacts::surfaces(std::size_t number, const Frame& frame) {
    const auto result = run(frame);
    const auto rows = result.download_contacts();
    SurfaceFrames found;
    found.add(static_cast<std::uint32_t>(number), rows,
              surfaces_of(scene_, frame, geometry_of(session_->settings()), result.origin, rows));
    return found;
}

} // namespace tandem
