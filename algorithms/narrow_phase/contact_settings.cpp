// SPDX-License-Identifier: MIT
#include "algorithms/narrow_phase/contact_settings.h"

#include "algorithms/pipeline.h"

namespace tandem {

Walked walked_of(const Settings& settings) {
    const bool leaves_out = settings[parameters::output] == Output::contacts
                            && boundaries_needed(settings[parameters::contact_rule]) == 2
                            && !is_published(settings);
    return leaves_out ? Walked::boundary : Walked::all;
}

ContactSettings contact_settings_of(const Settings& settings) {
    if (settings[parameters::contact_rule] == ContactRule::none) return {};
    return {settings[parameters::contact_rule], settings[parameters::decision], walked_of(settings)};
}

} // namespace tandem
