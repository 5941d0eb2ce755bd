// SPDX-License-Identifier: MIT
#pragma once

extern "C" {
/// After this call, the `call`-th call that can fail returns `code` and does nothing; 0: no call fails.
void opencl_shim_fail(unsigned long call, int code);
/// The next `count` calls of clBuildProgram fail and do nothing.
void opencl_shim_fail_builds(unsigned long count);
/// Number of calls that can fail, since the first enqueued command or the last opencl_shim_fail().
unsigned long opencl_shim_calls();
/// Maximum work-group size reported for every kernel from then on; 0: the platform's value.
void opencl_shim_report_group_size(unsigned long group_size);
}
