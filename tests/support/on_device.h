// SPDX-License-Identifier: MIT
#pragma once

#include "tests/support/cells.h"
#include "tests/support/long_form.h"
#include "tests/support/test.h"

namespace tandem::support {

/// Base of suites that run on every device (TANDEM_ON_DEVICES).
class OnDevice : public testing::TestWithParam<std::string> {
protected:
    Device& on = device(GetParam());

    /// All algorithms; on other devices than the host, where compilation takes long, one of each hierarchy.
    static std::vector<const Traversal*> walks() {
        if (GetParam() != "host" && !long_form()) return {&algorithm("tiled"), &algorithm("chunked")};
        return {algorithms().begin(), algorithms().end()};
    }

    std::unique_ptr<Session> prepare(const Traversal& traversal, const Scene& scene,
                                     const SettingTexts& given = {}) {
        return prepare_on(on, traversal, scene, given);
    }
};

} // namespace tandem::support

#define TANDEM_ON_DEVICES(Suite)                                                                             \
    INSTANTIATE_TEST_SUITE_P(Devices, Suite, testing::ValuesIn(tandem::support::device_names()),             \
                             [](const auto& test) { return tandem::support::device_label(test.param); })
