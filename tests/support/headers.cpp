// SPDX-License-Identifier: MIT
// Nothing: a target needs a file, and that of the precompiled headers has no other.
