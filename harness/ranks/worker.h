// SPDX-License-Identifier: MIT
#pragma once

#include "harness/ranks/mail.h"

#include <functional>

namespace tandem {

/// What a rank does for the first one, message by message, until it is told to end: says what devices it has
/// and lets another process measure the cells that it is dealt. Returns the exit code that it is
/// told. An Interrupt must live: once a signal has come, what is being measured is given up. `share`: what is
/// done when all ranks are to share frames (companions.h).
int obey(Mail& mail, const std::function<void()>& share = {});

} // namespace tandem
