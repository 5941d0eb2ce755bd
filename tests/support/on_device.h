// SPDX-License-Identifier: MIT
#pragma once

#include "tests/support/cells.h"
#include "tests/support/long_form.h"
#include "tests/support/test.h"

namespace tandem::support {

/// All algorithms, or briefly one of each hierarchy.
inline std::vector<const Traversal*> walks(bool briefly) {
    if (briefly) return {&algorithm("tiled"), &algorithm("chunked")};
    return {algorithms().begin(), algorithms().end()};
}

/// Base of suites that run on every device (TANDEM_ON_DEVICES).
class OnDevice : public testing::TestWithParam<std::string> {
protected:
    Device& on = device(GetParam());

    /// Whether the form is short, on a device where compilation of kernels takes most of the time.
    static bool compiles_briefly() { return GetParam() != "host" && !long_form(); }

    static std::vector<const Traversal*> walks() { return support::walks(compiles_briefly()); }

    std::unique_ptr<Session> prepare(const Traversal& traversal, const Scene& scene,
                                     const SettingTexts& given = {}) {
        return prepare_on(on, traversal, scene, given);
    }
};

} // namespace tandem::support

#define TANDEM_ON_DEVICES(Suite)                                                                             \
    INSTANTIATE_TEST_SUITE_P(Devices, Suite, testing::ValuesIn(tandem::support::device_names()),             \
                             [](const auto& test) { return tandem::support::device_label(test.param); })
