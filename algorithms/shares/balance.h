// SPDX-License-Identifier: MIT
#pragma once

#include "algorithms/answer/frame_result.h"

#include <span>

namespace tandem {

/// How fast devices that share frames are, and whether a new deal would make frames shorter.
class Balance {
public:
    explicit Balance(std::size_t shares) : speeds_(shares, 1.0) {}

    /// A frame: what each device did, and its work as deals count it. The first one says nothing of times:
    /// some devices compile in it.
    void see(std::span<const SharedWork> done, std::span<const double> work);
    /// Whether in some frames one after the other one device took so much longer than all on average that
    /// bodies had better be dealt anew. After a deal that was of no use it takes twice as many frames.
    bool wants_a_deal() const { return wants_a_deal_; }
    /// Bodies have been dealt anew.
    void dealt();
    /// Of each device: work done in a nanosecond; equal before the first frame.
    std::span<const double> speeds() const { return speeds_; }

private:
    std::vector<double> speeds_;
    std::size_t frames_ = 0;
    bool wants_a_deal_ = false;
    bool judges_ = false;      ///< the next frame tells what the last deal was good for
    double before_ = 1;        ///< imbalance that it was made for
    std::size_t patience_ = 2; ///< frames
    std::size_t waited_ = 0;   ///< frames out of balance, one after the other
};

/// The longest time over the mean of all: 1 where all devices end together.
double imbalance(std::span<const SharedWork> done);

} // namespace tandem
