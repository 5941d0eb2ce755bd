// SPDX-License-Identifier: MIT
#include "backends/ranges.h"

#ifdef TANDEM_NVTX
// Header-only: a profiler installs its functions when the first range begins.
#include <nvtx3/nvToolsExt.h>
#endif

namespace tandem::ranges {

#ifdef TANDEM_NVTX
namespace {

/// A domain of the project's own, so that filters separate its ranges from those of libraries.
nvtxDomainHandle_t domain() {
    static const auto handle = nvtxDomainCreateA("tandem");
    return handle;
}

} // namespace

bool available() { return true; }

void push(const char* name) {
    nvtxEventAttributes_t attributes{};
    attributes.version = NVTX_VERSION;
    attributes.size = NVTX_EVENT_ATTRIB_STRUCT_SIZE;
    attributes.messageType = NVTX_MESSAGE_TYPE_ASCII;
    attributes.message.ascii = name;
    nvtxDomainRangePushEx(domain(), &attributes);
}

void pop() { nvtxDomainRangePop(domain()); }
#else
bool available() { return false; }
void push(const char*) {}
void pop() {}
#endif

} // namespace tandem::ranges
