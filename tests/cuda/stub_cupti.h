// SPDX-License-Identifier: MIT
// What the stub of CUPTI tells a test; looked up by name, since only a stub has it.
#pragma once

extern "C" {
/// Calls so far, of any entry point.
unsigned long stub_cupti_calls();
/// Kinds of records that are enabled.
unsigned long stub_cupti_enabled();
/// Whether it has a subscriber or has not been finalized since it had one.
bool stub_cupti_attached();
/// Ids of a caller's own that were pushed and not popped.
unsigned long stub_cupti_pushed();
}
