// SPDX-License-Identifier: MIT
// Empty: a target needs a source file, and the precompiled headers have no other.
