// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/contact_settings.h"

namespace tandem {

ContactSettings contact_settings_of(const Settings& settings) {
    if (settings[parameters::contact_rule] == ContactRule::none) return {};
    return {settings[parameters::contact_rule], settings[parameters::decision]};
}

} // namespace tandem
