// SPDX-License-Identifier: MIT
#include "harness/simulate/frame_contacts.h"

#include "base/error.h"

#include <fmt/format.h>

namespace tandem {

FrameContacts::FrameContacts(const std::string& device, const Scene& scene)
    : scene_(scene), backends_(open_backends({&device, 1}, {})) {
    Request request;
    request.algorithms = {std::string(algorithms().front()->name())};
    request.devices = {device};
    const auto devices = choose_devices(backends_, request.devices);
    if (devices.size() != 1)
        throw InputError(fmt::format("--device {}: contacts need one device; name exactly one", device));
    cell_ = plan(request, devices).front();
    session_ = cell_.algorithm->prepare(cell_.devices, scene, cell_.settings);
}

std::vector<ContactPoint> FrameContacts::find(const Frame& frame) {
    check_coordinates(cell_, scene_, frame);
    return session_->run(FrameView(frame).checked()).download_contacts();
}

} // namespace tandem
