// SPDX-License-Identifier: MIT
#include "harness/simulate/frame_contacts.h"

#include "base/error.h"
#include "harness/verify/contact_surfaces.h"

#include <fmt/format.h>

namespace tandem {

FrameContacts::FrameContacts(const std::string& device, const Scene& scene, const std::string& rule)
    : scene_(scene), backends_(open_backends({&device, 1}, {})) {
    Request request;
    request.algorithms = {std::string(algorithms().front()->name())};
    request.devices = {device};
    if (!rule.empty()) request.sets = {{std::string(parameters::contact_rule.name), {rule}}};
    const auto devices = choose_devices(backends_, request.devices);
    if (devices.size() != 1)
        throw InputError(fmt::format("--device {}: contacts need one device; name exactly one", device));
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
