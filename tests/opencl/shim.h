// SPDX-License-Identifier: MIT
#pragma once

extern "C" {
/// From now on the `call`-th of the calls that can fail returns `code` and does nothing; 0: none does.
void opencl_shim_fail(unsigned long call, int code);
/// The calls that can fail since the first command was enqueued or opencl_shim_fail was called.
unsigned long opencl_shim_calls();
/// From now on that is said to be the largest work-group of every kernel; 0: what the platform says.
void opencl_shim_advise(unsigned long group_size);
}
