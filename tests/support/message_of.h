// SPDX-License-Identifier: MIT
#pragma once

#include "base/error.h"

#include <string>

namespace tandem::support {

/// The message of the error that the call throws, or "no error".
template<class Error = InputError, class Call>
std::string message_of(const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

} // namespace tandem::support
