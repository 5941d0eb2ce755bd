// SPDX-License-Identifier: MIT
// The number of lanes of a team, which is the number of boxes of a tile: at most 32, the bits of a mask.
// Kernels and host code read it here.
#ifndef TANDEM_LANES_H
#define TANDEM_LANES_H

#define TANDEM_LANES 32

#endif
