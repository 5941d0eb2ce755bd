// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/driver.h"

namespace tandem::cuda {

/// Makes a context current for the calling thread, and restores the previous one, or none, at its end. The
/// application or another device may rely on its own. Costs one query when the context is already current.
class CurrentContext {
public:
    CurrentContext(const Driver& driver, Context wanted) : driver_(driver) {
        result_ = driver.cuCtxGetCurrent(&previous_);
        changed_ = result_ == 0 && previous_ != wanted;
        if (changed_) result_ = driver.cuCtxSetCurrent(wanted);
    }
    ~CurrentContext() {
        if (changed_) driver_.cuCtxSetCurrent(previous_);
    }
    CurrentContext(const CurrentContext&) = delete;
    CurrentContext& operator=(const CurrentContext&) = delete;

    /// 0 when the context is current.
    Result result() const { return result_; }

private:
    const Driver& driver_;
    Context previous_ = nullptr;
    Result result_ = 0;
    bool changed_ = false;
};

} // namespace tandem::cuda
