// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/driver.h"

namespace tandem::cuda {

/// Makes a context the calling thread's current one and puts back at its end the one, or none, that was: the
/// application or another device may count on its own. Costs one look where it is current already.
class CurrentContext {
public:
    CurrentContext(const Driver& driver, Context wanted) : driver_(driver) {
        result_ = driver.cuCtxGetCurrent(&before_);
        changed_ = result_ == 0 && before_ != wanted;
        if (changed_) result_ = driver.cuCtxSetCurrent(wanted);
    }
    ~CurrentContext() {
        if (changed_) driver_.cuCtxSetCurrent(before_);
    }
    CurrentContext(const CurrentContext&) = delete;
    CurrentContext& operator=(const CurrentContext&) = delete;

    /// 0 where the context is current now.
    Result result() const { return result_; }

private:
    const Driver& driver_;
    Context before_ = nullptr;
    Result result_ = 0;
    bool changed_ = false;
};

} // namespace tandem::cuda
