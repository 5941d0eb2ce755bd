// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

#include <memory>

namespace tandem {

/// The processes that run these tests, every one of which runs every test.
extern std::unique_ptr<Ranks> job;

} // namespace tandem
