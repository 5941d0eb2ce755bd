// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

#include <memory>

namespace tandem {

/// The job whose processes run these tests; every process runs every test.
extern std::unique_ptr<Ranks> job;

} // namespace tandem
