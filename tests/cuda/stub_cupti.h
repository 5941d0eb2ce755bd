// SPDX-License-Identifier: MIT
// Queries of the CUPTI stub; tests look them up by name because only the stub exports them.
#pragma once

extern "C" {
/// Number of calls of all entry points.
unsigned long stub_cupti_calls();
/// Number of enabled record kinds.
unsigned long stub_cupti_enabled();
/// Whether it has a subscriber, or has not been finalized since.
bool stub_cupti_attached();
/// Number of external ids that were pushed and not popped.
unsigned long stub_cupti_pushed();
}
